"""Other light, other cameras: what may happen to the colours of a training image.

A network that is trained on renders sees photographs later; whatever the two differ by and depth
does not depend on is drawn at random here.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Image = NDArray[np.float32]
"""Height by width by 3; 0 to 1 is what can be shown."""

_GREY = np.array([0.299, 0.587, 0.114])
_COARSE = 64
"""Columns of the image whose spectrum is changed; what is finer stays as it is."""


@dataclass(frozen=True)
class Colour:
    """Random tone, tint and saturation; at times blur, noise, compression and more.

    Attributes:
        strength: 1 is what photographs differ by; 0 leaves them alone.
        framed: Share of images with a plain frame over their edges, as scans and the pictures of
            some sensors have; the depth behind it stays what it is.
    """

    strength: float = 1.0
    framed: float = 0.12

    def __call__(self, rng: Generator, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return the image in another light, through another camera."""
        x = toned(rng, image, self.strength)
        for share, change in CHANGES:
            if rng.random() < share * self.strength:
                x = change(rng, x)
        if rng.random() < self.framed * self.strength:
            x = framed(rng, x)
        return _eight(x)


def toned(rng: Generator, image: NDArray[np.uint8], strength: float) -> Image:
    """Return the image with a random tone curve for each channel, saturation and contrast."""
    level = np.arange(256) / 255
    gamma = np.exp(strength * (rng.normal(0, 0.2) + rng.normal(0, 0.05, 3)))
    gain = np.exp(strength * (rng.normal(0, 0.12) + rng.normal(0, 0.06, 3)))
    curves = gain * level[:, None] ** gamma
    if rng.random() < 0.25 * strength:
        steps = rng.uniform(0.3, 1.7, (6, 1)) * rng.uniform(0.85, 1.15, (6, 3))
        knots = np.concatenate([np.zeros((1, 3)), steps.cumsum(0) / steps.sum(0)])
        place = np.linspace(0, 1, len(knots))
        curves = np.stack(
            [np.interp(c, place, k) for c, k in zip(curves.T, knots.T, strict=True)], 1
        )
    x = cv2.LUT(image, curves[None].astype(np.float32))
    saturation = 0.0 if rng.random() < 0.1 * strength else np.exp(strength * rng.normal(0, 0.3))
    contrast = np.exp(strength * rng.normal(0, 0.15))
    mix = contrast * (saturation * np.eye(3) + (1 - saturation) * _GREY)
    offset = np.full((3, 1), 0.5 * (1 - contrast))
    return np.asarray(cv2.transform(x, np.hstack([mix, offset])), np.float32)


def with_other_spectrum(rng: Generator, x: Image) -> Image:
    """Return the image with other amplitudes of its low frequencies; their phases stay.

    Half of the time they are scaled at random, else replaced in part by those of noise that falls
    with frequency as photographs' do.

    References:
        Yang and Soatto, FDA, CVPR 2020, eq. 3 and 4, with random spectra for the other image's.
    """
    height, width = x.shape[:2]
    small = cv2.resize(x, (_COARSE, _COARSE), interpolation=cv2.INTER_AREA)
    spectrum = np.fft.rfft2(small, axes=(0, 1))
    frequency = np.hypot(np.fft.fftfreq(_COARSE)[:, None], np.fft.rfftfreq(_COARSE)[None])
    low = ((frequency > 0) & (frequency < rng.uniform(0.02, 0.12)))[..., None]
    shape = (*frequency.shape, 1)
    if rng.random() < 0.5:
        factor = np.exp(
            rng.normal(0, rng.uniform(0.1, 0.5), shape) + rng.normal(0, 0.1, (*shape[:2], 3))
        )
    else:
        steady = np.maximum(frequency, 1 / _COARSE)[..., None] ** -rng.uniform(0.8, 1.4)
        wanted = steady * rng.rayleigh(0.8, shape) * rng.uniform(2, 8)
        share = rng.uniform(0.1, 0.7)
        factor = (1 - share) + share * np.minimum(wanted / np.maximum(np.abs(spectrum), 1e-3), 4)
    added = np.fft.irfft2(np.where(low, spectrum * (factor - 1), 0), s=small.shape[:2], axes=(0, 1))
    return x + cv2.resize(added.astype(np.float32), (width, height), interpolation=cv2.INTER_CUBIC)


def with_other_statistics(rng: Generator, x: Image) -> Image:
    """Return the image with the mean and spread of each channel moved towards random ones."""
    mean, spread = (np.asarray(value).ravel() for value in cv2.meanStdDev(x))
    share = rng.uniform(0.2, 0.8)
    wanted = rng.uniform(0.25, 0.65) + rng.normal(0, 0.05, 3), rng.uniform(0.12, 0.32)
    scale = (1 - share) + share * np.minimum(wanted[1] / np.maximum(spread, 0.02), 3)
    offset = (1 - share) * mean + share * wanted[0] - scale * mean
    return np.asarray(x * scale.astype(np.float32) + offset.astype(np.float32), np.float32)


def equalised(rng: Generator, x: Image) -> Image:
    """Return the image with more local contrast, as cameras and galleries make it."""
    grid = int(rng.integers(2, 9))
    equaliser = cv2.createCLAHE(float(rng.uniform(1, 4)), (grid, grid))
    lab = cv2.cvtColor(_eight(x), cv2.COLOR_RGB2LAB)
    lab[..., 0] = equaliser.apply(lab[..., 0])
    other = cv2.cvtColor(lab, cv2.COLOR_LAB2RGB).astype(np.float32) / 255
    return np.asarray(x + np.float32(rng.uniform(0.3, 1)) * (other - x), np.float32)


def blurred(rng: Generator, x: Image) -> Image:
    """Return the image out of focus, or moved during the exposure."""
    kind = rng.random()
    if kind < 0.5:
        return np.asarray(cv2.GaussianBlur(x, (0, 0), rng.uniform(0.3, 1.2)), np.float32)
    row, column = np.mgrid[-5:6, -5:6]
    if kind < 0.75:
        kernel = np.clip(rng.uniform(0.8, 2.6) - np.hypot(row, column) + 0.5, 0, 1)
    else:
        angle, reach = rng.uniform(0, np.pi), rng.uniform(1, 4.5)
        along = row * np.sin(angle) + column * np.cos(angle)
        across = row * np.cos(angle) - column * np.sin(angle)
        kernel = np.clip(1 - np.abs(across), 0, 1) * np.clip(reach - np.abs(along) + 0.5, 0, 1)
    return np.asarray(cv2.filter2D(x, -1, (kernel / kernel.sum()).astype(np.float32)), np.float32)


def noisy(rng: Generator, x: Image) -> Image:
    """Return the image with noise, more of it where there is light, at times in blotches."""
    height, width = x.shape[:2]
    noise = rng.standard_normal(x.shape, np.float32)
    if rng.random() < 0.4:
        noise = cv2.GaussianBlur(noise, (0, 0), rng.uniform(0.4, 1.0)) * np.float32(1.7)
    if rng.random() < 0.3:
        coarse = rng.standard_normal((height // 4 + 1, width // 4 + 1, 3), np.float32)
        noise = noise + cv2.resize(coarse, (width, height), interpolation=cv2.INTER_LINEAR)
    floor, rise = np.exp(rng.uniform(np.log(0.002), np.log(0.03), 2)).astype(np.float32)
    return np.asarray(x + (floor + rise * np.clip(x, 0, 1)) * noise, np.float32)


def sharpened(rng: Generator, x: Image) -> Image:
    """Return the image with halos around its edges."""
    soft = cv2.GaussianBlur(x, (0, 0), rng.uniform(0.7, 2.0))
    return np.asarray(x + np.float32(rng.uniform(0.2, 1.5)) * (x - soft), np.float32)


def coarsened(rng: Generator, x: Image) -> Image:
    """Return the image as enlarged from a smaller one."""
    height, width = x.shape[:2]
    share = rng.uniform(0.4, 0.9)
    size = max(1, round(width * share)), max(1, round(height * share))
    small = cv2.resize(x, size, interpolation=cv2.INTER_AREA)
    return np.asarray(
        cv2.resize(small, (width, height), interpolation=cv2.INTER_LINEAR), np.float32
    )


def compressed(rng: Generator, x: Image) -> Image:
    """Return the image after JPEG."""
    quality = int(rng.integers(25, 92))
    # OpenCV's pictures are blue, green, red, and JPEG keeps less of blue than of red.
    shown = cv2.cvtColor(_eight(x), cv2.COLOR_RGB2BGR)
    packed = cv2.imencode(".jpg", shown, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    seen = np.asarray(cv2.imdecode(packed, cv2.IMREAD_COLOR), np.float32)
    return np.asarray(cv2.cvtColor(seen, cv2.COLOR_BGR2RGB) / np.float32(255), np.float32)


CHANGES: tuple[tuple[float, Callable[[Generator, Image], Image]], ...] = (
    (0.25, with_other_spectrum),
    (0.12, with_other_statistics),
    (0.1, equalised),
    (0.25, blurred),
    (0.1, coarsened),
    (0.25, noisy),
    (0.15, sharpened),
    (0.25, compressed),
)
"""What happens to a share of the images at strength 1, in this order."""


def framed(rng: Generator, image: Image) -> Image:
    """Return the image with up to a twentieth of each side white, black or grey."""
    height, width = image.shape[:2]
    top, bottom = rng.integers(0, height // 20 + 1, 2)
    left, right = rng.integers(0, width // 20 + 1, 2)
    out = np.full_like(image, rng.choice([0.0, 0.5, 1.0], p=[0.4, 0.1, 0.5]))
    inside = slice(top, height - bottom), slice(left, width - right)
    out[inside] = image[inside]
    return out


def _eight(x: Image) -> NDArray[np.uint8]:
    """Return what can be shown of the image in 8 bits."""
    return np.asarray((255 * np.clip(x, 0, 1)).round(), np.uint8)
