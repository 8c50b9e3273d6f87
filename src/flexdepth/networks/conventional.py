"""Conventional attention in the place of AGA's: dot products, and every pixel with every other.

Both have exactly the parameters of `SpatialPlusChannelAttention`, with which they are compared.
"""

from dataclasses import dataclass, field

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.utils.checkpoint import checkpoint

from flexdepth.networks.attention import (
    ChannelAttention,
    Embedding,
    emphasised,
    inverse_length,
)


@dataclass(frozen=True)
class DotProductPlusChannelAttention:
    """D + CA, D the dot product of the embedded features (DS7 of AGA): unbounded, and signed.

    Attributes:
        ratio: The embedding has the features' width divided by this.
        channel: The coefficient of the channels, CA.
        embedding: One for both features, or one each.
        power: D is divided by the width of the embedding to this power; 0 leaves it raw, 1/2 is
            the scale of transformers.
    """

    ratio: int = 16
    channel: ChannelAttention = field(default_factory=ChannelAttention)
    embedding: Embedding = Embedding.SHARED
    power: float = 0.0

    def build(self, lateral: int, decoder: int) -> "DotProductPlusChannelWeighting":
        """Return the module for features of these numbers of channels."""
        return DotProductPlusChannelWeighting(self, lateral, decoder)


@dataclass(frozen=True)
class NonLocalPlusChannelAttention:
    """A pixel looks at all others (NS7 of AGA): `mean over q of A exp(A) lateral(q) + CA lateral`.

    A is the similarity of the decoder here and the encoder at q. The time grows with the square
    of the number of pixels, the memory does not.

    Attributes:
        ratio: The embedding has the features' width divided by this.
        channel: The coefficient of the channels, CA.
        embedding: One for both features, or one each.
        rows: Pixels of each image that are worked on at a time; fewer take less memory.
    """

    ratio: int = 16
    channel: ChannelAttention = field(default_factory=ChannelAttention)
    embedding: Embedding = Embedding.SHARED
    rows: int = 512

    def build(self, lateral: int, decoder: int) -> "NonLocalPlusChannelWeighting":
        """Return the module for features of these numbers of channels."""
        return NonLocalPlusChannelWeighting(self, lateral, decoder)


class DotProductPlusChannelWeighting(nn.Module):
    """The module of `DotProductPlusChannelAttention`."""

    def __init__(
        self, settings: DotProductPlusChannelAttention, lateral: int, decoder: int
    ) -> None:
        super().__init__()
        self.power = settings.power
        self.embed = settings.embedding.build(lateral, decoder, settings.ratio)
        self.channel = settings.channel.build(lateral, decoder)

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[Float[Tensor, "batch laterals height width"], Float[Tensor, "batch 1 height width"]]:
        """Return `(D + CA) * lateral`, and D."""
        first, second = self.embed(lateral, decoder)
        product = (first * second).sum(1, keepdim=True) / first.shape[1] ** self.power
        return (product + self.channel.coefficient(lateral, decoder)) * lateral, product


class NonLocalPlusChannelWeighting(nn.Module):
    """The module of `NonLocalPlusChannelAttention`."""

    def __init__(self, settings: NonLocalPlusChannelAttention, lateral: int, decoder: int) -> None:
        super().__init__()
        self.rows = settings.rows
        self.embed = settings.embedding.build(lateral, decoder, settings.ratio)
        self.channel = settings.channel.build(lateral, decoder)

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[Float[Tensor, "batch laterals height width"], Float[Tensor, "batch 1 height width"]]:
        """Return the weighted features, and the mean of A over q."""
        key, query = self.embed(lateral, decoder)
        attended, alike = attended_everywhere(lateral, key, query, self.rows)
        return attended + self.channel.coefficient(lateral, decoder) * lateral, alike


def attended_everywhere(
    lateral: Float[Tensor, "batch laterals height width"],
    key: Float[Tensor, "batch inner height width"],
    query: Float[Tensor, "batch inner height width"],
    rows: int,
) -> tuple[Float[Tensor, "batch laterals height width"], Float[Tensor, "batch 1 height width"]]:
    """Return the mean over q of `f(A) lateral(q)` at each pixel p, and the mean of A over q.

    A is the similarity of `query` at p and `key` at q, f is `emphasised`. Of the matrix A only
    some rows exist at a time; they are made again for the gradient.

    Args:
        lateral: What is averaged.
        key: Embedded features of where to look at.
        query: Embedded features of where it is looked from.
        rows: Pixels p at a time.
    """
    values = lateral.flatten(2).mT
    keys, queries = ((x * inverse_length(x)).flatten(2).mT for x in (key, query))
    parts = [
        checkpoint(_attended, part, keys, values, use_reentrant=False, preserve_rng_state=False)
        for part in torch.split(queries, rows, 1)
    ]
    attended, alike = (torch.cat(column, 1).mT for column in zip(*parts, strict=True))
    return attended.reshape_as(lateral), alike.reshape_as(lateral[:, :1])


def _attended(
    query: Float[Tensor, "batch rows inner"],
    key: Float[Tensor, "batch pixels inner"],
    values: Float[Tensor, "batch pixels laterals"],
) -> tuple[Float[Tensor, "batch rows laterals"], Float[Tensor, "batch rows 1"]]:
    alike = (query @ key.mT).abs()
    return emphasised(alike) @ values / key.shape[1], alike.mean(2, keepdim=True)
