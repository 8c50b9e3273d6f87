"""Networks: each file holds a frozen settings class with `build()`, and its module."""

from flexdepth.networks.aga import AGA
from flexdepth.networks.compact import Compact

Network = Compact | AGA
"""The settings of any network here."""

__all__ = ["AGA", "Compact", "Network"]
