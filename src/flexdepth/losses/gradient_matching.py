"""The multi-scale gradient loss: depth edges where they are, and surfaces smooth between them."""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.sample import Prediction, Sample, true_depth


def gradient_matching(
    depth: Float[Tensor, "b h w"],
    truth: Float[Tensor, "b h w"],
    valid: Bool[Tensor, "b h w"],
    scales: int,
) -> Float[Tensor, " b"]:
    """Return `Σₛ mean|∂x R| + mean|∂y R|` per image, with `R = log depth − log truth`.

    Scale s sees every 2ˢ-th pixel of every 2ˢ-th row. A difference counts where both its pixels
    are valid; each mean is over those. The loss is blind to the scale of `depth`; an image
    without a valid pair has loss zero.

    Args:
        depth: Positive wherever valid.
        truth: Positive wherever valid.
        valid: The pixels that count.
        scales: How many.

    References:
        Li and Snavely, MegaDepth, CVPR 2018, eq. 5, and Ranftl et al., PAMI 2022, eq. 11, who
        divide by the number of valid pixels instead of pairs.
    """
    error = depth.where(valid, 1.0).log() - truth.where(valid, 1.0).log()
    total = error.new_zeros(error.shape[0])
    for scale in range(scales):
        step = 2**scale
        fine, known = error[:, ::step, ::step], valid[:, ::step, ::step]
        for axis in (-1, -2):
            total = total + _mean_slope(fine, known, axis)
    return total


def _mean_slope(
    error: Float[Tensor, "b h w"], valid: Bool[Tensor, "b h w"], axis: int
) -> Float[Tensor, " b"]:
    length = error.shape[axis]
    pairs = valid.narrow(axis, 0, length - 1) & valid.narrow(axis, 1, length - 1)
    slope = torch.diff(error, dim=axis).where(pairs, 0.0).abs()
    return slope.sum((-2, -1)) / pairs.sum((-2, -1)).clamp(min=1)


@dataclass(frozen=True)
class GradientMatching:
    """Multi-scale gradient loss against measured depth.

    Attributes:
        scales: At strides 1, 2, 4, ...
    """

    scales: int = 4

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of each image in the batch."""
        truth, valid = true_depth(prediction, sample, "GradientMatching")
        return gradient_matching(prediction.depth, truth, valid, self.scales)
