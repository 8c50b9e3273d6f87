"""`flexdepth average CHECKPOINT... -o CHECKPOINT`: one network of several that are kin."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.data import Folder
from flexdepth.experiments.average import averaged
from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class Average:
    """Write the mean of the weights of several checkpoints of one network.

    They must stem from one another, or from the same third: the mean of strangers knows nothing.
    The statistics of its normalisations are estimated anew.
    """

    checkpoints: Annotated[
        tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="CHECKPOINT...")
    ]
    """The .safetensors files that `flexdepth train` wrote."""
    output: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="FILE")]
    """The .safetensors file to write, for `train --start` and `export`."""
    shares: Annotated[tuple[float, ...], tyro.conf.arg(metavar="FLOAT...")] = ()
    """Of each checkpoint, in their order; without it they share alike."""
    data: Annotated[Path, tyro.conf.arg(metavar="DIR")] = Path("renders/train")
    """Images to estimate the statistics on, changed in colour and shape as in training."""
    batches: Annotated[int, tyro.conf.arg(metavar="N")] = 40
    """How many batches of them."""


def run(arguments: Sequence[str]) -> int:
    """Average the checkpoints that `arguments` name."""
    with told_in_one_line("flexdepth average"):
        settings = tyro.cli(Average, args=arguments, prog="flexdepth average")
    if not settings.checkpoints:
        raise InputError(
            "name at least one checkpoint: flexdepth average a.safetensors -o b.safetensors"
        )
    shares = settings.shares or (1.0,) * len(settings.checkpoints)
    pairs = Folder(settings.data).load()
    averaged(settings.checkpoints, shares, pairs, settings.batches, settings.output)
    sys.stdout.write(f"{settings.output}: the mean of {len(settings.checkpoints)}\n")
    return 0
