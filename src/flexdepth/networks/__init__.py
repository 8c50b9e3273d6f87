"""Networks: each file holds a frozen settings class with `build()`, and its module."""

from flexdepth.networks.compact import Compact

Network = Compact
"""The settings of any network here; a union as soon as there are two."""

__all__ = ["Compact", "Network"]
