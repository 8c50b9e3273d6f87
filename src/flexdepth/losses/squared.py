"""The squared error of depth."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.sample import Prediction, Sample, in_metres, true_depth


def mean_square(
    depth: Float[Tensor, "b h w"], truth: Float[Tensor, "b h w"], valid: Bool[Tensor, "b h w"]
) -> Float[Tensor, " b"]:
    """Return `mean (depth − truth)²` per image, over its valid pixels; zero if it has none."""
    error = (depth - truth).where(valid, 0.0)
    return error.square().sum((-2, -1)) / valid.sum((-2, -1)).clamp(min=1)


def root_mean_square(
    depth: Float[Tensor, "b h w"], truth: Float[Tensor, "b h w"], valid: Bool[Tensor, "b h w"]
) -> Float[Tensor, " b"]:
    """Return the root of `mean_square`; where that is zero, so is the gradient."""
    square = mean_square(depth, truth, valid)
    wrong = square > 0
    return square.where(wrong, 1.0).sqrt().where(wrong, 0.0)


def _as_predicted(
    depth: Float[Tensor, "b h w"], _prediction: Prediction, _sample: Sample
) -> Float[Tensor, "b h w"]:
    return depth


MEANS: Mapping[str, Callable[[Tensor, Tensor, Tensor], Tensor]] = MappingProxyType(
    {"square": mean_square, "root": root_mean_square}
)
UNITS: Mapping[str, Callable[[Tensor, Prediction, Sample], Tensor]] = MappingProxyType(
    {"scaled": _as_predicted, "metres": in_metres}
)


@dataclass(frozen=True)
class Squared:
    """Squared error against measured depth: the ℓ₂ term of chapter 3.

    The dissertation says neither which mean nor which unit; its large weight, 25, points to a
    small term, so the mean square in the network's own unit is taken.

    Attributes:
        mean: `square` or `root`: the mean square, or its root.
        unit: `scaled` or `metres`: that of the prediction, or the metre.
    """

    mean: Literal["square", "root"] = "square"
    unit: Literal["scaled", "metres"] = "scaled"

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of each image in the batch."""
        truth, valid = true_depth(prediction, sample, "Squared")
        unit = UNITS[self.unit]
        depth, truth = (unit(x, prediction, sample) for x in (prediction.depth, truth))
        return MEANS[self.mean](depth, truth, valid)
