"""The loss of the sky's logit."""

from dataclasses import dataclass

from jaxtyping import Bool, Float
from torch import Tensor
from torch.nn.functional import softplus

from flexdepth.sample import Prediction, Sample, measured


def sky_cross_entropy(
    logit: Float[Tensor, "b h w"],
    sky: Bool[Tensor, "b h w"],
    valid: Bool[Tensor, "b h w"],
) -> Float[Tensor, " b"]:
    """Return the mean of `−log p` per image, with p the probability given to what is there.

    The mean is over the pixels that are known: sky, or valid and so not sky. An image with no
    known pixel has loss zero.

    Args:
        logit: Log odds of sky.
        sky: Where there is sky.
        valid: Where there is depth.
    """
    known = sky | valid
    logit = logit.where(known, 0.0)
    surprise = softplus(logit.where(~sky, -logit)).where(known, 0.0)
    return surprise.sum((-2, -1)) / known.sum((-2, -1)).clamp(min=1)


@dataclass(frozen=True)
class Sky:
    """Cross-entropy of sky against everything else that is known."""

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of each image in the batch."""
        truth = measured(sample, "Sky")
        if prediction.sky_logit is None:
            raise ValueError("Sky needs a network that predicts sky, but this one has no such head")
        return sky_cross_entropy(prediction.sky_logit, truth.sky, truth.valid)
