"""Depth and motion of every pixel from two frames of a world in which things move and bend.

The camera's own motion comes first; what does not move as it says are regions of their own.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence, Kind, Region, TwoFrame, Unknown
from flexdepth.solvers.seen import Prior, Seen, Stereo, ThirdFrame
from flexdepth.solvers.state import answer, solved_regions

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

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Dense:
    """Refinement of depth and motion at every pixel.

    Attributes:
        steps: Gauss-Newton steps at the finest level.
    """

    steps: int = 6


@dataclass(frozen=True)
class TwoFrameSettings:
    """How two frames are solved.

    Attributes:
        dense: The refinement of every pixel; None is regions alone.
        clear: How many standard deviations of parallax make a depth.
    """

    dense: Dense | None = Dense()
    clear: float = 2.0


def two_frame(seen: Seen, settings: TwoFrameSettings = TwoFrameSettings()) -> TwoFrame:
    """Return depth and motion of every pixel.

    Raises:
        InputError: Fewer than 16 pixels have flow that is to be trusted.
    """
    return answer(solved_regions(seen, settings.clear), seen, settings.clear)
