"""How likely each scale of a thing is by its motion: it stays, moves level, or moves anyhow.

References:
    Ozden, Cornelis, Van Eycken and Van Gool, CVIU 2004 (non-accidental motion).
"""

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Kind
from flexdepth.solvers.clues import Clues, Habits, normal

Array = NDArray[np.float64]

_TYPICAL = 0.5
"""How far things move, in ways of the camera."""

_TURNS = 0.01
"""Radians: what is rigid and stays turns by about as much at least, else it would seem still."""

_TILT = 0.025
"""Radians by which a ground's normal errs that hardly anything lies in."""


def motions(clues: Clues, habits: Habits, grid: Array) -> list[Array]:
    """Return the density of each motion on the grid, times that of s for given d."""
    nearness = np.exp(-grid)
    moved = clues.motion * nearness[:, None] - clues.way
    length = np.linalg.norm(moved, axis=1)
    jacobian = np.exp(-3 * (grid - grid[len(grid) // 2]))
    anyhow = _heavy_tailed(length, _TYPICAL, 3)
    stays = _stays(length, habits.stay, clues)
    if clues.floor is None:
        return [stays * jacobian, anyhow * jacobian, anyhow * jacobian]
    rise = moved @ clues.floor.normal
    errs = habits.level[1] + _TILT * (1 - clues.floor.share)
    deviation = np.hypot(habits.level[0] + errs * length, clues.wobble * nearness)
    flat = np.sqrt(np.maximum(length**2 - rise**2, 0))
    level = normal(rise, deviation) * _heavy_tailed(flat, _TYPICAL, 2)
    return [stays * jacobian, level * jacobian, anyhow * jacobian]


def _stays(length: Array, scale: float, clues: Clues) -> Array:
    """Return the density of a place that is kept: some of what bends strays farther.

    What is rigid and does not turn either is no moving thing that stays: a car that drives ahead
    of the camera, in the same direction, is at some scale where it does not move at all.
    """
    if clues.kind is Kind.FLEXIBLE:
        constant = 4 / (3 * np.pi**2 * np.sqrt(3))
        return np.asarray(constant / scale**3 * (1 + (length / scale) ** 2 / 3) ** -3)
    turns = clues.turn**2 / (clues.turn**2 + _TURNS**2)
    density = np.exp(-0.5 * (length / scale) ** 2) / (2 * np.pi * scale**2) ** 1.5
    return np.asarray(turns * density)


def _heavy_tailed(length: Array, scale: float, dimensions: int) -> Array:
    """Return Cauchy's density in some dimensions: far out, hardly any speed is the likelier."""
    constant = {2: 1 / (2 * np.pi), 3: 1 / np.pi**2}[dimensions]
    return np.asarray(
        constant / scale**dimensions * (1 + (length / scale) ** 2) ** (-(1 + dimensions) / 2)
    )
