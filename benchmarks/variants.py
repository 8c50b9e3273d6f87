"""The networks, losses, sizes and augmentations that `choices.py` trains beside one another."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import interpolate

from flexdepth.data.colour import Colour
from flexdepth.experiments.experiment import Experiment
from flexdepth.experiments.start import give_weights
from flexdepth.geometry.depth import DepthBins
from flexdepth.losses import GradientMatching, VirtualNormal, WeightedCrossEntropy
from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.compact import Compact, CompactNetwork
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.heads import LogDepth, LogDepthHead
from flexdepth.networks.merge import SpatialPlusChannelAttention
from flexdepth.sample import Prediction
from flexdepth.training.batches import BatchSettings
from flexdepth.training.objective import Term

BINS = DepthBins(96, 0.05, 500.0, unit=1.0)
"""Of canonical depth in metres, half a centimetre to a decimetre wide near, equally in the log."""


@dataclass(frozen=True)
class BinnedLogDepth(LogDepth):
    """Depth as the mean, in the logarithm, of bins that are scored at half the image's size."""

    def build(self, inputs: int) -> "BinnedLogDepthHead":
        """Return the head on features of `inputs` channels."""
        return BinnedLogDepthHead(self, inputs)


class BinnedLogDepthHead(LogDepthHead):
    """The module of `BinnedLogDepth`; keeps the scores for the loss of classification."""

    def __init__(self, settings: LogDepth, inputs: int) -> None:
        super().__init__(settings, inputs)
        self.score = nn.Conv2d(inputs, BINS.count, 3, padding=1, padding_mode="replicate")
        self.logits: Tensor | None = None

    def forward(
        self, features: Float[Tensor, "batch channels height width"]
    ) -> tuple[
        Float[Tensor, "batch full_height full_width"], Float[Tensor, "batch full_height full_width"]
    ]:
        """Return depth and the sky's logit, at twice the size of the features."""
        logits = self.score(features)
        self.logits = logits
        log_depth = BINS.depth(logits).log()[:, None]
        maps = torch.cat([log_depth, self.conv(features)[:, 1:]], 1)
        log_depth, sky_logit = interpolate(maps, scale_factor=2.0, mode="bilinear").unbind(1)
        return log_depth.exp(), sky_logit


class ScoredNetwork(CompactNetwork):
    """`CompactNetwork` whose prediction has the scores of the bins."""

    def forward(self, image: Float[Tensor, "batch 3 height width"]) -> Prediction:
        """Return what `CompactNetwork` does, and the scores at the image's size."""
        prediction = super().forward(image)
        if not isinstance(self.head, BinnedLogDepthHead) or self.head.logits is None:
            raise TypeError("ScoredNetwork needs the head BinnedLogDepth")
        logits = interpolate(self.head.logits, scale_factor=2.0, mode="bilinear")
        return replace(prediction, logits=logits, bins=BINS)


class WithoutAttention(nn.Module):
    """The plain merge: what the encoder saw is added as it is."""

    def forward(self, lateral: Tensor, _decoder: Tensor) -> tuple[Tensor, None]:
        """Return the lateral features; there is no map of attention."""
        return lateral, None


@dataclass(frozen=True)
class Addition(ChannelAttention):
    """The coefficient 1 everywhere."""

    def build(self, _lateral: int, _decoder: int) -> WithoutAttention:  # type: ignore[override]
        """Return the module."""
        return WithoutAttention()


@dataclass(frozen=True)
class Variant:
    """One thing that is done otherwise than in `compact`.

    Attributes:
        network: What is trained.
        terms: What is added to, or replaces, the terms of `compact`; None takes one away.
        batches: How batches are made.
        seed: Of the weights that do not come pretrained.
        scored: The network is a `ScoredNetwork`.
    """

    network: Compact = field(default_factory=Compact)
    terms: Mapping[str, Term | None] = field(default_factory=dict)
    batches: BatchSettings = field(default_factory=lambda: SMALL)
    seed: int = 0
    scored: bool = False

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of what it learns from, and is judged at."""
        return self.batches.shapes[0]


SMALL = BatchSettings(shapes=((160, 128),))
_BINNED = Compact(head=BinnedLogDepth())

VARIANTS: Mapping[str, Variant] = {
    "compact": Variant(),
    "again": Variant(seed=1),
    "bins": Variant(_BINNED, scored=True),
    "bins, WCEL": Variant(
        _BINNED, {"cross_entropy": Term(WeightedCrossEntropy(), 0.3)}, scored=True
    ),
    "silog alone": Variant(terms={"gradient": None}),
    "gradient x 4": Variant(terms={"gradient": Term(GradientMatching(), 2.0)}),
    "virtual normals": Variant(terms={"normal": Term(VirtualNormal(focal=None), 1.0)}),
    "addition": Variant(Compact(coefficient=Addition())),
    "S1": Variant(Compact(coefficient=ChannelAttention(8))),
    "S7": Variant(
        Compact(coefficient=SpatialPlusChannelAttention(ratio=16, channel=ChannelAttention(16)))
    ),
    "lite1": Variant(Compact(encoder=Encoder("tf_efficientnet_lite1"))),
    "lite2": Variant(Compact(encoder=Encoder("tf_efficientnet_lite2"))),
    "no augmentation": Variant(batches=replace(SMALL, colour=Colour(strength=0.0))),
    "twice the pixels": Variant(batches=replace(SMALL, shapes=((224, 192),))),
}


def network_of(variant: Variant) -> CompactNetwork:
    """Return a variant's network with weights of its seed."""
    torch.manual_seed(variant.seed)
    return (ScoredNetwork if variant.scored else CompactNetwork)(variant.network)


def built(variant: Variant) -> CompactNetwork:
    """Return a variant's network with the encoder's first weights."""
    network = network_of(variant)
    give_weights(network, Experiment().start)
    return network.to(memory_format=torch.channels_last)


def terms_of(variant: Variant) -> Mapping[str, Term]:
    """Return what a variant minimises."""
    named = {**Experiment().terms, **variant.terms}
    return {name: term for name, term in named.items() if term is not None}
