"""What the channels of a network's last map mean."""

from dataclasses import dataclass
from math import log

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import interpolate

from flexdepth.geometry.depth import NYU_BINS, DepthBins
from flexdepth.networks.blocks import start_as_xavier


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
