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

_PAGE = """\
usage: flexdepth train EXPERIMENT [--field value ...]

Train a network, or go on with a run that was interrupted.

experiments:
{experiments}
  or a .yaml file: `like: compact`, and what differs from it

flexdepth train EXPERIMENT --help lists its fields; flexdepth show experiment EXPERIMENT prints all
of it as YAML, to begin a file with. docs/chapter3.md says more.
"""


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
    name, *rest = arguments or [""]
    if name in ("-h", "--help"):
        sys.stdout.write(_page())
        return 0
    if not name or name.startswith("-"):
        raise InputError(f"name an experiment first, of {sorted(CATALOGUE)}, or a .yaml file")
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


def _page() -> str:
    return _PAGE.format(experiments="\n".join(f"  {name}" for name in CATALOGUE))


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
