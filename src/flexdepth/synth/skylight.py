"""What the sky looks like: a gradient, clouds, and the light around the sun."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.patterns import SIZE, fractal
from flexdepth.synth.scene import Scene

Array = NDArray[np.float32]

_SPREAD = 0.12
"""Periods of the cloud pattern in one unit of the plane that clouds lie in."""


@dataclass(frozen=True, eq=False)
class Dome:
    """The sky over a scene.

    Attributes:
        scene: What lies under it.
        field: A pattern of clouds, or None.
        white: Colour of a cloud's rim.
    """

    scene: Scene
    field: Array | None
    white: NDArray[np.float64]

    @classmethod
    def drawn(cls, rng: Generator, scene: Scene) -> "Dome":
        """Return the sky with random clouds."""
        white = (0.5 * scene.horizon + 0.5 * scene.horizon.mean()) * rng.uniform(0.8, 1.3)
        field = fractal(rng, rng.uniform(1.4, 2.0)).astype(np.float32) if scene.clouds else None
        return cls(scene, field, white)

    def light(self, directions: Array) -> Array:
        """Return the sky's light along each direction."""
        unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
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
        column, row = np.ascontiguousarray(place.T, np.float32)
        wrap = cv2.BORDER_WRAP
        found = [
            cv2.remap(field, column[k:end], row[k:end], cv2.INTER_LINEAR, borderMode=wrap)
            for k in range(0, len(column), _ROW)
            for end in (k + _ROW,)
        ]
        return np.asarray(np.concatenate(found, None)[:, None] - 1 + self.scene.clouds)

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


_ROW = 32000
"""OpenCV remaps no more than 32767 points in a row."""
