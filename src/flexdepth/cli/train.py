"""`flexdepth train EXPERIMENT`: train a network, or go on where a run stopped."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.experiments.catalogue import CATALOGUE, experiment_named
from flexdepth.experiments.experiment import Bundled, Experiment, ImageNet, Start, Trained
from flexdepth.experiments.run import run_experiment
from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class Train:
    """Train a named experiment; any field of it can be set to another value.

    The run's folder gets `latest.safetensors`, `best.safetensors` (the lowest error on the held
    out pairs) and `log.jsonl`. Started again with the same settings, a run goes on.
    """

    experiment: Annotated[Experiment, tyro.conf.arg(name="")]
    """What is trained, on what and how."""
    output_dir: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="DIR")] = Path("runs")
    """The run's folder."""
    processes: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """Processes that read and augment images while the network computes."""
    start: Annotated[str | None, tyro.conf.arg(metavar="WEIGHTS")] = None
    """Weights to begin with: `bundled` (the model that comes with flexdepth), `imagenet` (the
    encoder alone), a bundle (.onnx) or a checkpoint (.safetensors) of the same network."""
    encoder_weights: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """ImageNet weights of the encoder under timm's names, .safetensors or .pth."""


def run(arguments: Sequence[str]) -> int:
    """Train the experiment that the first argument names."""
    if not arguments or arguments[0].startswith("-"):
        arguments = ("compact", *arguments) if "--help" in arguments or "-h" in arguments else ()
    if not arguments:
        raise InputError(f"name an experiment: flexdepth train {next(iter(CATALOGUE))}")
    name, *rest = arguments
    named = experiment_named(name)
    with told_in_one_line(f"flexdepth train {name}"):
        settings = tyro.cli(
            Train,
            args=rest,
            prog=f"flexdepth train {name}",
            default=Train(named, Path("runs") / Path(name).stem),
            config=(tyro.conf.AvoidSubcommands,),
        )
    experiment = settings.experiment
    if settings.encoder_weights is not None:
        experiment = replace(experiment, start=ImageNet(settings.encoder_weights))
    if settings.start is not None:
        experiment = replace(experiment, start=_start(settings.start))
    run_experiment(experiment, settings.output_dir, settings.processes, _say)
    return 0


def _start(weights: str) -> Start:
    match weights, Path(weights).suffix:
        case "bundled", _:
            return Bundled()
        case "imagenet", _:
            return ImageNet()
        case _, ".onnx":
            return Bundled(Path(weights))
        case _, ".safetensors":
            return Trained(Path(weights))
    raise InputError(
        f"--start: wanted bundled, imagenet, a .onnx bundle or a .safetensors checkpoint, "
        f"got {weights!r}"
    )


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()
