"""Running an experiment in a folder: start or resume, log, checkpoints."""

import copy
import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import torch
from torch import nn

from flexdepth.data import Folder
from flexdepth.experiments.experiment import (
    CODEC,
    Bundled,
    Experiment,
    Labels,
    Start,
    Trained,
)
from flexdepth.experiments.start import give_basis, give_weights
from flexdepth.networks import Built, Compact, Network
from flexdepth.runtime.atomic import check_writable, discard_unfinished, replacing
from flexdepth.runtime.errors import InputError
from flexdepth.training.batches import Pairs
from flexdepth.training.checkpoint import load, restore, save, source
from flexdepth.training.curves import Curves
from flexdepth.training.loop import (
    LoopSettings,
    Run,
    Sources,
    check_shares,
    out_of_patience,
    train,
)
from flexdepth.training.memory import memory_told
from flexdepth.training.processes import Place, joined
from flexdepth.training.record import Record, Silence, taken_up
from flexdepth.training.semi_supervised import Joined, unlabelled_photos, write_labels
from flexdepth.training.validation import pictures

LATEST, BEST, LOG, LABELS = "latest.safetensors", "best.safetensors", "log.jsonl", "labels"
"""Files in a run's folder; the best has the lowest held-out error of the averaged weights."""


@dataclass(frozen=True)
class _Stored:
    """The settings that a checkpoint's network is built from."""

    network: Network


def trained_network(path: Path) -> Built:
    """Return the averaged network in a checkpoint, ready to predict.

    Raises:
        InputError: The file is no checkpoint, or of a network that this version does not know.
    """
    checkpoint = load(path)
    named = {"network": checkpoint.settings.get("network")}
    network = CODEC.restored(_Stored, named, str(path)).network.build()
    restore(network, checkpoint.part("average"), str(path))
    return network.eval()


def network_with(start: Start) -> Built:
    """Return a trained network, ready to predict.

    Args:
        start: A checkpoint, or a bundle of the network `Compact`.

    Raises:
        InputError: The file cannot be read, or there is nothing trained.
    """
    match start:
        case Trained(checkpoint):
            return trained_network(checkpoint)
        case Bundled():
            network = Compact().build()
            give_weights(network, start)
            return network.eval()
    raise InputError(
        "a trained network was wanted: bundled, a .onnx bundle or a .safetensors checkpoint"
    )


def run_experiment(
    experiment: Experiment, folder: Path, processes: int, show: Callable[[str], None]
) -> None:
    """Train, or go on training, in a folder; under torchrun, together with other processes.

    Raises:
        InputError: The data or the weights to start from cannot be read, the folder holds a run
            of other settings, or memory is short.
    """
    with joined() as place, memory_told(experiment.loop):
        measured, held_out = experiment.data.load(), experiment.held_out.load()
        labels = experiment.labels
        training = measured if labels is None else _joined(measured, labels, folder, place, show)
        sources = Sources(training, held_out, processes)
        check_shares(experiment.loop, place)
        run = _begun(experiment, folder / LATEST, place, sources.training, show)
        _check_shapes(run.network, experiment)
        if place.first:
            _train_in(folder, experiment, run, sources, show)
        else:
            train(run, experiment.loop, experiment.terms, sources, Silence(), lambda *_: None)


def _joined(
    measured: Pairs, labels: Labels, folder: Path, place: Place, show: Callable[[str], None]
) -> Pairs:
    """Return the measured pairs and the photos that the teacher has labelled, once for a run."""
    made = folder / LABELS
    settings, said = made / "labels.json", json.dumps(CODEC.plain(labels))
    photos = unlabelled_photos(labels.photos)
    if settings.exists() and settings.read_text(encoding="utf-8") != said:
        raise InputError(
            f"{made}: holds labels of other photos or by another teacher; choose another "
            f"--output-dir"
        )
    if place.first and not settings.exists():
        check_writable(folder)
        show(f"labelling {len(photos)} photos of {labels.photos}")
        write_labels(network_with(labels.teacher), photos, made, labels.agreement, show)
        with replacing(settings) as temporary:
            temporary.write_text(said, encoding="utf-8")
    # The others wait until the first has written all.
    place.summed([0.0])
    return Joined(measured, Folder(made).load())


def _train_in(
    folder: Path, experiment: Experiment, run: Run, sources: Sources, show: Callable[[str], None]
) -> None:
    """Train, and leave log, curves and checkpoints in a folder."""
    check_writable(folder)
    if _lost_patience(run, experiment.loop):
        show(_ended(run, experiment.loop))
        return
    show(
        f"{'resuming' if run.iteration else 'starting'} at iteration {run.iteration} of "
        f"{experiment.loop.iterations} with {len(sources.training)} images, "
        f"{len(sources.held_out)} held out, on {run.place.count} x {run.place.device}"
    )
    folder.mkdir(parents=True, exist_ok=True)
    discard_unfinished(folder)
    log = folder / LOG
    lowest = min(taken_up(log, run.iteration), default=inf)
    curves = Curves(folder / "tensorboard", run.iteration, show)
    record = Record(log, experiment.loop.iterations, show, curves)
    settings, code = CODEC.plain(experiment), source()

    def keep(run: Run, score: float) -> None:
        nonlocal lowest
        record.pictures(run.iteration, pictures(run.average, sources.held_out, run.place))
        checkpoint = run.checkpoint(settings, code)
        # The best first: a run that is killed between the two does both again.
        if score <= lowest:
            save(folder / BEST, checkpoint)
            lowest = score
        save(folder / LATEST, checkpoint)

    train(run, experiment.loop, experiment.terms, sources, record, keep)
    if _lost_patience(run, experiment.loop):
        show(_ended(run, experiment.loop))


def _lost_patience(run: Run, loop: LoopSettings) -> bool:
    return run.iteration < loop.iterations and out_of_patience(run.errors, loop.patience)


def _ended(run: Run, loop: LoopSettings) -> str:
    return (
        f"ended early, at iteration {run.iteration} of {loop.iterations}: loop.patience is "
        f"{loop.patience}, and so many validations in a row did not lower the held-out AbsRel, "
        f"{min(run.errors):.4f} at best; with more patience or iterations it goes on"
    )


def _begun(
    experiment: Experiment, latest: Path, place: Place, pairs: Pairs, show: Callable[[str], None]
) -> Run:
    """Return the run that the latest checkpoint holds, or a new one where there is none."""
    torch.manual_seed(experiment.seed)
    network = experiment.network.build().to(memory_format=torch.channels_last)
    if not latest.exists():
        give_weights(network, experiment.start)
        found = give_basis(network, pairs)
        if found and place.first:
            show(found)
        return Run.started(network, experiment.loop, place)
    stored = load(latest)
    theirs = CODEC.restored(Experiment, stored.settings, str(latest))
    same = replace(theirs, loop=experiment.loop) == experiment
    if not (same and theirs.loop.goes_on_with(experiment.loop, stored.errors)):
        as_patient = replace(theirs.loop, patience=experiment.loop.patience)
        raise InputError(
            f"{latest}: belongs to a run of other settings; take another folder "
            f"({difference(replace(theirs, loop=as_patient), experiment)})"
        )
    run = Run.started(network, experiment.loop, place)
    run.resume(stored, str(latest))
    if experiment.loop.iterations > theirs.loop.iterations:
        run.errors.clear()  # What is asked for is more of it: its patience counts anew.
    return run


def _check_shapes(network: nn.Module, experiment: Experiment) -> None:
    """Refuse batches that the network does not take, by shapes alone, without computing.

    Raises:
        InputError: A side is not what the network can halve.
    """
    outline = copy.deepcopy(network).to("meta").eval()
    for width, height in experiment.loop.batches.shapes:
        if not _takes(outline, width, height):
            raise InputError(
                f"loop.batches.shapes: {type(experiment.network).__name__} does not take images of "
                f"{width}x{height}; multiples of 32 suit every network"
            )


def _takes(outline: nn.Module, width: int, height: int) -> bool:
    """Return whether a network without memory makes depth of the size of its image."""
    try:
        depth = outline(torch.empty(1, 3, height, width, device="meta")).depth
    except RuntimeError:
        return False
    return bool(depth.shape[-2:] == (height, width))


def difference(theirs: Experiment, ours: Experiment) -> str:
    """Return where two experiments first differ: `loop.seed: 1 there, 2 here`."""
    return _difference(CODEC.plain(theirs), CODEC.plain(ours))


def _difference(theirs: object, ours: object, name: str = "") -> str:
    """Return where two settings as plain values first differ."""
    if isinstance(theirs, dict) and isinstance(ours, dict):
        kinds = theirs.get("_type"), ours.get("_type")
        if kinds[0] == kinds[1]:
            key = next(key for key in {**theirs, **ours} if theirs.get(key) != ours.get(key))
            return _difference(theirs.get(key), ours.get(key), f"{name}.{key}".removeprefix("."))
        theirs, ours = kinds
    return f"{name}: {theirs} there, {ours} here"
