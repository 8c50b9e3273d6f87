"""Depth and motion of every pixel from two frames of a world in which things move and bend.

The camera's own motion comes first; what does not move as it says are regions of their own.
"""

from dataclasses import dataclass

from flexdepth.solvers.answer import Evidence, Kind, Region, TwoFrame, Unknown
from flexdepth.solvers.dense import Dense, refined_world
from flexdepth.solvers.planes import with_planes
from flexdepth.solvers.prior import with_prior
from flexdepth.solvers.region_solver import solved_regions
from flexdepth.solvers.seen import Prior, Seen, Stereo, ThirdFrame
from flexdepth.solvers.stereo import with_stereo
from flexdepth.solvers.third import with_third
from flexdepth.solvers.verdict import answer

__all__ = [
    "Dense",
    "Evidence",
    "Kind",
    "Prior",
    "Region",
    "Seen",
    "Stereo",
    "ThirdFrame",
    "TwoFrame",
    "TwoFrameSettings",
    "Unknown",
    "two_frame",
]


_DENSE = Dense()


@dataclass(frozen=True)
class TwoFrameSettings:
    """How two frames are solved.

    Attributes:
        dense: The refinement of every pixel; None is regions alone.
        clear: How many standard deviations of parallax make a depth.
    """

    dense: Dense | None = _DENSE
    clear: float = 2.0


def two_frame(seen: Seen, settings: TwoFrameSettings = TwoFrameSettings()) -> TwoFrame:
    """Return depth and motion of every pixel.

    Raises:
        InputError: Fewer than 16 pixels have flow that is to be trusted.
    """
    world = solved_regions(seen, settings.clear)
    if settings.dense is not None:
        world = refined_world(world, settings.dense)
    if seen.third is not None:
        world = with_third(world, seen, seen.third)
    if seen.stereo is not None:
        world = with_stereo(world, seen, seen.stereo)
    if seen.prior is not None:
        world = with_prior(world, seen, seen.prior)
    found = answer(world, seen, settings.clear)
    if seen.image is not None and seen.target is not None:
        found = with_planes(found, seen.image)
    return found
