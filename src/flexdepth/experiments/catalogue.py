"""The experiments by name."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from flexdepth.experiments.chapter3 import CHAPTER3_SMALL, KITTI, NYU_LARGE, NYU_SMALL
from flexdepth.experiments.experiment import Experiment, Trained
from flexdepth.experiments.run import BEST
from flexdepth.losses import GradientMatching
from flexdepth.training.batches import BatchSettings
from flexdepth.training.loop import LoopSettings
from flexdepth.training.objective import Term
from flexdepth.training.optimiser import AdamWCosine

_COMPACT = Experiment()

_COMPACT_LARGE = replace(
    _COMPACT,
    start=Trained(Path("runs/compact") / BEST),
    terms={**_COMPACT.terms, "gradient": Term(GradientMatching(), 1.0)},
    loop=LoopSettings(
        iterations=900,
        save_every=150,
        average_decay=0.995,
        batches=BatchSettings(
            shapes=((384, 288), (384, 288), (320, 320), (448, 224), (576, 192)), seed=1
        ),
        optimiser=AdamWCosine(rate=5e-4, warm_up=50),
    ),
)

CATALOGUE: Mapping[str, Experiment] = MappingProxyType(
    {
        "compact": _COMPACT,
        "compact-large": _COMPACT_LARGE,
        "nyu-large": NYU_LARGE,
        "nyu-small": NYU_SMALL,
        "kitti": KITTI,
        "chapter3-small": CHAPTER3_SMALL,
    }
)
"""`compact` learns from small images; `compact-large` goes on at the size of predictions, with more
weight on edges. The others are the training of chapter 3."""
