"""What attention is made of: similarity of embedded features, and a weight for each channel."""

from dataclasses import dataclass
from enum import Enum

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import conv2d

from flexdepth.runtime.errors import InputError

_EPS = 1e-8
"""Added to squared lengths, so that features of zero have similarity 0 and finite gradients."""


class Embedding(Enum):
    """How the features of encoder and decoder are brought into one space.

    With features of unequal widths each side always has its own.
    """

    SHARED = "shared"
    """By the same 1x1 convolution, so that their channels can be compared."""
    SEPARATE = "separate"
    """Each by its own."""

    def build(self, lateral: int, decoder: int, ratio: int) -> nn.Module:
        """Return the module that embeds a pair of features.

        Args:
            lateral: Channels of the encoder's features.
            decoder: Channels of the decoder's features.
            ratio: The embedding has the smaller of both divided by this.
        """
        inner = bottleneck(min(lateral, decoder), ratio)
        if self is Embedding.SHARED and lateral == decoder:
            return SharedEmbedding(lateral, inner)
        return SeparateEmbedding(lateral, decoder, inner)


class SharedEmbedding(nn.Module):
    """One 1x1 convolution without bias for both."""

    def __init__(self, width: int, inner: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.empty(inner, width, 1, 1))
        nn.init.xavier_normal_(self.weight)

    def forward(
        self,
        lateral: Float[Tensor, "batch channels height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[
        Float[Tensor, "batch inner height width"], Float[Tensor, "batch inner height width"]
    ]:
        """Return both, embedded."""
        return conv2d(lateral, self.weight), conv2d(decoder, self.weight)


class SeparateEmbedding(nn.Module):
    """A 1x1 convolution without bias for each."""

    def __init__(self, lateral: int, decoder: int, inner: int) -> None:
        super().__init__()
        self.lateral = nn.Conv2d(lateral, inner, 1, bias=False)
        self.decoder = nn.Conv2d(decoder, inner, 1, bias=False)

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[
        Float[Tensor, "batch inner height width"], Float[Tensor, "batch inner height width"]
    ]:
        """Return both, embedded."""
        return self.lateral(lateral), self.decoder(decoder)


@dataclass(frozen=True)
class ChannelAttention:
    """A weight for each channel (CA), from what the whole image holds: the merge of AMB, S1.

    Attributes:
        ratio: The inner width is the number of channels seen, of both features, divided by this.
    """

    ratio: int = 16

    def build(self, lateral: int, decoder: int) -> "ChannelAttentionWeighting":
        """Return the module for features of these numbers of channels."""
        return ChannelAttentionWeighting(self, lateral, decoder)


class ChannelAttentionWeighting(nn.Module):
    """The module of `ChannelAttention`."""

    def __init__(self, settings: ChannelAttention, lateral: int, decoder: int) -> None:
        super().__init__()
        inner = bottleneck(lateral + decoder, settings.ratio)
        self.squeeze = nn.Conv2d(lateral + decoder, inner, 1, bias=False)
        self.excite = nn.Conv2d(inner, lateral, 1, bias=False)

    def coefficient(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> Float[Tensor, "batch laterals 1 1"]:
        """Return CA, between 0 and 1."""
        content = torch.cat([lateral, decoder], 1).mean((-2, -1), keepdim=True)
        weight: Tensor = self.excite(self.squeeze(content).relu()).sigmoid()
        return weight

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels height width"],
    ) -> tuple[Float[Tensor, "batch laterals height width"], None]:
        """Return `CA * lateral`; there is no spatial map."""
        return self.coefficient(lateral, decoder) * lateral, None


def similarity(
    first: Float[Tensor, "batch channels height width"],
    second: Float[Tensor, "batch channels height width"],
) -> Float[Tensor, "batch 1 height width"]:
    """Return `|a . b| / (|a| |b|)` at each pixel, between 0 and 1.

    Blind to the sign and the length of both; 0 where either is zero, with finite gradients.

    References:
        Naderi, Sadovnik, Hayward and Qi, WACV 2022, eq. 1.
    """
    product = (first * second).sum(1, keepdim=True)
    return (product * inverse_length(first) * inverse_length(second)).abs()


def emphasised(attention: Float[Tensor, "*batch"]) -> Float[Tensor, "*batch"]:
    """Return `x exp(x)`: 0 at 0, e at 1, and steeper than x in between."""
    return attention * attention.exp()


def inverse_length(
    features: Float[Tensor, "batch channels height width"],
) -> Float[Tensor, "batch 1 height width"]:
    """Return `1 / |a|` at each pixel, finite with finite gradients where a is zero."""
    return (features.square().sum(1, keepdim=True) + _EPS).rsqrt()


def bottleneck(channels: int, ratio: int) -> int:
    """Return `channels // ratio`.

    Raises:
        InputError: Fewer than two are left, which leave attention nothing to compare.
    """
    inner = channels // ratio
    if inner < 2:
        raise InputError(
            f"attention over {channels} channels needs at least 2 inside, but a ratio of {ratio} "
            f"leaves {inner}: lower the ratio or widen the decoder"
        )
    return inner
