"""How likely each scale of a thing is by its place.

It stands where its foot is seen, hangs on to what is still, is in the air, or stands with its foot
out of sight.

References:
    Ranftl, Vineet, Chen and Koltun, CVPR 2016 (ordering, and contact by smoothness).
"""

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.borders import Border
from flexdepth.solvers.clues import Clues, Habits, normal

Array = NDArray[np.float64]

_REACH, _STEP = 3.6, 0.02
"""How far ln s is looked for beyond the first guesses, and how finely."""

FEWEST = 3
"""Border pixels that make a contact or a bound."""

_FOOT = 0.08
"""The lowest part of a thing's height that is its foot."""

_SLOPE = 2e-3
"""Relative change of inverse depth per pixel: ground below a thing comes nearer downwards."""

_NEAREST = 0.9
"""The quantile of the ratios under a foot that is its contact: the nearest part touches."""

_LEAP = 1.5
"""How much nearer than half of what is below a foot its ground is at most: what is more so, as a
bed before it, hides it."""

_BOUND = 0.6
"""The quantile of the ratios along the border that ordering goes by: some are wrong."""

_SURE = 0.3
"""The share of a foot's lower border that ground is seen below at least."""

_VAGUE = 0.15
"""Where the foot is not seen, what is below a thing falls short of a contact, in ln s."""

_BELOW, _DEEP = 0.47, 0.4
"""How much nearer than the ground at its lowest visible part a thing is whose foot is hidden, in
ln s, and the deviation."""

_COVERED = 0.3
"""How often ground seems to be seen all along below what hides its foot."""

_OVER, _LOOSE = 0.7, 0.6
"""What is in the air is nearer than what it hides by about this, in ln s, and its deviation."""

_ABOVE = 0.2
"""And nearer than most of what is still, likewise."""

_WRONG = 0.1
"""The share of orderings that are: something before the thing was taken for what it hides."""

_SIZE = (0.5, 0.9)
"""The square root of the area that a thing shows, in heights of the camera over the ground: its
median, and the deviation of its logarithm."""

_JOINT = 0.1
"""The deviation of ln s between parts of a body that touch."""

_UPRIGHT = (0.003, 3.0)
"""The deviation of the radians by which what is on the ground tips over: at least, and in those by
which its flow is uncertain. (A turn about a level axis looks much like a rise.)"""

_TUMBLES = 0.1
"""The typical radians by which what is in the air does."""

_FALLS, _HOVERS = 0.03, 0.15
"""The share of what is on the ground that tips over, and of what is in the air that does not."""

_LYING = 0.03
"""The deviation of ln s of a ball that lies on the ground."""


def places(clues: Clues, habits: Habits) -> tuple[Array, list[Array]]:
    """Return the grid of ln s, and on it the density of each place, in the order of `Habits`."""
    border = clues.border
    bound, attached = _bound(border), _attached(border)
    rests, flies = _tipping(clues.tips)
    guesses = (clues.typical, clues.typical if bound is None else bound)
    grid = np.arange(min(guesses) - _REACH, max(guesses) + _REACH, _STEP)
    nowhere = np.zeros_like(grid)
    contact = _contact(border, habits) if clues.rest is None else (clues.rest, _LYING)
    standing = nowhere if contact is None else rests * _touching(grid - contact[0], contact[1])
    hangs = nowhere if attached is None else normal(grid - attached, habits.contact)
    hidden = nowhere if clues.foot is None else rests * _hidden(grid - clues.foot)
    if contact is not None and contact[1] < _VAGUE:
        hidden = _COVERED * hidden
    if bound is None:
        flying = flies * normal(grid - clues.typical - _OVER, 1.0)
        return grid, [standing, hangs, flying, hidden]
    hangs = hangs * _before(grid - bound)
    if contact is not None:
        bound = max(bound, contact[0])
    over = grid - bound
    likely = max(_OVER, clues.typical + _ABOVE - bound)
    return grid, [standing, hangs, flies * _before(over) * normal(over - likely, _LOOSE), hidden]


def _before(over: Array) -> Array:
    """Return how likely a thing is seen so far before what it hides, in ln s."""
    return _WRONG + (1 - _WRONG) / (1 + np.exp(-np.clip(over / 0.05, -50, 50)))


def _tipping(tips: tuple[float, float] | None) -> tuple[float, float]:
    """Return how likely it is for what is on the ground, and what is in the air, to turn so.

    Both beside what turns anyhow, as a limb does.

    Args:
        tips: As in `Clues`.
    """
    if tips is None:
        return 1.0, 1.0
    spread = _UPRIGHT[0] + _UPRIGHT[1] * tips[1]
    anyhow = 2 / (np.pi * _TUMBLES * (1 + (tips[0] / _TUMBLES) ** 2))
    times = float(2 * normal(np.array(tips[0]), spread) / anyhow)
    return _FALLS + (1 - _FALLS) * times, 1 - _HOVERS + _HOVERS * times


def _bound(border: Border) -> float | None:
    """Return the least ln s that puts the thing before what it hides; None if that is nothing."""
    before = border.ratio[border.hidden >= 0]
    if len(before) < FEWEST:
        return None
    ratio = float(np.quantile(before, _BOUND))
    return float(np.log(ratio)) if ratio > 0 else None


def _contact(border: Border, habits: Habits) -> tuple[float, float] | None:
    """Return ln s, and its deviation, where the thing stands on what is seen below it.

    Where its foot is not seen, but ground below it is, it stands a little nearer than that.
    """
    if len(border) < FEWEST:
        return None
    top, base = float(border.row.min()), float(border.row.max())
    foot = base - max(2.0, _FOOT * (base - top))
    lowest = border.down & (border.row >= foot)
    ground = border.down & (border.slope > _SLOPE) & (border.ratio > 0)
    under = lowest & ground
    least = max(FEWEST, _SURE * lowest.sum(), habits.shown * (border.lower >= foot).sum())
    if under.sum() >= least:
        ratio = border.ratio[under]
        ratio = ratio[ratio < _LEAP * np.median(ratio)]
        return float(np.log(np.quantile(ratio, _NEAREST))) + habits.lifted, habits.contact
    half = ground & (border.row >= (base + top) / 2)
    if lowest.sum() < FEWEST and half.sum() >= 2 * FEWEST:
        return float(np.log(np.quantile(border.ratio[half], 0.85))) + habits.contact, _VAGUE
    return None


def _touching(off: Array, deviation: float) -> Array:
    """Return the density of ln s at a contact: one in seven of them errs by three times as much."""
    return 0.85 * normal(off, deviation) + 0.15 * normal(off, 3 * deviation)


def _hidden(nearer: Array) -> Array:
    """Return the density of ln s beyond that of the lowest visible part on the ground."""
    return np.where(nearer > 0, normal(nearer - _BELOW, _DEEP), 0.0)


def _attached(border: Border) -> float | None:
    """Return ln s where the flow goes on from what is still into the thing; None where nowhere."""
    joined = (border.jump < 0.3) & (border.ratio > 0)
    return float(np.log(np.median(border.ratio[joined]))) if joined.sum() >= FEWEST else None


def as_large(clues: Clues, grid: Array) -> Array:
    """Return the density of the size that a thing has at each scale; 1 where no ground is seen."""
    if clues.floor is None:
        return np.ones_like(grid)
    heights = clues.size * float(np.linalg.norm(clues.floor.plane))
    return normal(np.log(heights / _SIZE[0]) - grid, _SIZE[1])


def as_a_part(clues: Clues, grid: Array) -> Array:
    """Return the density of a part of a body, as a limb is: it is as near as what it touches.

    Parts are of any size, as likely as a thing would on the average be of its own.
    """
    if clues.beside is None:
        return np.zeros_like(grid)
    size = 1.0 if clues.floor is None else 1 / (2 * np.sqrt(np.pi) * _SIZE[1])
    return size * normal(grid - clues.beside, _JOINT)
