"""`flexdepth train EXPERIMENT`: train a network, or go on where a run stopped."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.cli.weights import start_of
from flexdepth.experiments.catalogue import CATALOGUE, experiment_named
from flexdepth.experiments.experiment import Experiment, ImageNet, Labels
from flexdepth.experiments.held_out import with_own_held_out
from flexdepth.experiments.run import run_experiment
from flexdepth.runtime.errors import InputError
from flexdepth.training.memory import keep_freed_memory
from flexdepth.training.semi_supervised import Agreement

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
    unlabelled: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """A folder of photos without depth, to learn from as well: a trained model labels them, where
    it is sure, before the training begins."""
    teacher: Annotated[str, tyro.conf.arg(metavar="WEIGHTS")] = "bundled"
    """With --unlabelled, the model that labels: `bundled`, a bundle or a checkpoint."""
    agreement: Annotated[float, tyro.conf.arg(metavar="X")] = Agreement.ratio
    """With --unlabelled, the largest factor between the depths of two looks of a teacher that is
    sure."""
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
    if not any(word.replace("_", "-").startswith("--held-out") for word in rest):
        experiment = with_own_held_out(named, experiment)
    if settings.encoder_weights is not None:
        experiment = replace(experiment, start=ImageNet(settings.encoder_weights))
    if settings.start is not None:
        experiment = replace(experiment, start=start_of(settings.start, "--start"))
    if settings.unlabelled is not None:
        teacher = start_of(settings.teacher, "--teacher")
        labels = Labels(settings.unlabelled, teacher, Agreement(settings.agreement))
        experiment = replace(experiment, labels=labels)
    keep_freed_memory()
    run_experiment(experiment, settings.output_dir, settings.processes, _say)
    return 0


def _page() -> str:
    return _PAGE.format(experiments="\n".join(f"  {name}" for name in CATALOGUE))


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()
