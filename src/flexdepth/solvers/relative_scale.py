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
from flexdepth.solvers.ground import Ground

Array = NDArray[np.float64]

_GRID = np.arange(-3.6, 3.6, 0.02)
"""ln s about a first guess."""

_FEWEST = 3
"""Border pixels that make a contact or a bound."""

_FOOT = 0.08
"""The lowest part of a thing's height that is its foot."""

_SLOPE = 2e-3
"""Relative change of inverse depth per pixel: ground below a thing comes nearer downwards."""

_BOUND = 0.75
"""The quantile of the ratios along the border that ordering goes by: some are wrong."""

_SURE = 0.3
"""The share of a foot's lower border that ground is seen below at least."""

_VAGUE = 0.15
"""Where the foot is not seen, what is below a thing falls short of a contact, in ln s."""

_OVER, _LOOSE = 0.5, 0.4
"""What is in the air is nearer than what it hides by about this, in ln s, and its deviation."""

_ABOVE = 0.2
"""And nearer than most of what is still, likewise."""

_TYPICAL = 0.8
"""How far things move, in ways of the camera."""

_WITHIN = 0.1
"""Confidence is the probability of a scale within this part of the one that is said."""


@dataclass(frozen=True)
class _Habits:
    """What is known beforehand of rigid, or of bending things.

    Attributes:
        joint: Probability of standing, of hanging on to what is still, and of being in the air;
            each with that of staying, of moving level, and of moving anyhow.
        contact: Standard deviation of ln s at a contact.
        stay: Scale of how far from its place a thing strays that stays, in ways of the camera.
        level: Standard deviation of the rise of what moves level, likewise, and per its own way.
    """

    joint: tuple[tuple[float, float, float], ...]
    contact: float
    stay: float
    level: tuple[float, float]


_HABITS = {
    Kind.RIGID: _Habits(
        ((0.05, 0.59, 0.003), (0.0, 0.0, 0.0), (0.03, 0.16, 0.16)), 0.05, 0.02, (0.006, 0.004)
    ),
    Kind.FLEXIBLE: _Habits(
        ((0.25, 0.13, 0.17), (0.1, 0.0, 0.05), (0.12, 0.05, 0.13)), 0.1, 0.08, (0.05, 0.05)
    ),
}

_TILT = 0.1
"""Radians by which a ground's normal errs that hardly anything lies in."""


@dataclass(frozen=True, eq=False)
class Clues:
    """What is seen of one thing.

    Attributes:
        kind: Rigid or flexible.
        border: Its border with the static world.
        motion: a: of its middle, at scale 1.
        wobble: How far a is uncertain, because the middle of what turns is not seen.
        way: b: the camera's.
        floor: The ground, if there is one.
        typical: ln s that puts it among what is still: a first guess, no clue.
    """

    kind: Kind
    border: Border
    motion: Array
    wobble: float
    way: Array
    floor: Ground | None
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
    """Return the scale that has most of the posterior about it. A camera that stays tells of none.

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
        (place, motion): habits.joint[place][motion] * places[place] * motions[motion]
        for place, motion in product(range(3), range(3))
    }
    density = np.sum(list(parts.values()), axis=0)
    total = float(density.sum())
    if not total > 0:
        return unknown
    density /= total
    within = max(1, round(_WITHIN / float(grid[1] - grid[0])))
    near = np.convolve(density, np.hanning(2 * within + 3)[1:-1], "same")
    middle = float(grid[np.argmax(near)])
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
    bound, attached = _bound(border), _attached(border)
    grid = _GRID + (clues.typical if bound is None else bound)
    nowhere = np.zeros_like(grid)
    contact = _contact(border, habits.contact)
    places = [
        nowhere if contact is None else _touching(grid - contact[0], contact[1]),
        nowhere if attached is None else _normal(grid - attached, habits.contact),
    ]
    if bound is None:
        return grid, [*places, _normal(grid - clues.typical - _OVER, 1.0)]
    if contact is not None:
        bound = max(bound, contact[0])
    over = grid - bound
    before = 1 / (1 + np.exp(-np.clip(over / 0.05, -50, 50)))
    likely = max(_OVER, clues.typical + _ABOVE - bound)
    return grid, [*places, before * _normal(over - likely, _LOOSE)]


def _bound(border: Border) -> float | None:
    """Return the least ln s that puts the thing before what it hides; None if that is nothing."""
    before = border.ratio[border.hidden >= 0]
    if len(before) < _FEWEST:
        return None
    ratio = float(np.quantile(before, _BOUND))
    return float(np.log(ratio)) if ratio > 0 else None


def _contact(border: Border, deviation: float) -> tuple[float, float] | None:
    """Return ln s, and its deviation, where the thing stands on what is seen below it.

    Where its foot is not seen, but ground below it is, it stands a little nearer than that.
    """
    if len(border) < _FEWEST:
        return None
    foot = border.row.max() - max(2.0, _FOOT * float(np.ptp(border.row)))
    lowest = border.down & (border.row >= foot)
    ground = border.down & (border.slope > _SLOPE) & (border.ratio > 0)
    under = lowest & ground
    if under.sum() >= max(_FEWEST, _SURE * float(lowest.sum())):
        return float(np.log(np.quantile(border.ratio[under], 0.75))), deviation
    half = ground & (border.row >= (float(border.row.max()) + float(border.row.min())) / 2)
    if lowest.sum() < _FEWEST and half.sum() >= 2 * _FEWEST:
        return float(np.log(np.quantile(border.ratio[half], 0.85))) + deviation, _VAGUE
    return None


def _touching(off: Array, deviation: float) -> Array:
    """Return the density of ln s at a contact: one in seven of them errs by three times as much."""
    return 0.85 * _normal(off, deviation) + 0.15 * _normal(off, 3 * deviation)


def _attached(border: Border) -> float | None:
    """Return ln s where the flow goes on from what is still into the thing; None where nowhere."""
    joined = (border.jump < 0.3) & (border.ratio > 0)
    return float(np.log(np.median(border.ratio[joined]))) if joined.sum() >= _FEWEST else None


def _motions(clues: Clues, habits: _Habits, grid: Array) -> list[Array]:
    """Return the density of each motion on the grid, times that of s for given d."""
    nearness = np.exp(-grid)
    moved = clues.motion * nearness[:, None] - clues.way
    length = np.linalg.norm(moved, axis=1)
    jacobian = np.exp(-3 * (grid - grid[len(grid) // 2]))
    anyhow = _heavy_tailed(length, _TYPICAL, 3)
    stays = _stays(length, habits.stay, clues.kind)
    if clues.floor is None:
        return [stays * jacobian, anyhow * jacobian, anyhow * jacobian]
    rise = moved @ clues.floor.normal
    errs = habits.level[1] + _TILT * (1 - clues.floor.share)
    deviation = np.hypot(habits.level[0] + errs * length, clues.wobble * nearness)
    flat = np.sqrt(np.maximum(length**2 - rise**2, 0))
    level = _normal(rise, deviation) * _heavy_tailed(flat, _TYPICAL, 2)
    return [stays * jacobian, level * jacobian, anyhow * jacobian]


def _stays(length: Array, scale: float, kind: Kind) -> Array:
    """Return the density of a place that is kept: some of what bends strays farther."""
    if kind is Kind.FLEXIBLE:
        constant = 4 / (3 * np.pi**2 * np.sqrt(3))
        return np.asarray(constant / scale**3 * (1 + (length / scale) ** 2 / 3) ** -3)
    return np.asarray(np.exp(-0.5 * (length / scale) ** 2) / (2 * np.pi * scale**2) ** 1.5)


def _normal(values: Array, deviation: Array | float) -> Array:
    return np.asarray(np.exp(-0.5 * (values / deviation) ** 2) / (np.sqrt(2 * np.pi) * deviation))


def _heavy_tailed(length: Array, scale: float, dimensions: int) -> Array:
    """Return Cauchy's density in some dimensions: far out, hardly any speed is the likelier."""
    constant = {2: 1 / (2 * np.pi), 3: 1 / np.pi**2}[dimensions]
    return np.asarray(
        constant / scale**dimensions * (1 + (length / scale) ** 2) ** (-(1 + dimensions) / 2)
    )
