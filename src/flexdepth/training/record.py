"""What a run says of itself: a line on the screen now and then, a log, curves and pictures."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import Any, Protocol, runtime_checkable

from torch import Tensor

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.colour import Pixels
from flexdepth.runtime.errors import InputError
from flexdepth.training.curves import Curves

LOGGED_EVERY = 50
"""Iterations; the terms are their mean over so many."""

SILENCE = 60.0
"""Seconds after which a line is due before that, where iterations are slow."""

HELD_OUT = "held_out_"
"""What the scores of a validation are called by in the log, before the names of their metrics."""

_SCORE = f"{HELD_OUT}abs_rel"


@runtime_checkable
class Listener(Protocol):
    """What the loop tells how it goes."""

    def iteration(self, number: int, rate: float, parts: Mapping[str, Tensor]) -> None:
        """Hear the learning rate and the terms of one iteration."""
        ...

    def scores(self, number: int, scores: Mapping[str, float]) -> None:
        """Hear the scores of a validation, by the names of their metrics."""
        ...


class Silence:
    """The listener of processes that do not speak."""

    def iteration(self, number: int, rate: float, parts: Mapping[str, Tensor]) -> None:
        """Do nothing."""

    def scores(self, number: int, scores: Mapping[str, float]) -> None:
        """Do nothing."""


@dataclass(eq=False)
class Record:
    """The log of a run, one JSON object a line, with its curves; a resumed run adds to it.

    Attributes:
        path: The log file.
        iterations: How many the whole run has, for the time left.
        show: Takes the lines meant for people.
        curves: Draws what is logged.
        every: Iterations between two lines, fewer where they take longer than `SILENCE`.
    """

    path: Path
    iterations: int
    show: Callable[[str], None]
    curves: Curves
    every: int = LOGGED_EVERY
    _recent: list[Mapping[str, Tensor]] = field(default_factory=list)
    _told: float = field(default_factory=monotonic)
    _spent: float = 0.0
    _done: int = 0

    def iteration(self, number: int, rate: float, parts: Mapping[str, Tensor]) -> None:
        """Note one iteration; its numbers are not looked at before a line is due."""
        self._recent.append(parts)
        now = monotonic()
        due = number % self.every == 0 or number == self.iterations
        if not due and now - self._told < SILENCE:
            return
        count = len(self._recent)
        means = {name: sum(float(r[name]) for r in self._recent) / count for name in parts}
        seconds, self._told = (now - self._told) / count, now
        self._spent, self._done = self._spent + seconds * count, self._done + count
        self._write({"iteration": number, "seconds": round(seconds, 3), "rate": rate, **means})
        self.curves.draw(number, {"rate": rate, **{f"term/{k}": v for k, v in means.items()}})
        left = (self.iterations - number) * self._spent / self._done
        terms = "  ".join(f"{name} {value:.4f}" for name, value in means.items())
        self.show(f"{number}/{self.iterations}  {terms}  {seconds:.2f} s/it, {span(left)} left")
        self._recent = []

    def scores(self, number: int, scores: Mapping[str, float]) -> None:
        """Note the scores of a validation, AbsRel among them."""
        named = {f"{HELD_OUT}{name}": value for name, value in scores.items()}
        self._write({"iteration": number, **named})
        self.curves.draw(number, named)
        self.show(f"{number}/{self.iterations}  held-out AbsRel {named[_SCORE]:.4f}")

    def pictures(self, number: int, named: Mapping[str, Pixels]) -> None:
        """Note what the network makes of some images."""
        self.curves.paint(number, named)

    def _write(self, entry: Mapping[str, int | float]) -> None:
        try:
            with self.path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(entry) + "\n")
        except OSError as error:
            raise InputError(f"{self.path}: cannot be written: {error.strerror}") from error


def span(seconds: float) -> str:
    """Return a time as people say it: `40 s`, `12 min`, `3 h 05 min`."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60:02d} min"


def taken_up(path: Path, iteration: int) -> list[float]:
    """Cut a log back to an iteration, from which its run goes on, and return the scores in it.

    What an interrupted run did after its last checkpoint will be done and logged again. A line
    that was cut short is dropped.
    """
    if not path.exists():
        return []
    kept = [entry for entry in _entries(path) if entry["iteration"] <= iteration]
    with replacing(path) as temporary:
        lines = (json.dumps(entry) + "\n" for entry in kept)
        temporary.write_text("".join(lines), encoding="utf-8")
    return [float(entry[_SCORE]) for entry in kept if _SCORE in entry]


def validations(path: Path) -> list[Mapping[str, float]]:
    """Return the scores of every validation in a log, in order, by the names of their metrics."""
    return [
        {k.removeprefix(HELD_OUT): float(v) for k, v in entry.items() if k.startswith(HELD_OUT)}
        for entry in _entries(path)
        if _SCORE in entry
    ]


def _entries(path: Path) -> list[dict[str, Any]]:
    entries = []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            entries.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return entries
