"""Networks: each file holds a frozen settings class with `build()`, and its module."""

from flexdepth.networks.aga import AGA, AGANetwork
from flexdepth.networks.compact import Compact, CompactNetwork
from flexdepth.networks.edrb import EDRB, EDRBMaps, EDRBNetwork
from flexdepth.networks.pca import PCA, PCANetwork

Network = Compact | AGA | EDRB | PCA
"""The settings of any network that makes depth of an image."""

Built = CompactNetwork | AGANetwork | EDRBNetwork | PCANetwork
"""The module of any of them."""

__all__ = ["AGA", "EDRB", "PCA", "Built", "Compact", "EDRBMaps", "Network"]
