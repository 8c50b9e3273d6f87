"""The default network: a light encoder, and a narrow decoder with geometric-attention merges."""

from dataclasses import dataclass, field

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import interpolate

from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.blocks import BatchNorm, DilatedResidual, projection, start_as_xavier
from flexdepth.networks.certainty import FocalLength, Spread
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.heads import LogDepth
from flexdepth.networks.merge import Coefficient, Merge, SpatialPlusChannelAttention
from flexdepth.sample import Prediction


@dataclass(frozen=True)
class Compact:
    """Depth and sky of one image, how sure that is, and the lens; fast enough for two cores.

    The depth is canonical: what it would be, in metres, had the image been taken with a focal
    length of `canonical_focal` diagonals of a 4:3 image of the same area. A picture does not tell
    its focal length, so metres = depth * (focal length in these diagonals) / `canonical_focal`.

    Attributes:
        encoder: Whose five feature maps lie at strides 2, 4, 8, 16 and 32.
        widths: Channels of the decoder at strides 16, 8, 4 and 2.
        coefficient: How the decoder looks at the encoder.
        block: What refines the merged features.
        norm: The normalisation of the projections.
        head: What the last map means.
        spread: What says how far off depth may be.
        focal: What says which lens took the image.
        canonical_focal: In diagonals of a 4:3 image of the same area.
    """

    encoder: Encoder = field(default_factory=Encoder)
    widths: tuple[int, int, int, int] = (128, 96, 64, 32)
    coefficient: Coefficient = field(
        default_factory=lambda: SpatialPlusChannelAttention(ratio=4, channel=ChannelAttention(8))
    )
    block: DilatedResidual = field(
        default_factory=lambda: DilatedResidual(1, BatchNorm(), "replicate")
    )
    norm: BatchNorm = field(default_factory=BatchNorm)
    head: LogDepth = field(default_factory=LogDepth)
    spread: Spread = field(default_factory=Spread)
    focal: FocalLength = field(default_factory=FocalLength)
    canonical_focal: float = 0.8

    def build(self) -> "CompactNetwork":
        """Return the network with random weights."""
        return CompactNetwork(self)


class CompactNetwork(nn.Module):
    """The module of `Compact`."""

    def __init__(self, settings: Compact) -> None:
        super().__init__()
        self.settings = settings
        self.encoder = settings.encoder.build()
        *laterals, coarsest = self.encoder.widths
        top = settings.widths[0]
        self.top = nn.Sequential(projection(coarsest, top, settings.norm), nn.ReLU())
        self.context = nn.Conv2d(top, top, 1)
        inputs = (top, *settings.widths[:-1])
        sizes = zip(inputs, reversed(laterals), settings.widths, strict=True)
        self.levels = nn.ModuleList(_Level(settings, *size) for size in sizes)
        for part in (self.top, self.context, self.levels):
            start_as_xavier(part)
        self.head = settings.head.build(settings.widths[-1])
        self.spread = settings.spread.build((top, *settings.widths[:3]))
        self.focal = settings.focal.build(top)

    def forward(self, image: Float[Tensor, "batch 3 height width"]) -> Prediction:
        """Return canonical depth, sky, spread, focal length and the attention of each merge.

        Args:
            image: RGB in [0, 1]; height and width are multiples of 32.
        """
        *laterals, coarsest = self.encoder(image)
        features = self.top(coarsest)
        focal = self.focal(features)
        features = features + self.context(features.mean((-2, -1), keepdim=True))
        decoded, attention = [features], []
        for level, lateral in zip(self.levels, reversed(laterals), strict=True):
            features, looked_at = level(lateral, features)
            decoded.append(features)
            attention.append(looked_at)
        depth, sky_logit = self.head(features)
        return Prediction(
            depth=depth,
            canonical_focal=self.settings.canonical_focal,
            sky_logit=sky_logit,
            attention=tuple(a for a in attention if a is not None),
            spread=self.spread(decoded[:-1]),
            focal=focal,
        )


class _Level(nn.Module):
    """From the decoder's features to those at twice the size, merged with the encoder's."""

    def __init__(self, settings: Compact, inputs: int, lateral: int, width: int) -> None:
        super().__init__()
        self.lateral = projection(lateral, width, settings.norm)
        self.narrow = projection(inputs, width, settings.norm)
        self.merge = Merge(settings.coefficient, width, width)
        self.block = settings.block.build(width, width)

    def forward(
        self,
        lateral: Float[Tensor, "batch laterals height width"],
        decoder: Float[Tensor, "batch inputs half_height half_width"],
    ) -> tuple[
        Float[Tensor, "batch outputs height width"], Float[Tensor, "batch 1 height width"] | None
    ]:
        # A 1x1 convolution and a bilinear resize commute; before the resize it costs a quarter.
        grown = interpolate(
            self.narrow(decoder), scale_factor=2.0, mode="bilinear", align_corners=False
        )
        merged, attention = self.merge(self.lateral(lateral), grown)
        return self.block(merged), attention
