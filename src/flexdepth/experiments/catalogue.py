"""The experiments by name."""

from collections.abc import Mapping
from types import MappingProxyType

from flexdepth.experiments.experiment import Experiment

CATALOGUE: Mapping[str, Experiment] = MappingProxyType({"compact": Experiment()})
"""`compact` makes the bundled model."""
