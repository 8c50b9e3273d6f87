"""What the sky looks like: a gradient, clouds, and the light around the sun."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.patterns import SIZE, fractal
from flexdepth.synth.scene import Scene

Array = NDArray[np.float32]

_SPREAD = 0.12
"""Periods of the cloud pattern in one unit of the plane that clouds lie in."""

_PHOTOGRAPHED = 0.5
"""Share of skies that are photographs, where there are any."""


@dataclass(frozen=True, eq=False)
class _Photographed:
    """A photograph of a sky, all around: beside it lies its mirror image.

    Attributes:
        light: Rows by columns by 3; the last row is the horizon.
        around: How often the photograph and its mirror image go round the horizon.
        top: Radians above the horizon of the first row; above it is that row's mean, which fades
            in from half of the way.
    """

    light: Array
    around: int
    top: float

    @classmethod
    def drawn(cls, rng: Generator, photo: Array, scene: Scene) -> "_Photographed":
        """Return a photograph as bright as the sky of the scene, 15 to 70 degrees high."""
        bright = 0.5 * (scene.horizon + scene.zenith).mean() * rng.uniform(0.8, 1.2)
        around = int(rng.integers(1, 4))
        # Half a turn in `around` pieces, as high as wide things are.
        top = pi / around * len(photo) / photo.shape[1] * rng.uniform(0.6, 1.0)
        light = photo * (bright / photo.mean())
        return cls(np.asarray(light, np.float32), around, float(np.clip(top, 0.26, 1.2)))

    def seen(self, unit: Array) -> Array:
        """Return its light along each direction; below the horizon it goes on as it ends."""
        rows, columns = self.light.shape[:2]
        turned = np.arctan2(unit[:, 0], unit[:, 2]) * (self.around / pi)
        across = np.abs((turned + 1) % 2 - 1) * (columns - 1)
        up = np.arcsin(np.clip(unit[:, 1], 0, 1)) / self.top
        found = _looked_up(self.light, across, np.clip(1 - up, 0, 1) * (rows - 1))
        clear = np.clip(2 * up - 1, 0, 1)[:, None]
        return np.asarray(found + clear * (self.light[0].mean(0) - found), np.float32)


@dataclass(frozen=True, eq=False)
class Dome:
    """The sky over a scene.

    Attributes:
        scene: What lies under it.
        field: A pattern of clouds, or None.
        white: Colour of a cloud's rim.
        photographed: What is seen instead, or None.
    """

    scene: Scene
    field: Array | None
    white: NDArray[np.float64]
    photographed: _Photographed | None = None

    @classmethod
    def drawn(cls, rng: Generator, scene: Scene, photos: Sequence[Array] = ()) -> "Dome":
        """Return the sky with random clouds, or as one of the photographs of skies shows it."""
        white = (0.5 * scene.horizon + 0.5 * scene.horizon.mean()) * rng.uniform(0.8, 1.3)
        field = fractal(rng, rng.uniform(1.4, 2.0)).astype(np.float32) if scene.clouds else None
        if not photos or rng.random() >= _PHOTOGRAPHED:
            return cls(scene, field, white)
        photo = photos[int(rng.integers(len(photos)))]
        return cls(scene, field, white, _Photographed.drawn(rng, photo, scene))

    def light(self, directions: Array) -> Array:
        """Return the sky's light along each direction."""
        unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        if self.photographed is not None:
            return self.photographed.seen(unit)
        height = np.clip(unit[:, 1:2], 0, 1)
        scene = self.scene
        bare = scene.horizon + height**0.6 * (scene.zenith - scene.horizon)
        bare = bare + self._glow(unit, 1.0)
        if self.field is None:
            return np.asarray(bare, np.float32)
        thick = self._thickness(self.field, unit)
        cover = np.clip(3 * thick, 0, 1)
        shade = 1 - scene.gloom * np.clip(1.6 * thick - 0.15, 0, 1)
        cloud = self.white * shade + self._glow(unit, 0.25)
        return np.asarray(bare + cover * (cloud - bare), np.float32)

    def _thickness(self, field: Array, unit: Array) -> Array:
        """Return how thick the clouds are, 0 or less where there are none."""
        height = np.clip(unit[:, 1], 0, 1)
        place = unit[:, [0, 2]] / (height[:, None] + 0.12) * (SIZE * _SPREAD) % SIZE
        found = _looked_up(field[..., None], *place.T)
        return np.asarray(found - 1 + self.scene.clouds)

    def _glow(self, unit: Array, share: float) -> NDArray[np.float64]:
        """Return the sun's disc and the bright air around it."""
        sun = self.scene.sun
        if sun is None:
            return np.zeros((1, 3))
        near = np.clip(unit @ sun.towards, 0, 1)[:, None]
        disc = np.clip((near - 0.9996) * 1e4, 0, 1)
        return (0.1 * near**8 + 0.5 * near**90 + 2 * near**1500 + share * 30 * disc) * (
            share * sun.power
        )


def _looked_up(picture: Array, columns: Array, rows: Array) -> Array:
    """Return a picture's values at places between its pixels, points by channels; it repeats."""
    column, row = (np.ascontiguousarray(each, np.float32) for each in (columns, rows))
    wrap = cv2.BORDER_WRAP
    found = [
        cv2.remap(picture, column[k:end], row[k:end], cv2.INTER_LINEAR, borderMode=wrap)
        for k in range(0, len(column), _ROW)
        for end in (k + _ROW,)
    ]
    return np.concatenate([each.reshape(-1, picture.shape[-1]) for each in found])


_ROW = 32000
"""OpenCV remaps no more than 32767 points in a row."""
