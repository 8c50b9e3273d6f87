"""Losses: each file holds a pure function, and the frozen setting that calls it."""

from flexdepth.losses.berhu import BerHu
from flexdepth.losses.bin_centres import BinCentres
from flexdepth.losses.cross_entropy import WeightedCrossEntropy
from flexdepth.losses.focal import Focal
from flexdepth.losses.gradient_matching import GradientMatching
from flexdepth.losses.ordinal import Ordinal
from flexdepth.losses.silog import Silog
from flexdepth.losses.sky import Sky
from flexdepth.losses.spread import SpreadQuantiles
from flexdepth.losses.squared import Squared
from flexdepth.losses.virtual_normal import VirtualNormal

Loss = (
    Silog
    | GradientMatching
    | Sky
    | WeightedCrossEntropy
    | VirtualNormal
    | Squared
    | Ordinal
    | BerHu
    | BinCentres
    | SpreadQuantiles
    | Focal
)
"""The setting of any loss here: (prediction, sample) -> one number for each image."""

__all__ = [
    "BerHu",
    "BinCentres",
    "Focal",
    "GradientMatching",
    "Loss",
    "Ordinal",
    "Silog",
    "Sky",
    "SpreadQuantiles",
    "Squared",
    "VirtualNormal",
    "WeightedCrossEntropy",
]
