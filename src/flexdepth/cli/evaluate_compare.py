"""`flexdepth evaluate compare RESULT RESULT`: whether two results on the same images differ."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.cli.scores import comparison
from flexdepth.evaluation.report import check_comparable, read_report
from flexdepth.evaluation.summary import differences


@dataclass(frozen=True)
class Compare:
    """Compare two results of one protocol on one set: a paired test over the images.

    p is the probability that a mean difference as large comes about where none is; it takes each
    image for independent of the others, which frames of one video are not.
    """

    first: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="A", help_behavior_hint="")]
    """A folder with result.json, as `flexdepth evaluate` wrote it."""
    second: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="B", help_behavior_hint="")]
    """Another."""


def run(arguments: Sequence[str]) -> int:
    """Compare the results that `arguments` name."""
    command = "flexdepth evaluate compare"
    with told_in_one_line(command):
        settings = tyro.cli(Compare, args=arguments, prog=command)
    first, second = read_report(settings.first), read_report(settings.second)
    check_comparable(first, second)
    found = differences(first.images, second.images)
    sys.stdout.write(comparison(found, (str(settings.first), str(settings.second))))
    only = len(first.images.keys() ^ second.images.keys())
    if only:
        sys.stdout.write(f"note: {only} images have a score in one of them alone: not compared\n")
    return 0
