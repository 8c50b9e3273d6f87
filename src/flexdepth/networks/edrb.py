"""The EDRB network: an encoder and a decoder of extended dilated residual blocks.

Encoders for classification double the channels where they halve the size, and so have most of
their weights where there are few places to learn them from. Here the channels stay as they are,
and most of the work is done on large maps (section 3.5.2 of the dissertation, Figs 3.11 and 5.14).
No part of it is pretrained.
"""

from dataclasses import dataclass, field, replace

from jaxtyping import Float
from torch import Tensor, nn

from flexdepth.networks.aga import Stage
from flexdepth.networks.blocks import resized, start_as_xavier
from flexdepth.networks.extended import Activations, Branch, ExtendedResidual
from flexdepth.networks.heads import BinnedDepth, DepthHead
from flexdepth.networks.merge import Coefficient, Merge, SpatialPlusChannelAttention
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction

MEAN, DEVIATION = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)
"""Of red, green and blue over ImageNet, by which every network of chapter 3 standardises images."""


@dataclass(frozen=True)
class Rows:
    """An encoder and a decoder, row by row: maps of any number of channels in, features out.

    Each row of the encoder divides the size by two; on the way back each row but the last is
    brought to the size of the encoder's, merged with it and refined, and the first to the size
    that came in.

    Attributes:
        widths: Channels of each row, the finest first. The published ones are given for chapter 5
            alone, which calls the rest exactly similar to chapter 3; their number is nowhere said.
        first_stride: Of the first row: 2 as all others, or 1, which takes four times the memory.
        encoder_repeats: How often the second part of each block is repeated in the encoder.
        decoder_repeats: The same in the decoder.
        block: What all rows are made of.
        coefficient: How the decoder looks at the encoder.

    Raises:
        InputError: There are fewer than two rows.
    """

    widths: tuple[int, ...] = (256, 512, 512, 512, 512)
    first_stride: int = 2
    encoder_repeats: int = 4
    decoder_repeats: int = 1
    block: ExtendedResidual = field(default_factory=ExtendedResidual)
    coefficient: Coefficient = field(default_factory=SpatialPlusChannelAttention)

    def __post_init__(self) -> None:
        if len(self.widths) < 2:
            raise InputError(
                f"an encoder and a decoder need the widths of at least 2 rows, got {self.widths}"
            )

    def build(self, inputs: int) -> "RowsNetwork":
        """Return the module for maps of `inputs` channels, with random weights."""
        return RowsNetwork(self, inputs)

    def made_of(self, branch: Branch) -> "Rows":
        """Return the same rows with other branches in their blocks."""
        return replace(self, block=replace(self.block, branch=branch))

    def with_activations(self, activations: Activations) -> "Rows":
        """Return the same rows with their activations kept or recomputed."""
        return replace(self, block=replace(self.block, activations=activations))


class RowsNetwork(nn.Module):
    """The module of `Rows`."""

    def __init__(self, settings: Rows, inputs: int) -> None:
        super().__init__()
        widths, block = settings.widths, settings.block
        strides = (settings.first_stride, *(2 for _ in widths[1:]))
        sizes = zip((inputs, *widths[:-1]), widths, strides, strict=True)
        repeats = settings.encoder_repeats
        self.encoder = nn.ModuleList(block.build(i, w, repeats, s) for i, w, s in sizes)
        self.decoder = nn.ModuleList(
            Stage(
                Merge(settings.coefficient, lateral, decoder),
                block.build(lateral, lateral, settings.decoder_repeats),
            )
            for lateral, decoder in zip(widths[-2::-1], widths[:0:-1], strict=True)
        )
        start_as_xavier(self)

    def forward(
        self, maps: Float[Tensor, "batch inputs height width"]
    ) -> tuple[Float[Tensor, "batch first height width"], tuple[Float[Tensor, "batch 1 _ _"], ...]]:
        """Return features at the size that came in, and the attention of each merge that has one.

        Args:
            maps: Of any size.
        """
        features, encoded = maps, []
        for row in self.encoder:
            features = row(features)
            encoded.append(features)
        attention = []
        for stage, lateral in zip(self.decoder, encoded[-2::-1], strict=True):
            features, looked_at = stage(lateral, features)
            attention.append(looked_at)
        looked = tuple(a for a in attention if a is not None)
        return resized(features, *maps.shape[-2:]), looked


@dataclass(frozen=True)
class EDRB:
    """Depth of one image by extended dilated residual blocks.

    Attributes:
        rows: The encoder and the decoder.
        head: What the last map means.
        canonical_focal: As in `Prediction`; None, as published, for depth that does not depend on
            the camera.
    """

    rows: Rows = field(default_factory=Rows)
    head: DepthHead = field(default_factory=BinnedDepth)
    canonical_focal: float | None = None

    def build(self) -> "EDRBNetwork":
        """Return the network with random weights."""
        return EDRBNetwork(self)


class EDRBNetwork(nn.Module):
    """The module of `EDRB`."""

    def __init__(self, settings: EDRB) -> None:
        super().__init__()
        self.settings = settings
        self.rows = settings.rows.build(3)
        self.head = settings.head.build(settings.rows.widths[0])

    def forward(self, image: Float[Tensor, "batch 3 height width"]) -> Prediction:
        """Return depth, what the head says beside it and the attention of each merge.

        Args:
            image: RGB in [0, 1], of any size.
        """
        features, attention = self.rows(standardised(image))
        predicted = self.head.predicted(features)
        return replace(
            predicted, canonical_focal=self.settings.canonical_focal, attention=attention
        )


@dataclass(frozen=True)
class EDRBMaps:
    """Any number of maps from any number of maps: the network of Fig. 5.14.

    From two frames one after the other, 6 channels, it makes the optical flow, 2, or the normals
    and translations, 6; from one frame depth without bounds, 1.

    Attributes:
        inputs: Channels that come in; frames are given as `standardised` makes them.
        outputs: Channels that go out, through a 3x3 convolution that dilates by 2.
        rows: The encoder and the decoder.
    """

    inputs: int = 6
    outputs: int = 2
    rows: Rows = field(default_factory=Rows)

    def build(self) -> "EDRBMapsNetwork":
        """Return the network with random weights."""
        return EDRBMapsNetwork(self)


class EDRBMapsNetwork(nn.Module):
    """The module of `EDRBMaps`."""

    def __init__(self, settings: EDRBMaps) -> None:
        super().__init__()
        self.settings = settings
        self.rows = settings.rows.build(settings.inputs)
        self.head = nn.Conv2d(settings.rows.widths[0], settings.outputs, 3, padding=2, dilation=2)
        start_as_xavier(self.head)

    def forward(
        self, maps: Float[Tensor, "batch inputs height width"]
    ) -> Float[Tensor, "batch outputs height width"]:
        """Return the maps at the size that came in."""
        features, _ = self.rows(maps)
        out: Tensor = self.head(features)
        return out


def standardised(
    images: Float[Tensor, "batch channels height width"],
) -> Float[Tensor, "batch channels height width"]:
    """Return each colour minus its mean over ImageNet, divided by its deviation there.

    Args:
        images: RGB in [0, 1], of one frame or of several, one after the other.
    """
    frames = images.shape[1] // 3
    mean, deviation = (images.new_tensor(x * frames)[:, None, None] for x in (MEAN, DEVIATION))
    return (images - mean) / deviation
