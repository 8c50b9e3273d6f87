"""The loss of a predicted spread: two quantiles of the error that it foretells."""

from dataclasses import dataclass
from math import erf, log, sqrt

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.sample import Prediction, Sample, true_depth

WITHIN_ONE, WITHIN_TWO = erf(1 / sqrt(2)), erf(2 / sqrt(2))
"""The shares of a normal variable within one and two standard deviations: .683 and .954."""

_SMALLEST = 1e-4
"""Relative error that counts as none."""


def pinball(
    value: Float[Tensor, "*shape"], quantile: Float[Tensor, "*shape"], level: float
) -> Float[Tensor, "*shape"]:
    """Return `max(q u, (q − 1) u)` with `u = value − quantile` and q the level.

    Its mean is least where a share q of the values lies below the quantile.

    References:
        Koenker and Bassett, Regression quantiles, Econometrica 1978.
    """
    above = value - quantile
    return torch.maximum(level * above, (level - 1) * above)


def spread_quantiles(
    depth: Float[Tensor, "b h w"],
    spread: Float[Tensor, "b h w"],
    truth: Float[Tensor, "b h w"],
    valid: Bool[Tensor, "b h w"],
) -> Float[Tensor, " b"]:
    """Return how badly `spread` says where 68 % and 95 % of the errors end, per image.

    The error is `|log depth − log truth − m|`, with m the image's median of the difference: the
    one factor of the whole map is not the pixel's doing. In the logarithm, the spread is held to
    the quantile at .683 of the errors, and twice the spread to the quantile at .954; where errors
    are normal both name the standard deviation. No gradient reaches `depth`. An image with no valid
    pixel has loss zero.

    Args:
        depth: Positive wherever valid.
        spread: Positive.
        truth: Positive wherever valid, in the unit of `depth`.
        valid: The pixels that count.
    """
    count = valid.sum((-2, -1)).clamp(min=1)
    difference = (depth.detach().where(valid, 1.0) / truth.where(valid, 1.0)).log()
    known = difference.where(valid, torch.nan).flatten(-2)
    middle = known.nanmedian(-1).values.nan_to_num(nan=0.0)[..., None, None]
    error = (difference - middle).abs().clamp(min=_SMALLEST).log()
    said = spread.where(valid, 1.0).log()
    badness = pinball(error, said, WITHIN_ONE) + pinball(error, said + log(2), WITHIN_TWO)
    return badness.where(valid, 0.0).sum((-2, -1)) / count


@dataclass(frozen=True)
class SpreadQuantiles:
    """Whether the predicted spread is as large as the errors."""

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of each image in the batch."""
        if prediction.spread is None:
            raise ValueError(
                "SpreadQuantiles needs a network that predicts a spread, but this one has no such "
                "head"
            )
        truth, valid = true_depth(prediction, sample, "SpreadQuantiles")
        return spread_quantiles(prediction.depth, prediction.spread, truth, valid)
