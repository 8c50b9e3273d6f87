"""A check-up of a data set: what is wrong with it, as far as pictures and depth tell.

A sample of the pairs, evenly spread over the set, is looked at, one pair at a time; a file that
cannot be read is named and the rest goes on.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from flexdepth.data.contact_sheet import Pixels, sheet
from flexdepth.data.examination import Look, Predict, examined
from flexdepth.data.folder import Pair
from flexdepth.data.verdicts import Finding, Verdict, verdicts
from flexdepth.runtime.errors import InputError

_SHOWN = 8


@runtime_checkable
class Things(Protocol):
    """What a set's `load()` gives: things by number."""

    def __len__(self) -> int:
        """Return how many there are."""
        ...

    def __getitem__(self, index: int) -> object:
        """Return one."""
        ...


@dataclass(frozen=True)
class Checkup:
    """What was found.

    Attributes:
        total: Pairs in the set.
        looked_at: Pairs that were looked at.
        findings: One for each check.
        shown: Numbers of pairs to look at: those that show something first.
    """

    total: int
    looked_at: int
    findings: tuple[Finding, ...]
    shown: tuple[int, ...]

    @property
    def found(self) -> tuple[Finding, ...]:
        """The findings that found something."""
        return tuple(each for each in self.findings if each.verdict is Verdict.FOUND)


def checkup(
    pairs: Things, predict: Predict, most: int, watch: Callable[[int], None] = lambda _done: None
) -> Checkup:
    """Look at up to `most` pairs and say what is wrong.

    Args:
        pairs: What the set's `load()` gave.
        predict: A metric model, which near, far and scale are compared with.
        most: How many pairs are looked at.
        watch: Is told how many are done.

    Raises:
        InputError: The set holds something else than images with depth, or no pair can be read.
    """
    looks: dict[int, Look] = {}
    broken: dict[int, str] = {}
    for done, number in enumerate(spread_out(len(pairs), most), 1):
        try:
            looks[number] = examined(as_pair(pairs[number]), predict)
        except InputError as error:
            broken[number] = str(error)
        watch(done)
    if not looks:
        raise InputError(f"no pair can be read: {next(iter(broken.values()), 'the set is empty')}")
    findings = (_unreadable(broken, len(looks)), *verdicts(tuple(looks.values())))
    named = {name for each in findings if each.verdict is Verdict.FOUND for name in each.images}
    first = sorted(looks, key=lambda number: looks[number].name not in named)
    chosen = first if named else [first[n] for n in spread_out(len(first), _SHOWN)]
    return Checkup(len(pairs), len(looks), findings, tuple(sorted(chosen[:_SHOWN])))


def contact_sheet(pairs: Things, numbers: Iterable[int]) -> Pixels:
    """Return pairs below one another: picture, edges of depth on it, depth."""
    return sheet([as_pair(pairs[number]) for number in numbers])


def as_pair(thing: object) -> Pair:
    """Return what a set holds, if it is an image with depth.

    Raises:
        InputError: It is something else.
    """
    if not isinstance(thing, Pair):
        raise InputError(
            f"this set holds {type(thing).__name__} and no images with depth maps; choose another"
        )
    return thing


def spread_out(total: int, most: int) -> list[int]:
    """Return up to `most` numbers below `total`, evenly spread, with the first and the last."""
    return sorted({int(each) for each in np.linspace(0, total - 1, min(total, most)).round()})


def _unreadable(broken: dict[int, str], read: int) -> Finding:
    if broken:
        text = f"{len(broken)} pairs cannot be read; {next(iter(broken.values()))}"
        return Finding("files", Verdict.FOUND, text)
    return Finding("files", Verdict.FINE, f"{read} pairs can be read")
