"""What the channels of a network's last map mean."""

from dataclasses import dataclass
from math import log

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import interpolate


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
        self.conv = nn.Conv2d(inputs, 2, 3, padding=1)
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
