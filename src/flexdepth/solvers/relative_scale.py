"""How near a thing that moves by itself is: the scale that its own flow leaves open.

Flow sees a region's inverse depth ρ and translation t only as ρ t. For each scale s the posterior
is summed over what the thing may be doing. By its place, it

- stands on the static world where its foot is seen (contact: s is known to a few hundredths),
- hangs on to something still, where flow goes on into it (likewise),
- stands with its foot out of sight, nearer than the ground at its lowest visible part, or
- is in the air, before what it hides (ordering: s has a lower bound only).

What is rigid and on the ground turns about an upright axis, or rolls about a level one: what
tumbles is in the air. And by its motion, it

- stays where it is, as a tree in the wind or a person who waves,
- moves level over the ground, as cars, and all that is pushed or rolls, or
- moves anyhow.

At scale s a point moves by d = a/s - b: b is the camera's way, a the motion of the point over its
depth, which flow tells. A density p(d) becomes s⁻³ p(a/s - b) for s. What fits a narrow density by
chance is rare, so that staying and level motion, where the camera's way shows them, say more of
scale than their names promise. Where a ground is seen, its distance below the camera is a measure:
what moves by itself is about as large as people, animals and cars are beside the height from which
one looks at them. And where a single picture says how near it is, that counts as far as it is to be
believed of what is on the ground, or in the air.

References:
    Ranftl, Vineet, Chen and Koltun, CVPR 2016 (ordering, and contact by smoothness); Ozden,
    Cornelis, Van Eycken and Van Gool, CVIU 2004 (non-accidental motion).
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence
from flexdepth.solvers.clues import HABITS, Clues
from flexdepth.solvers.motions import motions
from flexdepth.solvers.pictured import by_picture
from flexdepth.solvers.places import FEWEST, as_a_part, as_large, places

Array = NDArray[np.float64]

_PART = (1, 3)
"""Where a part of a body is among the places and motions: it hangs on."""

_IN_THE_AIR = 2
"""And that of what is in the air."""

_LEFT = 0.5
"""The share of the variance that the picture leaves at most, if it is what the scale hangs on."""

_WITHIN = 0.1
"""Confidence is the probability of a scale within this part of the one that is said."""


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
    """Return the scale at which depth has the least expected relative error.

    A camera that stays tells of none.

    Args:
        clues: What is seen.
        vague: Standard deviation of ln s above which it counts as unknown.
    """
    unknown = Scale(float(np.exp(clues.typical)), np.inf, 0.0, Evidence.UNKNOWN)
    if not clues.way.any():
        return unknown
    grid, parts = _posterior(clues)
    alone = np.sum(list(parts.values()), axis=0)
    if clues.told is not None:
        grounded, flying = by_picture(clues.told, grid)
        parts = {
            pair: part * (flying if pair[0] == _IN_THE_AIR else grounded)
            for pair, part in parts.items()
        }
    density = np.sum(list(parts.values()), axis=0)
    total = float(density.sum())
    if not total > 0:
        return unknown
    middle, spread = _middle(grid, density)
    confidence = float(density[np.abs(grid - middle) < _WITHIN].sum()) / total
    share = {pair: float(part.sum()) / total for pair, part in parts.items()}
    evidence = _evidence(share, len(clues.border) >= FEWEST and spread < vague)
    if clues.told is not None:
        telling = spread**2 < _LEFT * _middle(grid, alone)[1] ** 2
        evidence = Evidence.PRIOR if telling or evidence is Evidence.UNKNOWN else evidence
    return Scale(
        float(np.exp(middle)),
        np.inf if evidence is Evidence.UNKNOWN else spread,
        0.0 if evidence is Evidence.UNKNOWN else confidence,
        evidence,
    )


def _posterior(clues: Clues) -> tuple[Array, dict[tuple[int, int], Array]]:
    """Return the grid of ln s, and on it each place with each motion, as the frames tell them."""
    habits = HABITS[clues.kind]
    grid, by_place = places(clues, habits)
    by_motion, size = motions(clues, habits, grid), as_large(clues, grid)
    parts = {
        (place, motion): habits.joint[place][motion] * by_place[place] * by_motion[motion] * size
        for place, motion in product(range(len(by_place)), range(len(by_motion)))
    }
    parts[_PART] = habits.part * as_a_part(clues, grid) * by_motion[2]
    return grid, parts


def _middle(grid: Array, density: Array) -> tuple[float, float]:
    """Return `least_error`, and the standard deviation about it; the density may have any sum."""
    middle = least_error(grid, density)
    return middle, float(np.sqrt((density * (grid - middle) ** 2).sum() / density.sum()))


def least_error(grid: Array, density: Array) -> float:
    """Return the ln s that minimises the expectation of |z / z* - 1|, where depth z goes as 1 / s.

    That is the posterior's median when each scale s* weighs s* times as much: to put a thing too
    far makes a larger error than to put it too near.

    Args:
        grid: Values of ln s, ascending.
        density: Of each.
    """
    summed = np.cumsum(density * np.exp(grid - grid[-1]))
    return float(grid[np.searchsorted(summed, summed[-1] / 2)])


def _evidence(share: dict[tuple[int, int], float], known: bool) -> Evidence:
    if sum(part for (place, _), part in share.items() if place < 2) > 0.5:
        return Evidence.CONTACT
    if sum(part for (_, motion), part in share.items() if motion < 2) > 0.5:
        return Evidence.MOTION
    return Evidence.ORDERING if known else Evidence.UNKNOWN
