"""Losses: each file holds a pure function, and the frozen setting that calls it."""

from flexdepth.losses.gradient_matching import GradientMatching
from flexdepth.losses.silog import Silog
from flexdepth.losses.sky import Sky

Loss = Silog | GradientMatching | Sky
"""The setting of any loss here: (prediction, sample) -> one number for each image."""

__all__ = ["GradientMatching", "Loss", "Silog", "Sky"]
