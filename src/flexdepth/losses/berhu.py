"""The reverse Huber loss, berHu: linear near zero, quadratic far from it."""

from dataclasses import dataclass

from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.sample import Prediction, Sample, true_depth


def berhu(error: Float[Tensor, "*shape"], threshold: Float[Tensor, ""]) -> Float[Tensor, "*shape"]:
    """Return |x| up to the threshold c, and `(x² + c²) / (2c)` beyond it.

    Both have value c and slope one where they meet. At a threshold of zero it is |x|.

    Args:
        error: x.
        threshold: c.

    References:
        Laina, Rupprecht, Belagiannis, Tombari and Navab, 3DV 2016, the section on the loss.
    """
    size = error.abs()
    beyond = (size > threshold) & (threshold > 0)
    c = threshold.where(threshold > 0, 1.0)
    return ((error.square() + c.square()) / (2 * c)).where(beyond, size)


def threshold(error: Float[Tensor, "*shape"], share: float) -> Float[Tensor, ""]:
    """Return `share` of the largest |error|, as a number that gradients do not see."""
    return share * error.detach().abs().max()


def mean_berhu(
    depth: Float[Tensor, "b h w"],
    truth: Float[Tensor, "b h w"],
    valid: Bool[Tensor, "b h w"],
    share: float,
) -> Float[Tensor, ""]:
    """Return the mean of `berhu` over the valid pixels of the batch; zero if it has none.

    The threshold is a share of the largest error in the batch, so that the loss grows as the
    errors do.

    Args:
        depth: Anything where not valid.
        truth: In the unit of `depth`.
        valid: The pixels that count.
        share: One fifth as published.
    """
    error = (depth - truth).where(valid, 0.0)
    return berhu(error, threshold(error, share)).sum() / valid.sum().clamp(min=1)


@dataclass(frozen=True)
class BerHu:
    """Reverse Huber loss against measured depth; each image is given the mean of the batch.

    Attributes:
        share: Of the largest error in the batch, up to which errors count as they are and beyond
            which by their square.
    """

    share: float = 0.2

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of the batch, for each image."""
        truth, valid = true_depth(prediction, sample, "BerHu")
        return mean_berhu(prediction.depth, truth, valid, self.share).expand(len(truth))
