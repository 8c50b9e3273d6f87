"""`flexdepth synth -o DIR`: rendered images with exact depth, to train on."""

import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from os import cpu_count
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.cli.progress import counted
from flexdepth.runtime.errors import InputError
from flexdepth.synth.generate import SynthSettings, write_images
from flexdepth.synth.motion import Motion
from flexdepth.synth.sequence import SequenceSettings
from flexdepth.synth.sequence_files import write_sequences
from flexdepth.synth.sheet import write_image_sheet, write_sequence_sheet

_LINES = 10
"""How many lines a rendering has where there is no terminal to draw a bar on."""


@dataclass(frozen=True)
class Synth:
    """Render scenes with exact depth: DIR/image/NNNNNN.jpg and DIR/depth/NNNNNN.npz.

    Rooms of many kinds, streets, parks, squares, open land and things from near (docs/synth.md).
    With --frames 2 or more, sequences: DIR/NNNNNN with frames, depth, poses, flow and what moves.
    The same seed and number give the same bytes everywhere; an interrupted run goes on. In the
    end DIR/sheet.png shows some of it.
    """

    output_dir: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="DIR")]
    """Where the images go."""
    count: Annotated[int, tyro.conf.arg(aliases=("-n",), metavar="N")] = 1000
    """How many images, or sequences."""
    world: Annotated[SynthSettings, tyro.conf.arg(name="")] = field(default_factory=SynthSettings)
    """What is rendered."""
    motion: Annotated[Motion, tyro.conf.arg(name="")] = field(default_factory=Motion)
    """What moves in sequences."""
    processes: Annotated[int, tyro.conf.arg(metavar="N", help_behavior_hint="")] = 0
    """Processes that render; 0 takes one for each core."""


def run(arguments: Sequence[str]) -> int:
    """Render the images that `arguments` ask for."""
    with told_in_one_line("flexdepth synth"):
        settings = tyro.cli(Synth, args=arguments, prog="flexdepth synth")
    if settings.count < 1 or settings.processes < 0:
        raise InputError("--count is a whole number >= 1 and --processes one >= 0")
    if settings.motion.frames == 1 and settings.motion != Motion():
        raise InputError("what moves is asked for, but a single image shows none; give --frames 2")
    shown = settings.world.photographs
    if shown is not None and settings.output_dir.resolve().is_relative_to(shown.resolve()):
        raise InputError(
            f"--output-dir: {settings.output_dir} lies in {shown}, and renders are no photographs; "
            f"take another folder"
        )
    processes = settings.processes or cpu_count() or 1
    begin = time.monotonic()
    watched = _in_a_bar if Console(stderr=True).is_terminal else _in_lines
    watched(_written(settings, processes), settings.count)
    single = settings.motion.frames == 1
    sheet = (write_image_sheet if single else write_sequence_sheet)(
        settings.output_dir, settings.count
    )
    seconds = time.monotonic() - begin
    what = "images" if single else f"sequences of {settings.motion.frames} frames"
    sys.stdout.write(
        f"{settings.output_dir}: {settings.count} {what} in {seconds:.0f} s; see {sheet}\n"
    )
    return 0


def _in_a_bar(written: Iterator[int], count: int) -> None:
    """Let all be written, and show in a bar how much is done."""
    with counted("rendering", count) as watch:
        for done in written:
            watch(done)


def _in_lines(written: Iterator[int], count: int) -> None:
    """Let all be written, and say now and then how much is done, where a log is kept."""
    begin, said = time.monotonic(), 0
    for done in written:
        if done * _LINES // count > said:
            said = done * _LINES // count
            seconds = time.monotonic() - begin
            sys.stderr.write(f"rendered {done} of {count} in {seconds:.0f} s\n")
            sys.stderr.flush()


def _written(settings: Synth, processes: int) -> Iterator[int]:
    """Write what is asked for, and yield how much is done."""
    if settings.motion.frames == 1:
        return write_images(settings.world, settings.count, settings.output_dir, processes)
    wanted = SequenceSettings(settings.world, settings.motion)
    return write_sequences(wanted, settings.count, settings.output_dir, processes)
