"""Running an experiment in a folder: start or resume, log, checkpoints."""

from collections.abc import Callable
from pathlib import Path

import torch

from flexdepth.experiments.experiment import CODEC, Experiment
from flexdepth.networks import Network
from flexdepth.networks.compact import CompactNetwork
from flexdepth.networks.encoders import load_imagenet
from flexdepth.runtime.errors import InputError
from flexdepth.training.checkpoint import load, restore, save
from flexdepth.training.loop import Run, Sources, train
from flexdepth.training.record import Record

LATEST, BEST = "latest.safetensors", "best.safetensors"
"""Files in a run's folder; the best has the lowest held-out error of the averaged weights."""


def trained_network(path: Path) -> CompactNetwork:
    """Return the averaged network in a checkpoint, ready to predict.

    Raises:
        InputError: The file is no checkpoint, or of a network that this version does not know.
    """
    checkpoint = load(path)
    settings = CODEC.restored(Network, checkpoint.settings.get("network"), str(path))
    network = settings.build()
    restore(network, checkpoint.part("average"), str(path))
    return network.eval()


def run_experiment(
    experiment: Experiment, folder: Path, processes: int, show: Callable[[str], None]
) -> None:
    """Train, or go on training, in a folder.

    Raises:
        InputError: The data cannot be read, or the folder holds a run of other settings.
    """
    folder.mkdir(parents=True, exist_ok=True)
    sources = Sources(experiment.data.load(), experiment.held_out.load(), processes)
    settings = CODEC.plain(experiment)
    torch.manual_seed(experiment.seed)
    network = experiment.network.build()
    latest, best = folder / LATEST, folder / BEST
    if latest.exists():
        run = Run.started(network, experiment.loop)
        if load(latest).settings != settings:
            raise InputError(f"{latest}: belongs to a run of other settings; take another folder")
        run.resume(latest)
        show(f"resuming at iteration {run.iteration}")
    else:
        load_imagenet(network.encoder)
        run = Run.started(network, experiment.loop)
    scores = [float(load(best).settings["score"])] if best.exists() else []

    def keep(run: Run, score: float) -> None:
        save(latest, run.checkpoint(settings))
        if not scores or score < min(scores):
            save(best, run.checkpoint({**settings, "score": score}))
        scores.append(score)

    record = Record(folder / "log.jsonl", experiment.loop.iterations, show)
    train(run, experiment.loop, experiment.terms, sources, record, keep)
