"""The scale-invariant log loss."""

from dataclasses import dataclass

from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.sample import Prediction, Sample, true_depth


def silog(
    depth: Float[Tensor, "b h w"],
    truth: Float[Tensor, "b h w"],
    valid: Bool[Tensor, "b h w"],
    variance_focus: float,
) -> Float[Tensor, " b"]:
    """Return `mean(e²) − λ mean(e)²` per image, with `e = log depth − log truth`.

    At λ = 1 the loss is blind to the scale of `depth`; at λ = 0 it is the mean squared log
    error. An image with no valid pixel has loss zero.

    Args:
        depth: Positive wherever valid.
        truth: Positive wherever valid, in the unit of `depth`.
        valid: The pixels that count.
        variance_focus: λ, between 0 and 1.

    References:
        Eigen, Puhrsch and Fergus, NeurIPS 2014, eq. 4 (λ = 0.5).
    """
    count = valid.sum((-2, -1)).clamp(min=1)
    depth, truth = depth.where(valid, 1.0), truth.where(valid, 1.0)
    error = depth.log() - truth.log()
    mean_square = error.square().sum((-2, -1)) / count
    return mean_square - variance_focus * (error.sum((-2, -1)) / count).square()


@dataclass(frozen=True)
class Silog:
    """Scale-invariant log loss against measured depth.

    Attributes:
        variance_focus: λ of `silog`.
    """

    variance_focus: float = 0.85

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of each image in the batch."""
        truth, valid = true_depth(prediction, sample, "Silog")
        return silog(prediction.depth, truth, valid, self.variance_focus)
