"""`flexdepth synth -o DIR`: rendered images with exact depth, to train on."""

import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from os import cpu_count
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from flexdepth.runtime.errors import InputError
from flexdepth.synth.generate import SynthSettings, write_images


@dataclass(frozen=True)
class Synth:
    """Render rooms and streets with exact depth: DIR/image/NNNNNN.jpg and DIR/depth/NNNNNN.npz.

    The same seed and number give the same image everywhere; an interrupted run goes on.
    """

    output_dir: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="DIR")]
    """Where the images go."""
    count: Annotated[int, tyro.conf.arg(aliases=("-n",), metavar="N")] = 1000
    """How many images."""
    world: Annotated[SynthSettings, tyro.conf.arg(name="")] = field(default_factory=SynthSettings)
    """What is rendered."""
    processes: Annotated[int, tyro.conf.arg(metavar="N", help_behavior_hint="")] = 0
    """Processes that render; 0 takes one for each core."""


def run(arguments: Sequence[str]) -> int:
    """Render the images that `arguments` ask for."""
    settings = tyro.cli(Synth, args=arguments, prog="flexdepth synth")
    if settings.count < 1 or settings.processes < 0:
        raise InputError("--count is a whole number >= 1 and --processes one >= 0")
    processes = settings.processes or cpu_count() or 1
    begin = time.monotonic()
    console = Console(stderr=True)
    columns = (TextColumn("rendering"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task("rendering", total=settings.count)
        for done in write_images(settings.world, settings.count, settings.output_dir, processes):
            bar.update(task, completed=done)
    seconds = time.monotonic() - begin
    sys.stdout.write(f"{settings.output_dir}: {settings.count} images in {seconds:.0f} s\n")
    return 0
