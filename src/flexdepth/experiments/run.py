"""Running an experiment in a folder: start or resume, log, checkpoints."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from pathlib import Path

import torch

from flexdepth.experiments.experiment import CODEC, Experiment, ImageNet, Trained
from flexdepth.networks import Network
from flexdepth.networks.aga import AGANetwork
from flexdepth.networks.compact import CompactNetwork
from flexdepth.networks.pretrained import load_imagenet
from flexdepth.runtime.errors import InputError
from flexdepth.training.checkpoint import load, restore, save
from flexdepth.training.loop import Run, Sources, train
from flexdepth.training.record import Record

LATEST, BEST = "latest.safetensors", "best.safetensors"
"""Files in a run's folder; the best has the lowest held-out error of the averaged weights."""


@dataclass(frozen=True)
class _Stored:
    """The settings that a checkpoint's network is built from."""

    network: Network


def trained_network(path: Path) -> CompactNetwork | AGANetwork:
    """Return the averaged network in a checkpoint, ready to predict.

    Raises:
        InputError: The file is no checkpoint, or of a network that this version does not know.
    """
    checkpoint = load(path)
    named = {"network": checkpoint.settings.get("network")}
    network = CODEC.restored(_Stored, named, str(path)).network.build()
    restore(network, checkpoint.part("average"), str(path))
    return network.eval()


def run_experiment(
    experiment: Experiment, folder: Path, processes: int, show: Callable[[str], None]
) -> None:
    """Train, or go on training, in a folder.

    Raises:
        InputError: The data or the weights to start from cannot be read, or the folder holds a
            run of other settings.
    """
    sources = Sources(experiment.data.load(), experiment.held_out.load(), processes)
    run = _begun(experiment, folder / LATEST)
    if run.iteration:
        show(f"resuming at iteration {run.iteration}")
    folder.mkdir(parents=True, exist_ok=True)
    record = Record(folder / "log.jsonl", experiment.loop.iterations, show)
    settings = CODEC.plain(experiment)
    lowest = min(record.scores(), default=inf)

    def keep(run: Run, score: float) -> None:
        nonlocal lowest
        checkpoint = run.checkpoint(settings)
        save(folder / LATEST, checkpoint)
        if score <= lowest:
            save(folder / BEST, checkpoint)
            lowest = score

    train(run, experiment.loop, experiment.terms, sources, record, keep)


def _begun(experiment: Experiment, latest: Path) -> Run:
    """Return the run that the latest checkpoint holds, or a new one where there is none."""
    torch.manual_seed(experiment.seed)
    network = experiment.network.build().to(memory_format=torch.channels_last)
    if latest.exists():
        found = load(latest)
        if CODEC.restored(Experiment, found.settings, str(latest)) != experiment:
            raise InputError(f"{latest}: belongs to a run of other settings; take another folder")
        run = Run.started(network, experiment.loop)
        run.resume(found, str(latest))
        return run
    match experiment.start:
        case ImageNet(file):
            load_imagenet(network.encoder, file)
        case Trained(checkpoint):
            restore(network, load(checkpoint).part("average"), str(checkpoint))
    return Run.started(network, experiment.loop)
