"""What a network says of its own answer: how far off depth may be, and which lens it saw."""

from dataclasses import dataclass
from math import log

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import interpolate

from flexdepth.networks.blocks import start_as_xavier


@dataclass(frozen=True)
class Spread:
    """The relative standard deviation of depth, by a second look at the features that gave it.

    The look does not teach: no gradient of it reaches the features, so that a network with and one
    without it give the same depth.

    Attributes:
        width: Channels between the features and the spread.
        typical: The spread that a channel of zeros means.
        least: No spread below this is given.
        most: No spread above this is given.
    """

    width: int = 16
    typical: float = 0.1
    least: float = 0.003
    most: float = 3.0

    def build(self, inputs: int) -> "SpreadHead":
        """Return the head on features of `inputs` channels."""
        return SpreadHead(self, inputs)


class SpreadHead(nn.Module):
    """The module of `Spread`: from features at half the image's size."""

    def __init__(self, settings: Spread, inputs: int) -> None:
        super().__init__()
        self.settings = settings
        self.look = nn.Conv2d(inputs, settings.width, 3, padding=1, padding_mode="replicate")
        self.say = nn.Conv2d(settings.width, 1, 1)
        start_as_xavier(self)

    def forward(
        self, features: Float[Tensor, "batch channels height width"]
    ) -> Float[Tensor, "batch full_height full_width"]:
        """Return the spread at twice the size of the features."""
        said = self.say(self.look(features.detach()).relu())
        logarithm = interpolate(said, scale_factor=2.0, mode="bilinear", align_corners=False)
        least, most = log(self.settings.least), log(self.settings.most)
        return (logarithm.squeeze(1) + log(self.settings.typical)).clamp(least, most).exp()


@dataclass(frozen=True)
class FocalLength:
    """The focal length of the camera, as the whole picture tells it.

    Attributes:
        width: Channels between the features and the answer.
        typical: The focal length, in image diagonals, that a channel of zeros means.
    """

    width: int = 64
    typical: float = 0.7

    def build(self, inputs: int) -> "FocalHead":
        """Return the head on features of `inputs` channels."""
        return FocalHead(self, inputs)


class FocalHead(nn.Module):
    """The module of `FocalLength`: from the coarsest features."""

    def __init__(self, settings: FocalLength, inputs: int) -> None:
        super().__init__()
        self.typical = settings.typical
        self.hidden = nn.Linear(inputs, settings.width)
        self.say = nn.Linear(settings.width, 1)

    def forward(
        self, features: Float[Tensor, "batch channels height width"]
    ) -> Float[Tensor, " batch"]:
        """Return the focal length in image diagonals."""
        said = self.say(self.hidden(features.mean((-2, -1))).relu())
        logarithm: Tensor = said.squeeze(1) + log(self.typical)
        return logarithm.clamp(log(0.1), log(10.0)).exp()
