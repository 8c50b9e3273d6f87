"""The experiments by name."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from flexdepth.experiments.experiment import Experiment, Trained
from flexdepth.experiments.run import BEST
from flexdepth.losses import GradientMatching
from flexdepth.training.batches import BatchSettings
from flexdepth.training.loop import LoopSettings
from flexdepth.training.objective import Term
from flexdepth.training.optimiser import OptimiserSettings

_COMPACT = Experiment()

_COMPACT_LARGE = replace(
    _COMPACT,
    start=Trained(Path("runs/compact") / BEST),
    terms={**_COMPACT.terms, "gradient": Term(GradientMatching(), 1.0)},
    loop=LoopSettings(
        iterations=800,
        save_every=100,
        batches=BatchSettings(
            shapes=((384, 288), (384, 288), (320, 320), (448, 224), (576, 192)), seed=1
        ),
        optimiser=OptimiserSettings(rate=3e-4),
    ),
)

CATALOGUE: Mapping[str, Experiment] = MappingProxyType(
    {"compact": _COMPACT, "compact-large": _COMPACT_LARGE}
)
"""`compact` learns from small images; `compact-large` goes on at the size of predictions, with more
weight on edges."""
