"""The experiments by name."""

from collections.abc import Mapping
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType

from flexdepth.data import Folder
from flexdepth.experiments.chapter3 import (
    CHAPTER3_SHORT,
    CHAPTER3_SMALL,
    KITTI,
    NYU_LARGE,
    NYU_SMALL,
)
from flexdepth.experiments.experiment import Experiment, Trained
from flexdepth.experiments.pca import PCA_NYU, PCA_RENDERS
from flexdepth.experiments.run import BEST
from flexdepth.experiments.yaml_files import read_experiment
from flexdepth.losses import GradientMatching, SpreadQuantiles, VirtualNormal
from flexdepth.runtime.errors import InputError
from flexdepth.training.batches import BatchSettings
from flexdepth.training.loop import LoopSettings
from flexdepth.training.objective import Term
from flexdepth.training.optimiser import AdamWCosine

_COMPACT = Experiment()

_OF_PREDICTIONS = BatchSettings(
    shapes=((384, 288), (384, 288), (320, 320), (448, 224), (576, 192)), seed=1
)

_COMPACT_LARGE = replace(
    _COMPACT,
    start=Trained(Path("runs/compact") / BEST),
    terms={
        **_COMPACT.terms,
        "gradient": Term(GradientMatching(), 1.0),
        "normal": Term(VirtualNormal(focal=None), 0.5),
    },
    loop=LoopSettings(
        iterations=900,
        save_every=150,
        average_decay=0.995,
        batches=replace(_OF_PREDICTIONS, size=32),
        optimiser=AdamWCosine(rate=5e-4, warm_up=50),
    ),
)

_COMPACT_SPREAD = replace(
    _COMPACT,
    data=Folder(Path("renders/calibration")),
    start=Trained(Path("runs/compact-large") / BEST),
    terms={"spread": Term(SpreadQuantiles(), 1.0)},
    loop=replace(
        _COMPACT_LARGE.loop,
        iterations=1500,
        save_every=250,
        batches=_OF_PREDICTIONS,
        learns=("spread",),
    ),
)

CATALOGUE: Mapping[str, Experiment] = MappingProxyType(
    {
        "compact": _COMPACT,
        "compact-large": _COMPACT_LARGE,
        "compact-spread": _COMPACT_SPREAD,
        "nyu-large": NYU_LARGE,
        "nyu-small": NYU_SMALL,
        "kitti": KITTI,
        "chapter3-small": CHAPTER3_SMALL,
        "chapter3-short": CHAPTER3_SHORT,
        "pca": PCA_RENDERS,
        "pca-nyu": PCA_NYU,
    }
)
"""`compact` learns from small images; `compact-large` goes on at the size of predictions, with
larger batches, virtual normals and more weight on edges; `compact-spread` teaches it, on scenes
that it has not learnt from, how far off its depth may be, and changes nothing else. The others are
the trainings of chapter 3."""


def experiment_named(name: str) -> Experiment:
    """Return an experiment of the catalogue, or the one in a .yaml file.

    Raises:
        InputError: There is no such experiment or file, or it holds anything else.
    """
    if Path(name).suffix in {".yaml", ".yml"}:
        return read_experiment(Path(name), CATALOGUE)
    if name not in CATALOGUE:
        near = get_close_matches(name, CATALOGUE, n=1)
        hint = (
            f"did you mean {near[0]!r}?"
            if near
            else f"choose one of {sorted(CATALOGUE)} or a .yaml file"
        )
        raise InputError(f"no experiment {name!r}; {hint}")
    return CATALOGUE[name]
