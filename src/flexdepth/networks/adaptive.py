"""Bins of depth that differ from image to image."""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn

from flexdepth.networks.blocks import resized, start_as_xavier
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction

_LEAST = 1e-3
"""Added to the width of each bin before they are divided by their sum, as published."""
_PLACES = 16
"""Rows and columns of the learnt map of where a patch is."""
_HIDDEN, _FEEDFORWARD = 256, 1024


def bin_centres(
    shares: Float[Tensor, "batch bins"], nearest: float, farthest: float
) -> Float[Tensor, "batch bins"]:
    """Return `cᵢ = n + (f − n) (bᵢ / 2 + Σ_{j<i} bⱼ)`: the middle of each bin.

    Args:
        shares: bᵢ, the part of the range that each bin takes; they sum to one.
        nearest: n, where the first begins.
        farthest: f, where the last ends.

    References:
        Bhat, Alhashim and Wonka, CVPR 2021, section 3.3.
    """
    return nearest + (farthest - nearest) * (shares.cumsum(1) - shares / 2)


@dataclass(frozen=True)
class AdaptiveBins:
    """Depth as a mean over bins whose widths a small transformer chooses for each image.

    The transformer sees patches of the features. One of its outputs becomes the widths of the
    bins; the others are compared with the features at every pixel, which gives the probability of
    each bin there. Depth is `Σ cₖ pₖ`, in metres, with c the centres of the bins.

    Attributes:
        count: Of bins.
        nearest: Where the first begins, in metres.
        farthest: Where the last ends, in metres.
        patch: Side of a patch, in pixels.
        width: Channels of the transformer, and how many of its outputs are compared.
        layers: Of the transformer.
        heads: Of its attention.

    Raises:
        InputError: 0 <= `nearest` < `farthest` does not hold, or the heads do not divide the
            width.

    References:
        Bhat, Alhashim and Wonka, CVPR 2021, section 3.3. There the first outputs of
        the patches are the widths and the kernels, which asks for images of so many patches; here
        they are inputs of their own, which are learnt. Places are learnt on a grid and resized.
    """

    count: int = 256
    nearest: float = 1e-3
    farthest: float = 10.0
    patch: int = 16
    width: int = 128
    layers: int = 4
    heads: int = 4

    def __post_init__(self) -> None:
        if not 0 <= self.nearest < self.farthest or self.width % self.heads:
            raise InputError(
                f"adaptive bins need 0 <= nearest < farthest and a width that their heads divide, "
                f"got {self}"
            )

    def build(self, inputs: int) -> "AdaptiveBinsHead":
        """Return the head on features of `inputs` channels."""
        return AdaptiveBinsHead(self, inputs)


class AdaptiveBinsHead(nn.Module):
    """The module of `AdaptiveBins`: from features at the image's size."""

    def __init__(self, settings: AdaptiveBins, inputs: int) -> None:
        super().__init__()
        self.settings = settings
        width, patch = settings.width, settings.patch
        self.patches = nn.Conv2d(inputs, width, patch, patch, patch // 2)
        self.pixels = nn.Conv2d(inputs, width, 3, padding=1)
        self.places = nn.Parameter(0.02 * torch.randn(1, width, _PLACES, _PLACES))
        self.asked = nn.Parameter(0.02 * torch.randn(1, 1 + width, width))
        layer = nn.TransformerEncoderLayer(
            width, settings.heads, _FEEDFORWARD, dropout=0.0, batch_first=True
        )
        self.transformer = nn.TransformerEncoder(layer, settings.layers, enable_nested_tensor=False)
        self.widths = nn.Sequential(
            *(nn.Linear(width, _HIDDEN), nn.LeakyReLU()),
            *(nn.Linear(_HIDDEN, _HIDDEN), nn.LeakyReLU()),
            nn.Linear(_HIDDEN, settings.count),
        )
        self.scores = nn.Conv2d(width, settings.count, 1)
        for part in (self.patches, self.pixels, self.scores):
            start_as_xavier(part)

    def forward(
        self, features: Float[Tensor, "batch channels height width"]
    ) -> tuple[Float[Tensor, "batch height width"], Float[Tensor, "batch bins"]]:
        """Return depth in metres, and the centres of the bins of each image."""
        patches = self.patches(features)
        placed = patches + resized(self.places, *patches.shape[-2:])
        asked = self.asked.expand(len(features), -1, -1)
        answers = self.transformer(torch.cat([asked, placed.flatten(2).mT], 1))
        widths = self.widths(answers[:, 0]).relu() + _LEAST
        shares = widths / widths.sum(1, keepdim=True)
        centres = bin_centres(shares, self.settings.nearest, self.settings.farthest)
        kernels = answers[:, 1 : asked.shape[1]]
        alike = torch.einsum("bkc,bchw->bkhw", kernels, self.pixels(features))
        probability = self.scores(alike).softmax(1)
        return torch.einsum("bk,bkhw->bhw", centres, probability), centres

    def predicted(self, features: Float[Tensor, "batch channels height width"]) -> Prediction:
        """Return depth and the centres of the bins."""
        depth, centres = self(features)
        return Prediction(depth, None, centres=centres)
