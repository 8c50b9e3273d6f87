"""Things as lists of parts. A thing stands on y = 0 around the origin, its back towards +z."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Part
from flexdepth.synth.shapes import Array

Parts = list[Part]

Maker = Callable[[Generator], Parts]


def placed(parts: Parts, at: tuple[float, float, float], yaw: float = 0.0) -> Parts:
    """Return the parts turned about the vertical axis and moved."""
    return [Part(part.mesh.placed(at, yaw), part.material) for part in parts]


def bounds(parts: Parts) -> tuple[Array, Array]:
    """Return the low and the high corner of the parts' box."""
    corners = np.concatenate([part.mesh.corners.reshape(-1, 3) for part in parts])
    return corners.min(0), corners.max(0)


def chosen(rng: Generator, makers: tuple[Maker, ...]) -> Parts:
    """Return one of several things."""
    return makers[int(rng.integers(len(makers)))](rng)
