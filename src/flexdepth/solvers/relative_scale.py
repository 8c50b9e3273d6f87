"""How near a thing that moves by itself is: the scale that its own flow leaves open.

Flow sees a region's inverse depth ρ and translation t only as ρ t. For each scale s the posterior
is summed over what the thing may be doing. By its place, it

- stands on the static world where its foot is seen (contact: s is known to a few hundredths), or
- is in the air, before what it hides (ordering: s has a lower bound only);

and by its motion, it

- stays where it is, as a tree in the wind or a person who waves,
- moves level over the ground, as cars, and all that is pushed or rolls, or
- moves anyhow.

At scale s a point moves by d = a/s - b: b is the camera's way, a the motion of the point over its
depth, which flow tells. A density p(d) becomes s⁻³ p(a/s - b) for s. What fits a narrow density by
chance is rare, so that staying and level motion, where the camera's way shows them, say more of
scale than their names promise.

References:
    Ranftl, Vineet, Chen and Koltun, CVPR 2016 (ordering, and contact by smoothness); Ozden,
    Cornelis, Van Eycken and Van Gool, CVIU 2004 (non-accidental motion).
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence, Kind
from flexdepth.solvers.borders import Border

Array = NDArray[np.float64]

_GRID = np.arange(-3.6, 3.6, 0.02)
"""ln s about a first guess."""

_FEWEST = 3
"""Border pixels that make a contact or a bound."""

_FOOT = 0.08
"""The lowest part of a thing's height that is its foot."""

_SLOPE = 2e-3
"""Relative change of inverse depth per pixel: ground below a thing comes nearer downwards."""

_BOUND = 0.85
"""The quantile of the ratios along the border that ordering goes by: a few are wrong."""

_TYPICAL = 0.8
"""How far things move, in ways of the camera."""

_WITHIN = 0.1
"""Confidence is the probability of a scale within this part of the one that is said."""


@dataclass(frozen=True)
class _Habits:
    """What is known beforehand of rigid, or of bending things.

    Attributes:
        places: Probability of standing, of hanging on to what is still, and of being in the air.
        motions: Of staying, of moving level, and of moving anyhow.
        contact: Standard deviation of ln s at a contact.
        stay: Of a place kept, in ways of the camera.
        level: Of the height of what moves level, likewise, and per its own way.
    """

    places: tuple[float, float, float]
    motions: tuple[float, float, float]
    contact: float
    stay: float
    level: tuple[float, float]


_HABITS = {
    Kind.RIGID: _Habits((0.65, 0.0, 0.35), (0.05, 0.65, 0.3), 0.05, 0.02, (0.006, 0.004)),
    Kind.FLEXIBLE: _Habits((0.55, 0.1, 0.35), (0.45, 0.2, 0.35), 0.1, 0.05, (0.05, 0.05)),
}


@dataclass(frozen=True, eq=False)
class Clues:
    """What is seen of one thing.

    Attributes:
        kind: Rigid or flexible.
        border: Its border with the static world.
        motion: a: of its middle, at scale 1.
        way: b: the camera's.
        down: The ground's normal; None where there is no ground.
        typical: ln s that puts it among what is still: a first guess, no clue.
    """

    kind: Kind
    border: Border
    motion: Array
    way: Array
    down: Array | None
    typical: float


@dataclass(frozen=True)
class Scale:
    """A region's scale.

    Attributes:
        value: s: its inverse depths times s, its translation over s, are those of the world.
        spread: Standard deviation of ln s; +inf where it is not known.
        confidence: The probability that it is right within a tenth.
        evidence: What it mostly hangs on.
    """

    value: float
    spread: float
    confidence: float
    evidence: Evidence


def relative_scale(clues: Clues, vague: float = 0.7) -> Scale:
    """Return the likeliest scale: the posterior's median. A camera that stays tells of none.

    Args:
        clues: What is seen.
        vague: Standard deviation of ln s above which it counts as unknown.
    """
    unknown = Scale(float(np.exp(clues.typical)), np.inf, 0.0, Evidence.UNKNOWN)
    if not clues.way.any():
        return unknown
    habits = _HABITS[clues.kind]
    grid, places = _places(clues, habits)
    motions = _motions(clues, habits, grid)
    parts = {
        (place, motion): habits.places[place]
        * habits.motions[motion]
        * places[place]
        * motions[motion]
        for place, motion in product(range(3), range(3))
    }
    density = np.sum(list(parts.values()), axis=0)
    total = float(density.sum())
    if not total > 0:
        return unknown
    density /= total
    below = np.cumsum(density)
    middle = float(np.interp(0.5, below, grid))
    spread = float(np.sqrt((density * (grid - middle) ** 2).sum()))
    confidence = float(density[np.abs(grid - middle) < _WITHIN].sum())
    share = {pair: float(part.sum()) / total for pair, part in parts.items()}
    evidence = _evidence(share, len(clues.border) >= _FEWEST and spread < vague)
    return Scale(
        float(np.exp(middle)),
        np.inf if evidence is Evidence.UNKNOWN else spread,
        0.0 if evidence is Evidence.UNKNOWN else confidence,
        evidence,
    )


def _evidence(share: dict[tuple[int, int], float], known: bool) -> Evidence:
    if sum(part for (place, _), part in share.items() if place < 2) > 0.5:
        return Evidence.CONTACT
    if sum(part for (_, motion), part in share.items() if motion < 2) > 0.5:
        return Evidence.MOTION
    return Evidence.ORDERING if known else Evidence.UNKNOWN


def _places(clues: Clues, habits: _Habits) -> tuple[Array, list[Array]]:
    """Return the grid of ln s, and on it the density of each place."""
    border = clues.border
    bound = float(np.log(np.quantile(border.ratio, _BOUND))) if _usable(border) else None
    grid = _GRID + (clues.typical if bound is None else bound)
    contact, attached = _contact(border), _attached(border)
    places = [
        _normal(grid - contact, habits.contact) if contact is not None else np.zeros_like(grid),
        _normal(grid - attached, habits.contact) if attached is not None else np.zeros_like(grid),
    ]
    if bound is None:
        return grid, [*places, _normal(grid - clues.typical - 0.5, 1.0)]
    over = grid - max(bound, contact if contact is not None else bound)
    before = 1 / (1 + np.exp(-np.clip(over / 0.05, -50, 50)))
    return grid, [*places, before * _normal(over - 0.4, 0.5)]


def _usable(border: Border) -> bool:
    return len(border) >= _FEWEST and bool(np.quantile(border.ratio, _BOUND) > 0)


def _contact(border: Border) -> float | None:
    """Return ln s where the thing stands on what is seen below it; None where nothing is."""
    if len(border) < _FEWEST:
        return None
    lowest = border.row.max()
    foot = lowest - max(2.0, _FOOT * float(np.ptp(border.row)))
    under = border.down & (border.slope > _SLOPE) & (border.ratio > 0)
    under &= border.row >= foot
    if under.sum() < _FEWEST:
        return None
    return float(np.log(np.quantile(border.ratio[under], 0.75)))


def _attached(border: Border) -> float | None:
    """Return ln s where the flow goes on from what is still into the thing; None where nowhere."""
    joined = (border.jump < 0.3) & (border.ratio > 0)
    return float(np.log(np.median(border.ratio[joined]))) if joined.sum() >= _FEWEST else None


def _motions(clues: Clues, habits: _Habits, grid: Array) -> list[Array]:
    """Return the density of each motion on the grid, times that of s for given d."""
    moved = clues.motion * np.exp(-grid)[:, None] - clues.way
    length = np.linalg.norm(moved, axis=1)
    jacobian = np.exp(-3 * (grid - grid[len(grid) // 2]))
    anyhow = _student(length, _TYPICAL, 3)
    stays = np.exp(-0.5 * (length / habits.stay) ** 2) / (2 * np.pi * habits.stay**2) ** 1.5
    if clues.down is None:
        return [stays * jacobian, anyhow * jacobian, anyhow * jacobian]
    rise = moved @ clues.down
    deviation = habits.level[0] + habits.level[1] * length
    flat = np.sqrt(np.maximum(length**2 - rise**2, 0))
    level = _normal(rise, deviation) * _student(flat, _TYPICAL, 2)
    return [stays * jacobian, level * jacobian, anyhow * jacobian]


def _normal(values: Array, deviation: Array | float) -> Array:
    return np.asarray(np.exp(-0.5 * (values / deviation) ** 2) / (np.sqrt(2 * np.pi) * deviation))


def _student(length: Array, scale: float, dimensions: int) -> Array:
    """Return Student's density with 3 degrees of freedom at a distance from the middle."""
    constant = {2: 1 / (2 * np.pi), 3: 4 / (3 * np.pi**2 * np.sqrt(3))}[dimensions]
    return np.asarray(
        constant / scale**dimensions * (1 + (length / scale) ** 2 / 3) ** (-(3 + dimensions) / 2)
    )
