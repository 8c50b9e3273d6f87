"""What a network says of its own answer: how far off depth may be, and which lens it saw."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import avg_pool2d, interpolate

from flexdepth.networks.blocks import start_as_xavier


@dataclass(frozen=True)
class Spread:
    """The relative standard deviation of depth, by a second look at the features that gave it.

    How far off a pixel may be hangs on what stands in the picture more than on the pixel: the look
    is at the coarse features, at an eighth of the image's size. It does not teach: no gradient
    of it reaches the features, so that a network with and one without it give the same depth.

    Attributes:
        width: Channels between the features and the spread.
        typical: The spread that a channel of zeros means.
        least: No spread below this is given.
        most: No spread above this is given.
    """

    width: int = 64
    typical: float = 0.1
    least: float = 0.003
    most: float = 3.0

    def build(self, widths: tuple[int, int, int, int]) -> "SpreadHead":
        """Return the head on features of so many channels at strides 32, 16, 8 and 4."""
        return SpreadHead(self, widths)


class SpreadHead(nn.Module):
    """The module of `Spread`: from features at strides 32, 16, 8 and 4."""

    def __init__(self, settings: Spread, widths: tuple[int, int, int, int]) -> None:
        super().__init__()
        self.settings = settings
        width = settings.width
        self.looks = nn.ModuleList(nn.Conv2d(inputs, width, 1) for inputs in widths)
        self.blocks = nn.Sequential(nn.ReLU(), _around(width), nn.ReLU(), _around(width), nn.ReLU())
        self.say = nn.Conv2d(width, 1, 1)
        start_as_xavier(self)

    def forward(
        self, features: Sequence[Float[Tensor, "batch _ _ _"]]
    ) -> Float[Tensor, "batch height width"]:
        """Return the spread at the image's size.

        Args:
            features: At strides 32, 16, 8 and 4.
        """
        coarsest, coarse, middle, fine = (each.detach() for each in features)
        seen = (
            _grown(self.looks[0](coarsest), 4.0)
            + _grown(self.looks[1](coarse), 2.0)
            + self.looks[2](middle)
            + self.looks[3](avg_pool2d(fine, 2))
        )
        logarithm = _grown(self.say(self.blocks(seen)), 8.0)
        least, most = log(self.settings.least), log(self.settings.most)
        return (logarithm.squeeze(1) + log(self.settings.typical)).clamp(least, most).exp()

    def widen(self, factor: float) -> None:
        """Multiply every spread by a factor above 0, within the least and the most."""
        with torch.no_grad():
            self.say.get_parameter("bias").add_(log(factor))


def _around(width: int) -> nn.Conv2d:
    return nn.Conv2d(width, width, 3, padding=1, padding_mode="replicate")


def _grown(maps: Tensor, factor: float) -> Tensor:
    return interpolate(maps, scale_factor=factor, mode="bilinear", align_corners=False)


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
