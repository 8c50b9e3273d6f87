"""What a single picture says of depth, and how likely each scale of a thing is by that.

A picture tells how far things on the ground are by where they stand, and errs there by about a
fifth. What is in the air it puts among what is seen behind it, too far by anything.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.clues import normal
from flexdepth.solvers.fusion import common_factor
from flexdepth.solvers.seen import Prior

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_ERRS, _DOUBTED = 0.2, 0.5
"""Deviation of ln s of what is on the ground by a picture that has no doubt, and what each unit of
its doubt adds, as the root of the sum of squares: pixels of a thing share some of their error."""

_MISSED = 0.2
"""The share of things that the picture has not made out."""

_AWAY, _ASTRAY = 0.2, 0.5
"""By how much it puts such things on the ground too far, and the deviation."""

_BEHIND, _LOOSE, _ANYWHERE = 0.5, 1.0, 3.0
"""By how much it puts too far what is in the air, the deviation, and that of what it missed."""

_LEAST_SPREAD = 0.02
"""Relative: what is seen better than this tells a picture's unit no better for it."""


@dataclass(frozen=True, eq=False)
class Pictured:
    """Depth from the key frame alone, in a unit of its own.

    Attributes:
        inverse_depth: Height x width; NaN where it says none, as in the sky.
        doubt: Its relative standard deviation; +inf there.
    """

    inverse_depth: Array
    doubt: Array

    def unit(self, seen: Array, spread: Array, where: Mask) -> tuple[float, float] | None:
        """Return the factor to the unit of what is seen, as `common_factor`.

        Args:
            seen: Inverse depth; NaN is unknown.
            spread: Its relative standard deviation.
            where: What has one unit: the static world, or a region.
        """
        certain = where / np.maximum(spread, _LEAST_SPREAD) ** 2
        return common_factor(self.inverse_depth, seen, certain)

    def of_thing(self, inside: Mask, own: Array) -> tuple[float, float] | None:
        """Return ln s at which a thing is as near as this says, and its doubt; None if nothing.

        Args:
            inside: Where the thing is.
            own: Its inverse depth at scale 1 in the unit of this; NaN or 0 is unknown.
        """
        certain = np.where(inside, 1 / self.doubt**2, 0.0)
        found = common_factor(own, self.inverse_depth, certain)
        if found is None:
            return None
        return float(np.log(found[0])), float(1 / np.sqrt(np.median(certain[certain > 0])))


def pictured(prior: Prior) -> Pictured:
    """Return what the prior says of all that has a depth."""
    depth = np.asarray(prior.depth, np.float64)
    usable = np.isfinite(depth) & (depth > 0)
    return Pictured(
        np.where(usable, 1 / np.where(usable, depth, 1.0), np.nan),
        np.where(usable, np.asarray(prior.spread, np.float64), np.inf),
    )


def by_picture(told: tuple[float, float], grid: Array) -> tuple[Array, Array]:
    """Return the density of what a picture says of a thing on the ground, and of one in the air.

    Args:
        told: As `Pictured.of_thing` has it.
        grid: Values of ln s.
    """
    nearer = told[0] - grid
    made_out = normal(nearer, float(np.hypot(_ERRS, _DOUBTED * told[1])))
    grounded = (1 - _MISSED) * made_out + _MISSED * normal(nearer + _AWAY, _ASTRAY)
    behind = nearer + _BEHIND
    flying = (1 - _MISSED) * normal(behind, _LOOSE) + _MISSED * normal(behind, _ANYWHERE)
    return grounded, flying
