"""The loss of ordinal regression: for each bin, whether the depth lies beyond it."""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor
from torch.nn.functional import softplus

from flexdepth.sample import Prediction, Sample, true_depth


def ordinal(
    beyond: Float[Tensor, "b bins h w"],
    labels: Int[Tensor, "b h w"],
    valid: Bool[Tensor, "b h w"],
) -> Float[Tensor, " b"]:
    """Return the mean over valid pixels of `−Σ_{k<l} log Pₖ − Σ_{k≥l} log(1 − Pₖ)`, per image.

    Pₖ is the probability that the depth lies beyond bin k, and l the true bin. A prediction that
    is wrong by several bins pays for each of them. An image with no valid pixel has loss zero.

    Args:
        beyond: Log odds of Pₖ.
        labels: The true bin; anything where not valid.
        valid: The pixels that count.

    References:
        Fu, Gong, Wang, Batmanghelich and Tao, CVPR 2018, section 3.3.
    """
    places = torch.arange(beyond.shape[1], device=beyond.device)[:, None, None]
    passed = places < labels[:, None]
    odds = beyond.where(valid[:, None], 0.0)
    surprise = softplus(odds.where(~passed, -odds)).sum(1).where(valid, 0.0)
    return surprise.sum((-2, -1)) / valid.sum((-2, -1)).clamp(min=1)


@dataclass(frozen=True)
class Ordinal:
    """Ordinal regression against measured depth."""

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of each image in the batch."""
        truth, valid = true_depth(prediction, sample, "Ordinal")
        if prediction.beyond is None or prediction.bins is None:
            raise ValueError("Ordinal needs a network that says whether depth lies beyond each bin")
        labels, _ = prediction.bins.labels(truth)
        return ordinal(prediction.beyond, labels, valid)
