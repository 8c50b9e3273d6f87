"""Networks: each file holds a frozen settings class with `build()`, and its module."""

from flexdepth.networks.aga import AGA
from flexdepth.networks.compact import Compact
from flexdepth.networks.edrb import EDRB, EDRBMaps
from flexdepth.networks.pca import PCA

Network = Compact | AGA
"""The settings of any network here."""

__all__ = ["AGA", "EDRB", "PCA", "Compact", "EDRBMaps", "Network"]
