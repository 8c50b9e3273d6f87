"""The base network of chapter 3 and its variants with adaptive geometric attention (AGA).

An encoder, a pyramid of dilated convolutions on its coarsest features, and a decoder that merges
the encoder's features in four stages, coarsest first; depth is one of many bins.
"""

from dataclasses import dataclass, field, replace

from jaxtyping import Float
from torch import Tensor, nn

from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.blocks import (
    BatchNorm,
    DilatedResidual,
    Pyramid,
    projection,
    resized,
    start_as_xavier,
)
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.heads import BinnedDepth, DepthHead
from flexdepth.networks.merge import Coefficient, Merge, SpatialPlusChannelAttention
from flexdepth.sample import Prediction

RELEASED_TOP = BatchNorm(momentum=0.1, eps=0.5)
"""The `top_norm` of the base's released weights, where 0.5 went into the place of eps."""


@dataclass(frozen=True)
class AGA:
    """Depth of one image by bins, with attention to the encoder in four merges.

    Attributes:
        encoder: Its last four feature maps are merged, whatever their widths and strides.
        coefficients: How each merge looks at the encoder, coarsest first.
        laterals: Channels to which the encoder's maps are brought for the merges, coarsest first.
        top: Channels to which the pyramid is brought.
        widths: Channels that come out of the four stages with merges and of the last without.
        pyramid: On the encoder's coarsest map.
        block: On each lateral and after each merge.
        top_norm: The normalisation after the pyramid has been brought to `top` channels.
        head: What the last map means.
        canonical_focal: As in `Prediction`; None, as published, for depth that does not depend on
            the camera.

    References:
        Yin, Liu, Shen and Yan, ICCV 2019 (the base, `BASE`).
        Naderi, Sadovnik, Hayward and Qi, WACV 2022 (the coefficients).
    """

    encoder: Encoder = field(default_factory=lambda: Encoder("resnext101_32x4d", 16))
    coefficients: tuple[Coefficient, Coefficient, Coefficient, Coefficient] = field(
        default_factory=lambda: _four(SpatialPlusChannelAttention())
    )
    laterals: tuple[int, int, int, int] = (512, 256, 256, 256)
    top: int = 512
    widths: tuple[int, int, int, int, int] = (256, 256, 256, 256, 256)
    pyramid: Pyramid = field(default_factory=Pyramid)
    block: DilatedResidual = field(default_factory=DilatedResidual)
    top_norm: BatchNorm = field(default_factory=lambda: BatchNorm(momentum=0.5))
    head: DepthHead = field(default_factory=BinnedDepth)
    canonical_focal: float | None = None

    def build(self) -> "AGANetwork":
        """Return the network with random weights.

        Raises:
            InputError: If timm cannot give the encoder.
        """
        return AGANetwork(self)

    def merged_by(self, coefficient: Coefficient) -> "AGA":
        """Return the same network with one coefficient in all four merges."""
        return replace(self, coefficients=_four(coefficient))


def _four(coefficient: Coefficient) -> tuple[Coefficient, Coefficient, Coefficient, Coefficient]:
    return coefficient, coefficient, coefficient, coefficient


BASE = AGA().merged_by(ChannelAttention())
"""The network that AGA is compared with."""


class AGANetwork(nn.Module):
    """The module of `AGA`."""

    def __init__(self, settings: AGA) -> None:
        super().__init__()
        self.settings = settings
        self.encoder = settings.encoder.build(maps=4)
        coarsest_first = self.encoder.widths[::-1]
        sizes = zip(coarsest_first, settings.laterals, strict=True)
        self.laterals = nn.ModuleList(settings.block.build(*size) for size in sizes)
        self.pyramid = settings.pyramid.build(coarsest_first[0])
        self.top = projection(self.pyramid.width, settings.top, settings.top_norm)
        decoders = (settings.top, *settings.widths[:3])
        merges = map(Merge, settings.coefficients, settings.laterals, decoders)
        blocks = map(settings.block.build, settings.laterals, settings.widths[:4])
        self.stages = nn.ModuleList(map(Stage, merges, blocks))
        self.last = settings.block.build(*settings.widths[3:])
        for part in (self.laterals, self.pyramid, self.top, self.stages, self.last):
            start_as_xavier(part)
        self.head = settings.head.build(settings.widths[-1])

    def forward(self, image: Float[Tensor, "batch 3 height width"]) -> Prediction:
        """Return depth, what the head says beside it and the attention of each merge that has one.

        Args:
            image: RGB in [0, 1], of any size that the encoder takes.
        """
        encoded = self.encoder(image)[::-1]
        decoded = self.top(self.pyramid(encoded[0]))
        attention = []
        for project, stage, features in zip(self.laterals, self.stages, encoded, strict=True):
            decoded, looked_at = stage(project(features), decoded)
            attention.append(looked_at)
        rows, columns = image.shape[-2:]
        half = self.last(resized(decoded, (rows + 1) // 2, (columns + 1) // 2))
        return replace(
            self.head.predicted(resized(half, rows, columns)),
            canonical_focal=self.settings.canonical_focal,
            attention=tuple(a for a in attention if a is not None),
        )


class Stage(nn.Module):
    """A merge at the size of the encoder's features, then a block."""

    def __init__(self, merge: Merge, block: nn.Module) -> None:
        super().__init__()
        self.merge = merge
        self.block = block

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch channels _ _"],
    ) -> tuple[
        Float[Tensor, "batch outputs height width"], Float[Tensor, "batch 1 height width"] | None
    ]:
        """Return the decoder's next features, and the merge's attention where it has one."""
        merged, attention = self.merge(lateral, resized(decoder, *lateral.shape[-2:]))
        return self.block(merged), attention
