"""The terms of chapter 5 that hold the scale, which two frames do not tell.

(D, t) and (D s, t s) explain the same flow, and that for each pixel by itself.
"""

from jaxtyping import Float
from torch import Tensor

from flexdepth.geometry.field import norm


def mean_length(t: Float[Tensor, "*batch points 3"], wanted: float) -> Float[Tensor, "*batch"]:
    """Return |mean |t| - wanted|: on average, so that t of some pixels may vanish.

    Args:
        t: Translations.
        wanted: The dissertation's is 0.01.

    References:
        Dissertation, "Average length of t", section 5.4.2.
    """
    return (norm(t).mean(-1) - wanted).abs()


def depth_range(
    depth: Float[Tensor, "*batch points"], nearest: float, farthest: float
) -> Float[Tensor, "*batch"]:
    """Return the mean of how far depth is out of [nearest, farthest].

    With the mean |t| held at 0.01 and depth in metres, at a focal length of 720 pixels and 20 m
    the parallax can be 0.36 pixels; on KITTI, at a metre from frame to frame, it is 36. Then only
    rotations are left to explain the flow. The range must be in the unit of |t|.

    References:
        Dissertation, section 5.5.2.
    """
    return ((nearest - depth).clamp(min=0) + (depth - farthest).clamp(min=0)).mean(-1)


def depth_scale(depth: Float[Tensor, "*batch points"]) -> Float[Tensor, "*batch"]:
    """Return the mean depth, "so that it does not grow large".

    The length of t holds the scale already; a second hold pulls depth away from what is seen.

    References:
        Dissertation, section 5.5.2.
    """
    return depth.abs().mean(-1)
