"""How the features of the encoder and the decoder meet: attention to the encoder's features.

A merge gives `coefficient * lateral + decoder`. What the coefficient is made of is a value: one
settings class of the union `Coefficient`, whose module turns (lateral, decoder) into the weighted
lateral features and, where it has one, its map of spatial attention.

In the formulas SA is the similarity of the two feature vectors at a pixel in a common embedding,
between 0 and 1, and CA the weight of a channel, the same at every pixel. Every variant but
`ChannelAttention` is published as a case of `f₁(SA₁) + f₂(SA₂) CA` and named by its row in the
table of the ablation; two rows that differ only in the loss are one coefficient.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from jaxtyping import Float
from torch import Tensor, nn

from flexdepth.networks.attention import (
    ChannelAttention,
    Embedding,
    emphasised,
    similarity,
)
from flexdepth.networks.conventional import (
    DotProductPlusChannelAttention,
    NonLocalPlusChannelAttention,
)


@dataclass(frozen=True)
class SpatialAttention:
    """SA alone: where encoder and decoder agree (S3 of AGA).

    Attributes:
        ratio: The embedding has the features' width divided by this.
        embedding: One for both features, or one each.
    """

    ratio: int = 16
    embedding: Embedding = Embedding.SHARED

    def build(self, lateral: int, decoder: int) -> "SpatialWeighting":
        """Return the module for features of these numbers of channels."""
        return SpatialWeighting(self, lateral, decoder)


@dataclass(frozen=True)
class SpatialTimesChannelAttention:
    """SA CA: where they agree, in each channel as much as the image wants it (S2 and S4 of AGA).

    Attributes:
        ratio: The embedding has the features' width divided by this.
        channel: The coefficient of the channels, CA.
        embedding: One for both features, or one each.
    """

    ratio: int = 16
    channel: ChannelAttention = field(default_factory=ChannelAttention)
    embedding: Embedding = Embedding.SHARED

    def build(self, lateral: int, decoder: int) -> "SpatialTimesChannelWeighting":
        """Return the module for features of these numbers of channels."""
        return SpatialTimesChannelWeighting(self, lateral, decoder)


@dataclass(frozen=True)
class SpatialPlusChannelAttention:
    """SA exp(SA) + CA: where they agree, and in which channels (S6 and S7 of AGA).

    Attributes:
        ratio: The embedding has the features' width divided by this.
        channel: The coefficient of the channels, CA.
        embedding: One for both features, or one each.
    """

    ratio: int = 16
    channel: ChannelAttention = field(default_factory=ChannelAttention)
    embedding: Embedding = Embedding.SHARED

    def build(self, lateral: int, decoder: int) -> "SpatialPlusChannelWeighting":
        """Return the module for features of these numbers of channels."""
        return SpatialPlusChannelWeighting(self, lateral, decoder)


@dataclass(frozen=True)
class TwoSpatialAttentions:
    """SA₁ exp(SA₁) + SA₂ CA, with an embedding for each SA (S5 of AGA).

    Attributes:
        ratio: Each embedding has the features' width divided by this.
        channel: The coefficient of the channels, CA.
        embedding: One for both features, or one each.
    """

    ratio: int = 16
    channel: ChannelAttention = field(default_factory=ChannelAttention)
    embedding: Embedding = Embedding.SHARED

    def build(self, lateral: int, decoder: int) -> "TwoSpatialWeighting":
        """Return the module for features of these numbers of channels."""
        return TwoSpatialWeighting(self, lateral, decoder)


Coefficient = (
    ChannelAttention
    | SpatialAttention
    | SpatialTimesChannelAttention
    | SpatialPlusChannelAttention
    | TwoSpatialAttentions
    | DotProductPlusChannelAttention
    | NonLocalPlusChannelAttention
)
"""What the encoder's features are multiplied by before the decoder's are added."""

VARIANTS: Mapping[str, Coefficient] = MappingProxyType(
    {
        "S1": ChannelAttention(),
        "S2": SpatialTimesChannelAttention(),
        "S3": SpatialAttention(),
        "S4": SpatialTimesChannelAttention(),
        "S5": TwoSpatialAttentions(),
        "S6": SpatialPlusChannelAttention(),
        "S7": SpatialPlusChannelAttention(),
        "DS7": DotProductPlusChannelAttention(),
        "NS7": NonLocalPlusChannelAttention(),
    }
)
"""The published variants by name; S4 is S2, and S7 is S6, learnt with one more term of loss."""


class SpatialWeighting(nn.Module):
    """The module of `SpatialAttention`."""

    def __init__(self, settings: SpatialAttention, lateral: int, decoder: int) -> None:
        super().__init__()
        self.embed = settings.embedding.build(lateral, decoder, settings.ratio)

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[Float[Tensor, "batch laterals height width"], Float[Tensor, "batch 1 height width"]]:
        """Return `SA * lateral`, and SA."""
        attention = similarity(*self.embed(lateral, decoder))
        return attention * lateral, attention


class SpatialTimesChannelWeighting(nn.Module):
    """The module of `SpatialTimesChannelAttention`."""

    def __init__(self, settings: SpatialTimesChannelAttention, lateral: int, decoder: int) -> None:
        super().__init__()
        self.embed = settings.embedding.build(lateral, decoder, settings.ratio)
        self.channel = settings.channel.build(lateral, decoder)

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[Float[Tensor, "batch laterals height width"], Float[Tensor, "batch 1 height width"]]:
        """Return `SA CA * lateral`, and SA."""
        attention = similarity(*self.embed(lateral, decoder))
        return attention * self.channel.coefficient(lateral, decoder) * lateral, attention


class SpatialPlusChannelWeighting(nn.Module):
    """The module of `SpatialPlusChannelAttention`."""

    def __init__(self, settings: SpatialPlusChannelAttention, lateral: int, decoder: int) -> None:
        super().__init__()
        self.embed = settings.embedding.build(lateral, decoder, settings.ratio)
        self.channel = settings.channel.build(lateral, decoder)

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[Float[Tensor, "batch laterals height width"], Float[Tensor, "batch 1 height width"]]:
        """Return `(SA exp(SA) + CA) * lateral`, and SA."""
        attention = similarity(*self.embed(lateral, decoder))
        coefficient = emphasised(attention) + self.channel.coefficient(lateral, decoder)
        return coefficient * lateral, attention


class TwoSpatialWeighting(nn.Module):
    """The module of `TwoSpatialAttentions`."""

    def __init__(self, settings: TwoSpatialAttentions, lateral: int, decoder: int) -> None:
        super().__init__()
        self.embed = settings.embedding.build(lateral, decoder, settings.ratio)
        self.embed_again = settings.embedding.build(lateral, decoder, settings.ratio)
        self.channel = settings.channel.build(lateral, decoder)

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[Float[Tensor, "batch laterals height width"], Float[Tensor, "batch 1 height width"]]:
        """Return `(SA₁ exp(SA₁) + SA₂ CA) * lateral`, and SA₁."""
        added = similarity(*self.embed(lateral, decoder))
        multiplied = similarity(*self.embed_again(lateral, decoder))
        channels = self.channel.coefficient(lateral, decoder)
        return (emphasised(added) + multiplied * channels) * lateral, added


class Merge(nn.Module):
    """Encoder features, weighted by a coefficient, plus decoder features.

    Decoder features of another width are first brought to the encoder's by a 1x1 convolution
    without bias; the coefficient sees them as they came.
    """

    def __init__(self, coefficient: Coefficient, lateral: int, decoder: int) -> None:
        super().__init__()
        self.weighting = coefficient.build(lateral, decoder)
        same = lateral == decoder
        self.adapt = nn.Identity() if same else nn.Conv2d(decoder, lateral, 1, bias=False)

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[
        Float[Tensor, "batch laterals height width"], Float[Tensor, "batch 1 height width"] | None
    ]:
        """Return the merged features, and the spatial attention where the coefficient has one."""
        weighted, attention = self.weighting(lateral, decoder)
        return weighted + self.adapt(decoder), attention
