"""What the channels of a network's last map mean."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import log
from types import MappingProxyType
from typing import Literal

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import interpolate

from flexdepth.geometry.depth import NYU_BINS, DepthBins
from flexdepth.networks.adaptive import AdaptiveBins
from flexdepth.networks.blocks import start_as_xavier
from flexdepth.networks.guidance import PlanarGuidance
from flexdepth.sample import Prediction


@dataclass(frozen=True)
class LogDepth:
    """Depth as the exponential of the first channel, the log odds of sky as the second.

    Attributes:
        typical: The depth, in metres, that a channel of zeros means.
        nearest: No depth below this is given, in metres.
        farthest: No depth above this is given, in metres.
    """

    typical: float = 3.0
    nearest: float = 0.05
    farthest: float = 1000.0

    def build(self, inputs: int) -> "LogDepthHead":
        """Return the head on features of `inputs` channels."""
        return LogDepthHead(self, inputs)


class LogDepthHead(nn.Module):
    """The module of `LogDepth`: from features at half the image's size."""

    def __init__(self, settings: LogDepth, inputs: int) -> None:
        super().__init__()
        self.settings = settings
        self.conv = nn.Conv2d(inputs, 2, 3, padding=1, padding_mode="replicate")
        # Small weights: the first depth maps are nearly flat, well inside the range.
        nn.init.xavier_normal_(self.conv.weight, gain=0.1)
        nn.init.zeros_(self.conv.bias)  # type: ignore[arg-type]

    def forward(
        self, features: Float[Tensor, "batch channels height width"]
    ) -> tuple[
        Float[Tensor, "batch full_height full_width"], Float[Tensor, "batch full_height full_width"]
    ]:
        """Return depth and the sky's logit, at twice the size of the features."""
        maps = interpolate(
            self.conv(features), scale_factor=2.0, mode="bilinear", align_corners=False
        )
        log_depth, sky_logit = maps.unbind(1)
        near, far = log(self.settings.nearest), log(self.settings.farthest)
        return (log_depth + log(self.settings.typical)).clamp(near, far).exp(), sky_logit

    def stretch(self, factor: float) -> None:
        """Multiply every depth by a factor above 0, within the nearest and the farthest."""
        with torch.no_grad():
            self.conv.get_parameter("bias")[0].add_(log(factor))


@dataclass(frozen=True)
class BinnedDepth:
    """A score for each of many bins of depth; the depth is their mean in the logarithm.

    Attributes:
        bins: What is told apart.
    """

    bins: DepthBins = NYU_BINS

    def build(self, inputs: int) -> "BinnedDepthHead":
        """Return the head on features of `inputs` channels."""
        return BinnedDepthHead(self, inputs)


class BinnedDepthHead(nn.Module):
    """The module of `BinnedDepth`: from features at the image's size."""

    def __init__(self, settings: BinnedDepth, inputs: int) -> None:
        super().__init__()
        self.bins = settings.bins
        self.conv = nn.Conv2d(inputs, self.bins.count, 3, padding=2, dilation=2)
        start_as_xavier(self)

    def forward(
        self, features: Float[Tensor, "batch channels height width"]
    ) -> tuple[Float[Tensor, "batch height width"], Float[Tensor, "batch bins height width"]]:
        """Return depth in units of the bins, and the logits of the bins."""
        logits = self.conv(features)
        return self.bins.depth(logits), logits

    def predicted(self, features: Float[Tensor, "batch channels height width"]) -> Prediction:
        """Return depth, the logits and what their bins are."""
        depth, logits = self(features)
        return Prediction(depth, None, logits=logits, bins=self.bins)


def _counted(beyond: Float[Tensor, "batch bins height width"]) -> Float[Tensor, "batch _ _"]:
    return (beyond >= 0).sum(1).to(beyond.dtype)


def _expected(beyond: Float[Tensor, "batch bins height width"]) -> Float[Tensor, "batch _ _"]:
    return beyond.sigmoid().sum(1)


LABELS: Mapping[str, Callable[[Tensor], Tensor]] = MappingProxyType(
    {"counted": _counted, "expected": _expected}
)
"""From the log odds of lying beyond each bin to the bin: how many are likelier than not passed, as
published, without a gradient; or the sum of the probabilities, between two bins as a rule."""


@dataclass(frozen=True)
class OrdinalDepth:
    """Ordinal regression: for each bin, whether the depth lies beyond it.

    The bins, equally wide in the logarithm, are the space-increasing discretisation
    `tᵢ = exp(log α + i log(β / α) / K)` with α the nearest and β the farthest depth.

    Attributes:
        bins: What is told apart.
        label: How depth is decoded, of `LABELS`: `counted`, as published, has no gradient, so that
            only a loss of the log odds, `Ordinal`, can teach it; `expected` has one.

    References:
        Fu, Gong, Wang, Batmanghelich and Tao, CVPR 2018, section 3: tᵢ; d = (t_l + t_{l+1}) / 2
        with l = Σ [Pᵏ ≥ 0.5]. There Pᵏ is the softmax of two channels for each bin, here the
        sigmoid of one, which is the difference of the two; and a shift makes α one, which here is
        a choice of the range of the bins.
    """

    bins: DepthBins = NYU_BINS
    label: Literal["counted", "expected"] = "counted"

    def build(self, inputs: int) -> "OrdinalDepthHead":
        """Return the head on features of `inputs` channels."""
        return OrdinalDepthHead(self, inputs)


class OrdinalDepthHead(nn.Module):
    """The module of `OrdinalDepth`: from features at the image's size."""

    def __init__(self, settings: OrdinalDepth, inputs: int) -> None:
        super().__init__()
        self.bins, self.label = settings.bins, LABELS[settings.label]
        self.conv = nn.Conv2d(inputs, self.bins.count, 3, padding=2, dilation=2)
        start_as_xavier(self)

    def forward(
        self, features: Float[Tensor, "batch channels height width"]
    ) -> tuple[Float[Tensor, "batch height width"], Float[Tensor, "batch bins height width"]]:
        """Return depth in units of the bins, and the log odds of lying beyond each bin."""
        beyond = self.conv(features)
        return midway(
            self.label(beyond.to(torch.promote_types(beyond.dtype, torch.float32))), self.bins
        ), beyond

    def predicted(self, features: Float[Tensor, "batch channels height width"]) -> Prediction:
        """Return depth, the log odds and what their bins are."""
        depth, beyond = self(features)
        return Prediction(depth, None, bins=self.bins, beyond=beyond)


def midway(label: Float[Tensor, "*shape"], bins: DepthBins) -> Float[Tensor, "*shape"]:
    """Return the mean of the ends of a bin, `(t_l + t_{l+1}) / 2`, in units.

    Args:
        label: The number l of the bin, or a place between two; what is beyond the last bin is in
            it.
        bins: Equally wide in the logarithm.
    """
    ratio = 10**bins.width
    steps = label.clamp(max=bins.count - 1)
    return bins.nearest * torch.pow(ratio, steps) * ((1 + ratio) / 2)


DepthHead = BinnedDepth | OrdinalDepth | AdaptiveBins | PlanarGuidance
"""What makes depth of features at the image's size; its module has `predicted`."""
