"""An experiment is a value; a variant of it is another value."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from flexdepth.codec import Codec
from flexdepth.data import Data, Folder
from flexdepth.data.recipes import Recipe
from flexdepth.data.transforms import Crop
from flexdepth.losses import Focal, GradientMatching, Loss, Silog, Sky, SpreadQuantiles
from flexdepth.networks import Network
from flexdepth.networks.compact import Compact
from flexdepth.networks.extended import Branch
from flexdepth.networks.heads import BinnedDepth, DepthHead
from flexdepth.networks.merge import Coefficient
from flexdepth.training.loop import LoopSettings
from flexdepth.training.objective import Term
from flexdepth.training.optimiser import AdamWCosine, Optimiser
from flexdepth.training.semi_supervised import Agreement


@dataclass(frozen=True)
class ImageNet:
    """Start with an encoder trained on ImageNet and a random decoder.

    Attributes:
        file: The weights of timm's whole network; None takes an installed package's, or timm's.
    """

    file: Path | None = None


@dataclass(frozen=True)
class Trained:
    """Start with the averaged weights of an earlier run of the same network.

    Attributes:
        checkpoint: A file that the run left.
    """

    checkpoint: Path


@dataclass(frozen=True)
class Bundled:
    """Start with the weights of a model bundle of the same network.

    Attributes:
        bundle: An .onnx file; None takes the model that comes with flexdepth.
    """

    bundle: Path | None = None


@dataclass(frozen=True)
class Untrained:
    """Start with random weights, as the EDRB network does."""


Start = ImageNet | Trained | Bundled | Untrained
"""Where the weights come from."""


@dataclass(frozen=True)
class Labels:
    """Photos without depth, which a trained model labels before the training begins.

    Attributes:
        photos: The folder that they lie in.
        teacher: Where the weights of the model come from: `Bundled` or `Trained`.
        agreement: Where the teacher is sure; elsewhere there is no label.
    """

    photos: Path
    teacher: Start = field(default_factory=Bundled)
    agreement: Agreement = field(default_factory=Agreement)


CODEC = Codec(
    (Start, Data, Loss, Coefficient, Branch, DepthHead, Recipe, Network, Optimiser),
    {
        Data: Folder,
        DepthHead: BinnedDepth,
        Recipe: Crop,
        Network: Compact,
        Optimiser: AdamWCosine,
    },
)
"""Experiments as plain values, and back. What was once the only one of its kind, and has no type
in an old checkpoint, is named."""


def _terms() -> Mapping[str, Term]:
    return {
        "silog": Term(Silog(0.5), 1.0),
        "gradient": Term(GradientMatching(), 0.5),
        "sky": Term(Sky(), 0.1),
        "spread": Term(SpreadQuantiles(), 0.1),
        "focal": Term(Focal(), 0.1),
    }


@dataclass(frozen=True)
class Experiment:
    """Everything that decides the weights a run ends with.

    Attributes:
        network: What is trained.
        data: Pairs to learn from.
        held_out: Pairs to be judged on; its scenes are not among the training pairs.
        terms: What is minimised.
        loop: How long and how.
        start: Where the weights come from.
        seed: Of the weights that do not come pretrained.
        labels: Photos that are trained on beside `data`; None takes measured depth alone.
    """

    network: Network = field(default_factory=Compact)
    data: Data = field(default_factory=lambda: Folder(Path("renders/train")))
    held_out: Data = field(default_factory=lambda: Folder(Path("renders/heldout")))
    terms: Mapping[str, Term] = field(default_factory=_terms)
    loop: LoopSettings = field(default_factory=LoopSettings)
    start: Start = field(default_factory=ImageNet)
    seed: int = 0
    labels: Labels | None = None
