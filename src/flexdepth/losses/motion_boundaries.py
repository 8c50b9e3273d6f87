"""The moving-object term of chapter 5: motion is the same from pixel to pixel, but at borders.

Both forms take how much each component of the motion (n and t) rises to the next pixel, one way.
"""

import torch
from jaxtyping import Float
from torch import Tensor

_SMALLEST = 1e-12
"""Slope below which nothing is a border, so that a constant field divides by no zero."""


def motion_boundaries(
    rise: Float[Tensor, "*batch channels height width"], quantile: float
) -> Float[Tensor, "*batch"]:
    """Return `mean s |e|² / (s² + |e|²)`, e the rise of all components of a pixel together.

    About |e|² / s where |e| is small beside s, and s at most: what rises most is let go. s is the
    quantile of |e| over the picture and takes no gradient. Since |e| is that of the whole vector,
    the components of a motion have one border (Geman and McClure's weight, shared).

    Args:
        rise: To the next pixel, in one unit for all components.
        quantile: ρ, the share of pixels inside objects.

    References:
        Dissertation, (5.33) and (5.34), corrected: `motion_boundaries_as_written`.
    """
    square = rise.square().sum(-3).flatten(-2)
    scale = square.detach().quantile(quantile, -1, keepdim=True).clamp(min=_SMALLEST**2)
    return (scale.sqrt() * square / (scale + square)).mean(-1)


def motion_boundaries_as_written(
    rise: Float[Tensor, "*batch channels height width"], quantile: float
) -> Float[Tensor, "*batch"]:
    """Return the mean over channels and pixels of |rise| where it is below its channel's quantile.

    What is exempt is a share 1 - ρ of each component fixed beforehand, whether there is a border or
    not, and the borders of the six components need not be the same.

    Args:
        rise: To the next pixel; radians and lengths alike.
        quantile: ρ.

    References:
        Dissertation, (5.33) and (5.34), with one direction at a time as its text says.
    """
    size = rise.abs().flatten(-2)
    limit = size.detach().quantile(quantile, -1, keepdim=True)
    return torch.where(size < limit, size, 0.0).mean((-2, -1))
