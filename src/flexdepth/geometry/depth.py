"""Depth in metres, depth for a canonical focal length, and depth as one of many bins.

Seen through twice the focal length, a thing looks half as far away. A network that is not told
the focal length gives the depth that the image would have for one canonical focal length.

A network that classifies depth gives, for each pixel, a probability of each bin. Bins are in a
unit of their own, 10 m indoors and 80 m on roads, so that the thresholds of losses suit both.
"""

from dataclasses import dataclass
from math import log10

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class DepthBins:
    """Bins of equal width in log10 depth.

    Attributes:
        count: How many.
        nearest: Where the first begins, in units.
        farthest: Where the last ends, in units.
        unit: Metres in one unit of depth.

    Raises:
        InputError: There is no bin, or 0 < `nearest` < `farthest` does not hold, or the unit is
            not positive.

    References:
        Yin et al., ICCV 2019, section 3.3. There a depth of zero, which means a missing
        measurement, is put into the first bin; here it is no depth.
    """

    count: int = 150
    nearest: float = 0.01
    farthest: float = 1.7
    unit: float = 10.0

    def __post_init__(self) -> None:
        if not (self.count >= 1 and 0 < self.nearest < self.farthest and self.unit > 0):
            raise InputError(
                f"depth bins need count >= 1, 0 < nearest < farthest and unit > 0, got {self}"
            )

    @property
    def width(self) -> float:
        """The width of a bin in log10 depth."""
        return log10(self.farthest / self.nearest) / self.count

    def centres(self, like: Tensor) -> Float[Tensor, " bins"]:
        """Return the middle of each bin in log10 depth, with the dtype and device of `like`."""
        places = torch.arange(self.count, dtype=like.dtype, device=like.device) + 0.5
        return log10(self.nearest) + places * self.width

    def clipped(self, depth: Float[Tensor, "*shape"]) -> Float[Tensor, "*shape"]:
        """Return the depth, in units, brought into the range of the bins."""
        return depth.clamp(self.nearest, self.farthest)

    def labels(
        self, depth: Float[Tensor, "*shape"]
    ) -> tuple[Int[Tensor, "*shape"], Bool[Tensor, "*shape"]]:
        """Return the bin of each depth, and where there is a depth at all.

        What is nearer than the first bin or farther than the last is in the first or the last.
        Zero, negative, infinite and undefined depth is none; its bin is 0 and means nothing.

        Args:
            depth: In units.
        """
        valid = (depth > 0) & depth.isfinite()
        above = self.clipped(depth.where(valid, self.nearest)).log10() - log10(self.nearest)
        return (above / self.width).long().clamp(0, self.count - 1), valid

    def depth(
        self, logits: Float[Tensor, "*batch bins height width"]
    ) -> Float[Tensor, "*batch height width"]:
        """Return 10 to the power of `Σ pᵢ cᵢ`, in units, with p the softmax of the logits.

        It lies between the centres c of the first and the last bin. Logits of half precision
        give depth of single precision: in eight bits of mantissa the sum would lose the bins.
        """
        exact = torch.promote_types(logits.dtype, torch.float32)
        probability = logits.softmax(-3, dtype=exact)
        mean = (probability * self.centres(probability)[:, None, None]).sum(-3)
        return torch.pow(10.0, mean)


NYU_BINS = DepthBins(150, 0.01, 1.7, unit=10.0)
"""0.1 m to 17 m: NYU's 10 m, and what an image shrunk to .6 makes of them."""

KITTI_BINS = DepthBins(100, 0.015, 1.0, unit=80.0)
"""1.2 m to 80 m."""


def canonical_from_metres(
    depth: Float[Tensor, "*batch height width"],
    focal: Float[Tensor, "*batch"],
    canonical_focal: float,
) -> Float[Tensor, "*batch height width"]:
    """Return `depth * canonical_focal / focal`.

    Args:
        depth: In metres.
        focal: Focal length of the camera that took the image (`Camera.focal_by_area`).
        canonical_focal: Of the camera that the result is meant for, likewise.

    References:
        Yin et al., Metric3D, ICCV 2023, section 3.2, there in pixels; divided by the image's size,
        so that resizing it does not matter.
    """
    return depth * (canonical_focal / focal)[..., None, None]


def metres_from_canonical(
    depth: Float[Tensor, "*batch height width"],
    focal: Float[Tensor, "*batch"],
    canonical_focal: float,
) -> Float[Tensor, "*batch height width"]:
    """Return `depth * focal / canonical_focal`: metres, from canonical depth.

    Args:
        depth: For a camera of `canonical_focal`.
        focal: Of the camera that took the image.
        canonical_focal: As in `canonical_from_metres`, whose inverse this is.
    """
    return depth * (focal / canonical_focal)[..., None, None]
