"""The loss of a predicted focal length."""

from dataclasses import dataclass

from jaxtyping import Float
from torch import Tensor

from flexdepth.sample import Prediction, Sample


@dataclass(frozen=True)
class Focal:
    """`|log f − log f*|` of each image, with f in image diagonals: the ratio, either way."""

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of each image in the batch."""
        if prediction.focal is None:
            raise ValueError(
                "Focal needs a network that predicts a focal length, but this one has no such head"
            )
        return (prediction.focal.log() - sample.key.focal_in_diagonals().log()).abs()
