"""The terms of chapter 5 about optical flow: it agrees with matches, and keeps the brightness."""

from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.geometry.field import slopes
from flexdepth.geometry.warp import warped


def sparse_flow(
    flow: Float[Tensor, "*batch points 2"], shift: Float[Tensor, "*batch points 2"]
) -> Float[Tensor, "*batch points"]:
    """Return |shift - flow|, summed over x and y, of each match; pixels.

    Args:
        flow: At the matches' places in the key frame.
        shift: p_t - p_k of the matches.

    References:
        Dissertation, (5.27). Flow is sampled at p_k, as its text says and its formula does not.
    """
    return (shift - flow).abs().sum(-1)


def photometric(
    key: Float[Tensor, "*batch channels height width"],
    target: Float[Tensor, "*batch channels height width"],
    flow: Float[Tensor, "*batch height width 2"],
) -> tuple[Float[Tensor, "*batch height width"], Bool[Tensor, "*batch height width"]]:
    """Return |I_t(p + flow) - I_k(p)|, the mean over the channels, and where it is known.

    Args:
        key: In [0, 1].
        target: Likewise.
        flow: Pixels.

    References:
        Dissertation, (5.32), corrected: by warping, which holds for flow of any length, while the
        linear form holds for about a pixel.
    """
    seen, inside = warped(target, flow)
    return (seen - key).abs().mean(-3), inside


def brightness_as_written(
    key: Float[Tensor, "*batch channels height width"],
    target: Float[Tensor, "*batch channels height width"],
    flow: Float[Tensor, "*batch height width 2"],
) -> Float[Tensor, "*batch height-1 width-1"]:
    """Return |I_x u + I_y v + I_t - I_k| at each pixel but the last row and column.

    Args:
        key: In [0, 1].
        target: Likewise.
        flow: u and v, pixels.

    References:
        Dissertation, (5.32): constant brightness, expanded to first order about the key frame, with
        a time step of 1. It is the optical-flow constraint, not a heat equation. In the text I_t is
        both the target frame and the derivative by time.
    """
    across, down = slopes(key)
    u, v = (flow[..., None, :-1, :-1, axis] for axis in (0, 1))
    later = (target - key)[..., :-1, :-1]
    return (across * u + down * v + later).abs().mean(-3)
