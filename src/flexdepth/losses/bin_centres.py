"""How far the bins that a network chose for an image are from the depth that is in it."""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from flexdepth.sample import Prediction, Sample, true_depth


def chamfer(
    centres: Float[Tensor, "b bins"],
    truth: Float[Tensor, "b h w"],
    valid: Bool[Tensor, "b h w"],
) -> Float[Tensor, " b"]:
    """Return the two-way Chamfer distance of centres c and depths x, per image.

    It is `mean over x of min over c of (x − c)² + mean over c of min over x of (x − c)²`: every
    depth has a bin nearby, and every bin a depth. An image with no valid pixel has loss zero.

    Args:
        centres: Of the bins.
        truth: In the unit of the centres, and finite; anything where not valid.
        valid: The pixels that count.

    References:
        Bhat, Alhashim and Wonka, CVPR 2021, section 3.4, the loss of bin centres.
    """
    count = valid.flatten(1).sum(1)
    some = count > 0
    depths = truth.where(valid, torch.inf).flatten(1).sort(1).values
    known = depths.isfinite()
    ordered = centres.sort(1).values
    every = torch.full_like(count, centres.shape[1])
    there = depths.where(known, 0.0)
    to_bins = (there - nearest(there, ordered, every)).where(known, 0.0).square().sum(1)
    found = nearest(ordered.detach(), depths, count.clamp(min=1)).where(some[:, None], 0.0)
    to_depths = (ordered - found).square().mean(1)
    return (to_bins / count.clamp(min=1) + to_depths).where(some, 0.0)


def nearest(
    wanted: Float[Tensor, "b wanted"],
    ordered: Float[Tensor, "b found"],
    count: Int[Tensor, " b"],
) -> Float[Tensor, "b wanted"]:
    """Return for each number the nearest one among the first `count` of an ordered row.

    Args:
        wanted: Numbers in any order.
        ordered: Numbers in ascending order.
        count: How many of them count, at least one in each row.
    """
    after = torch.searchsorted(ordered.detach().contiguous(), wanted.detach().contiguous())
    last = count[:, None] - 1
    above = ordered.gather(1, after.clamp(min=0).minimum(last))
    below = ordered.gather(1, (after - 1).clamp(min=0).minimum(last))
    return below.where((wanted - below).abs() <= (above - wanted).abs(), above)


@dataclass(frozen=True)
class BinCentres:
    """Chamfer distance between the centres of adaptive bins and measured depth."""

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of each image in the batch."""
        truth, valid = true_depth(prediction, sample, "BinCentres")
        if prediction.centres is None:
            raise ValueError("BinCentres needs a network that chooses its bins for each image")
        return chamfer(prediction.centres, truth, valid)
