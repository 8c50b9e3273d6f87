"""Which of several motions two frames tell of.

References:
    Torr, An assessment of information criteria for motion model selection, CVPR 1997; Torr,
    Geometric motion segmentation and model selection, Phil. Trans. R. Soc. A 356, 1998 (GRIC).
"""

from dataclasses import dataclass
from enum import StrEnum
from math import log

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class MotionKind(StrEnum):
    """What the camera has done, from the simplest to the most general."""

    STILL = "still"
    """Nothing."""
    ROTATION = "rotation"
    """It has turned, and stayed where it was as far as the frames tell."""
    PLANE = "plane"
    """It has moved before a plane: another motion may explain the same."""
    GENERAL = "general"
    """It has moved, and the scene shows relief."""


@dataclass(frozen=True)
class Complexity:
    """How much a kind of motion can explain.

    Attributes:
        parameters: Numbers that say which motion.
        dimension: Of the surface on which the matches (u, v, u', v') then lie: 2 where the place
            in the target follows from that in the key frame, 3 where only a line does.
    """

    parameters: int
    dimension: int


COMPLEXITY = {
    MotionKind.STILL: Complexity(0, 2),
    MotionKind.ROTATION: Complexity(3, 2),
    MotionKind.PLANE: Complexity(8, 2),
    MotionKind.GENERAL: Complexity(5, 3),
}

_COORDINATES = 4


def gric(square: Array, complexity: Complexity) -> float:
    """Return Σ min(e², 2 (4 - d)) + n d log 4 + k log 4n over n matches; smaller is better.

    A motion with a free place along a line (d = 3) must save 1.4 in e² at each match beside one
    without (d = 2), of which 1 is due to the component that it does not have to explain: what
    decides is whether the relief shows more than about .6 standard deviations of the flow at the
    matches, not how many they are. So errors that neighbours share do not pass for evidence.

    Args:
        square: e², squared residuals in standard deviations of their noise.
        complexity: Of the kind of motion.
    """
    count = len(square)
    cut = 2.0 * (_COORDINATES - complexity.dimension)
    misfit = float(np.minimum(square, cut).sum())
    freedom = count * complexity.dimension * log(_COORDINATES)
    return misfit + freedom + complexity.parameters * log(_COORDINATES * count)
