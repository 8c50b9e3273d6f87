"""The weighted cross-entropy of depth bins: a near miss costs less than a far one."""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor
from torch.nn.functional import cross_entropy

from flexdepth.sample import Prediction, Sample, true_depth


def information_gain(count: int, falloff: float, like: Tensor) -> Float[Tensor, "bins bins"]:
    """Return exp(−α (i − j)²) with each row divided by its sum: what is wanted in bin i.

    Args:
        count: Of bins.
        falloff: α.
        like: Gives dtype and device.

    References:
        Cao, Wu and Shen, TCSVT 2018, whose rows are not divided; the base model's code does it.
    """
    places = torch.arange(count, dtype=like.dtype, device=like.device)
    weights = (-falloff * (places[:, None] - places).square()).exp()
    return weights / weights.sum(1, keepdim=True)


def weighted_cross_entropy(
    logits: Float[Tensor, "b bins h w"],
    labels: Int[Tensor, "b h w"],
    valid: Bool[Tensor, "b h w"],
    falloff: float,
) -> Float[Tensor, ""]:
    """Return the mean over the valid pixels of the batch of `−Σⱼ Wᵢⱼ log pⱼ`, with i the label.

    W is `information_gain`. Its rows sum to one, so the loss of uniform logits is the logarithm of
    the number of bins, and nothing is below the entropy of a row: 1.877084 at α = 0.2, 1.308190
    in the first and the last bin. A batch with no valid pixel has loss zero.

    Args:
        logits: Of the bins.
        labels: The true bin; anything in range where not valid.
        valid: The pixels that count.
        falloff: α.
    """
    logits = logits.where(valid[:, None], 0.0)
    wanted = information_gain(logits.shape[1], falloff, logits)[labels].movedim(-1, 1)
    surprise = cross_entropy(logits, wanted, reduction="none").where(valid, 0.0)
    return surprise.sum() / valid.sum().clamp(min=1)


@dataclass(frozen=True)
class WeightedCrossEntropy:
    """Weighted cross-entropy against measured depth; each image is given the mean of the batch.

    Attributes:
        falloff: α of `information_gain`.
    """

    falloff: float = 0.2

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of the batch, for each image."""
        truth, valid = true_depth(prediction, sample, "WeightedCrossEntropy")
        if prediction.logits is None or prediction.bins is None:
            raise ValueError("WeightedCrossEntropy needs a network that classifies depth into bins")
        labels, _ = prediction.bins.labels(truth)
        loss = weighted_cross_entropy(prediction.logits, labels, valid, self.falloff)
        return loss.expand(len(labels))
