"""From linear light to the picture that a camera would have saved."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.sensor import Sensor
from flexdepth.synth.tone import Tone

Array = NDArray[np.float32]

_LAYERS = 6
"""Slices of depth that are blurred apart."""

_SHARP = 0.7
"""Pixels of a blur disc's diameter below which nothing is out of focus."""


@dataclass(frozen=True, eq=False)
class Optics:
    """What the lens does.

    Attributes:
        vignette: How much darker the corners are.
        blur: Of the lens, pixels.
        aperture: Diameter of the entrance pupil, metres; 0 has everything in focus.
        focus: Which part of the image's middle is in focus: a quantile of its depth.
    """

    vignette: float
    blur: float
    aperture: float
    focus: float

    @classmethod
    def drawn(cls, rng: Generator) -> "Optics":
        """Return a random lens: most are phones', in whose pictures nearly all is sharp."""
        wide = rng.random() < 0.22
        return cls(
            vignette=float(rng.uniform(0, 0.6) if rng.random() < 0.7 else 0),
            blur=float(rng.uniform(0.25, 0.6) if rng.random() < 0.8 else rng.uniform(0.6, 1.2)),
            aperture=float(np.exp(rng.uniform(np.log(3e-3), np.log(2e-2)))) if wide else 0.0015,
            focus=float(rng.uniform(0.1, 0.6)),
        )

    def image(self, light: Array) -> Array:
        """Return the light that reaches the sensor: blurred, darker in the corners."""
        height, width = light.shape[:2]
        soft = cv2.GaussianBlur(light, (0, 0), self.blur)
        row, column = np.ogrid[:height, :width]
        square = ((row + 0.5) / height - 0.5) ** 2 + ((column + 0.5) / width - 0.5) ** 2
        return np.asarray(soft * (1 - self.vignette * square[..., None]), np.float32)

    def focused(self, light: Array, depth: Array, focal: float) -> Array:
        """Return the light with what is out of focus blurred, as a thin lens does it.

        A point at depth z is a disc of diameter aperture * focal * |1 / z - 1 / focus|.
        Potmesil and Chakravarty, A lens and aperture camera model, SIGGRAPH 1981; here from a
        sharp image, slice by slice from far to near.
        """
        height, width = depth.shape
        middle = depth[height // 4 : -(height // 4), width // 4 : -(width // 4)]
        nearness = 1 / depth
        inside = middle[np.isfinite(middle)]
        sharp = 1 / np.quantile(inside, self.focus) if inside.size else 0.0
        disc = (self.aperture * focal * (nearness - sharp)).astype(np.float32)
        largest = float(np.abs(disc).max())
        if largest < _SHARP:
            return light
        edges = _slices(float(disc.min()), float(disc.max()))
        number = np.digitize(disc, edges)
        out = light
        for k in range(len(edges) + 1):
            here = (number == k).astype(np.float32)
            if here.any():
                size = float(np.abs(disc[number == k]).mean())
                out = _over(out, light, here, (number > k).astype(np.float32), size)
        return out


def _slices(low: float, high: float) -> NDArray[np.float64]:
    """Return the borders between slices of signed blur, one on either side of what is sharp."""
    even = np.linspace(low, high, _LAYERS + 1)[1:-1]
    return np.unique(np.r_[even[np.abs(even) > _SHARP], -_SHARP, _SHARP])


def _over(out: Array, light: Array, here: Array, nearer: Array, size: float) -> Array:
    """Return `out` with one slice, blurred to discs of diameter `size`, laid over it.

    The slice is continued behind what is nearer, since that will be blurred and let it through.
    """
    if size < _SHARP:
        cover = here[..., None]
        return np.asarray(out + cover * (light - out), np.float32)
    sigma = size / 4
    colour = cv2.GaussianBlur(light * here[..., None], (0, 0), sigma)
    weight = cv2.GaussianBlur(here, (0, 0), sigma)
    cover = np.minimum(1, weight + nearer * (weight > 0.05))[..., None]
    return np.asarray(
        out + cover * (colour / np.maximum(weight, 1e-3)[..., None] - out), np.float32
    )


@dataclass(frozen=True, eq=False)
class Film:
    """How one camera takes pictures."""

    optics: Optics
    tone: Tone
    sensor: Sensor

    @classmethod
    def drawn(cls, rng: Generator) -> "Film":
        """Return a random camera; in the dark it is noisier."""
        tone = Tone.drawn(rng)
        return cls(Optics.drawn(rng), tone, Sensor.drawn(rng, tone.brightness))

    def picture(self, rng: Generator, light: Array) -> NDArray[np.uint8]:
        """Return an 8-bit sRGB picture of what is all in focus."""
        raw = self.sensor.noisy(rng, self.tone.exposed(self.optics.image(light)))
        return self.sensor.developed(self.tone.encoded(raw))


def photograph(rng: Generator, light: Array, depth: Array, focal: float) -> NDArray[np.uint8]:
    """Return the picture that a random camera takes; `focal` is in pixels, depth in metres."""
    film = Film.drawn(rng)
    return film.picture(rng, film.optics.focused(light, depth, focal))
