"""How the features of the encoder and the decoder meet: attention to the encoder's features.

A merge gives `coefficient * lateral + decoder`. What the coefficient is made of is a value: one
settings class of the union `Coefficient`, whose module turns (lateral, decoder) into the weighted
lateral features and, where it has one, its map of spatial attention.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn

from flexdepth.runtime.errors import InputError

_EPS = 1e-8
"""Added to squared lengths, so that features of zero have similarity 0 and finite gradients."""


@dataclass(frozen=True)
class ChannelAttention:
    """A weight for each channel (CA), from what the whole image holds: the merge of AMB.

    Attributes:
        ratio: The inner width is the 2 x `width` channels seen, divided by this.
    """

    ratio: int = 16

    def build(self, width: int) -> "ChannelAttentionWeighting":
        """Return the module for features of `width` channels."""
        return ChannelAttentionWeighting(self, width)


@dataclass(frozen=True)
class SpatialPlusChannelAttention:
    """SA exp(SA) + CA: where encoder and decoder agree, and in which channels (S6 and S7 of AGA).

    SA is the similarity of the two feature vectors at a pixel, after one embedding that both
    share, so that their channels can be compared.

    Attributes:
        ratio: The embedding has the features' `width` divided by this.
        channel: The coefficient of the channels, CA.
    """

    ratio: int = 16
    channel: ChannelAttention = ChannelAttention()

    def build(self, width: int) -> "SpatialPlusChannelWeighting":
        """Return the module for features of `width` channels."""
        return SpatialPlusChannelWeighting(self, width)


Coefficient = ChannelAttention | SpatialPlusChannelAttention
"""What the encoder's features are multiplied by before the decoder's are added."""


class ChannelAttentionWeighting(nn.Module):
    """The module of `ChannelAttention`."""

    def __init__(self, settings: ChannelAttention, width: int) -> None:
        super().__init__()
        inner = _bottleneck(2 * width, settings.ratio)
        self.squeeze = nn.Conv2d(2 * width, inner, 1, bias=False)
        self.excite = nn.Conv2d(inner, width, 1, bias=False)

    def coefficient(
        self,
        lateral: Float[Tensor, "batch channels height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> Float[Tensor, "batch channels 1 1"]:
        """Return CA, between 0 and 1."""
        content = torch.cat([lateral, decoder], 1).mean((-2, -1), keepdim=True)
        weight: Tensor = self.excite(self.squeeze(content).relu()).sigmoid()
        return weight

    def forward(
        self,
        lateral: Float[Tensor, "batch channels height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[Float[Tensor, "batch channels height width"], None]:
        """Return `CA * lateral`; there is no spatial map."""
        return self.coefficient(lateral, decoder) * lateral, None


class SpatialPlusChannelWeighting(nn.Module):
    """The module of `SpatialPlusChannelAttention`."""

    def __init__(self, settings: SpatialPlusChannelAttention, width: int) -> None:
        super().__init__()
        self.embed = nn.Conv2d(width, _bottleneck(width, settings.ratio), 1, bias=False)
        self.channel = settings.channel.build(width)

    def forward(
        self,
        lateral: Float[Tensor, "batch channels height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[Float[Tensor, "batch channels height width"], Float[Tensor, "batch 1 height width"]]:
        """Return `(SA exp(SA) + CA) * lateral`, and SA."""
        attention = similarity(self.embed(lateral), self.embed(decoder))
        coefficient = emphasised(attention) + self.channel.coefficient(lateral, decoder)
        return coefficient * lateral, attention


class Merge(nn.Module):
    """Encoder features, weighted by a coefficient, plus decoder features."""

    def __init__(self, coefficient: Coefficient, width: int) -> None:
        super().__init__()
        self.weighting = coefficient.build(width)

    def forward(
        self,
        lateral: Float[Tensor, "batch channels height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[
        Float[Tensor, "batch channels height width"], Float[Tensor, "batch 1 height width"] | None
    ]:
        """Return the merged features, and the spatial attention where the coefficient has one."""
        weighted, attention = self.weighting(lateral, decoder)
        return weighted + decoder, attention


def similarity(
    first: Float[Tensor, "batch channels height width"],
    second: Float[Tensor, "batch channels height width"],
) -> Float[Tensor, "batch 1 height width"]:
    """Return `|a . b| / (|a| |b|)` at each pixel, between 0 and 1.

    Blind to the sign and the length of both; 0 where either is zero, with finite gradients.
    """
    lengths = [(x.square().sum(1, keepdim=True) + _EPS).rsqrt() for x in (first, second)]
    product = (first * second).sum(1, keepdim=True)
    return (product * lengths[0] * lengths[1]).abs()


def emphasised(attention: Float[Tensor, "*batch"]) -> Float[Tensor, "*batch"]:
    """Return `x exp(x)`: 0 at 0, e at 1, and steeper than x in between."""
    return attention * attention.exp()


def _bottleneck(channels: int, ratio: int) -> int:
    inner = channels // ratio
    if inner < 2:
        raise InputError(
            f"attention over {channels} channels needs at least 2 inside, but a ratio of {ratio} "
            f"leaves {inner}: lower the ratio or widen the decoder"
        )
    return inner
