"""What a run says of itself: a line on the screen now and then, and every number in a file."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic

from torch import Tensor

SHOWN_EVERY = 50


@dataclass(eq=False)
class Record:
    """The log of a run, one JSON object a line; a resumed run adds to it.

    Attributes:
        path: The log file.
        iterations: How many the whole run has, for the time left.
        show: Takes the lines meant for people.
    """

    path: Path
    iterations: int
    show: Callable[[str], None]
    _recent: list[dict[str, float]] = field(default_factory=list)
    _since: float = field(default_factory=monotonic)

    def iteration(self, number: int, parts: Mapping[str, Tensor]) -> None:
        """Note the terms of one iteration."""
        self._recent.append({name: float(value) for name, value in parts.items()})
        if number % SHOWN_EVERY:
            return
        count = len(self._recent)
        means = {name: sum(r[name] for r in self._recent) / count for name in self._recent[0]}
        seconds = (monotonic() - self._since) / count
        self._write({"iteration": number, "seconds": round(seconds, 3), **means})
        left = (self.iterations - number) * seconds / 60
        terms = "  ".join(f"{name} {value:.4f}" for name, value in means.items())
        self.show(f"{number}/{self.iterations}  {terms}  {seconds:.2f} s/it, {left:.0f} min left")
        self._recent, self._since = [], monotonic()

    def score(self, number: int, score: float) -> None:
        """Note the score of a validation."""
        self._write({"iteration": number, "held_out_abs_rel": score})
        self.show(f"{number}/{self.iterations}  held-out AbsRel {score:.4f}")
        self._since = monotonic()

    def scores(self) -> list[float]:
        """Return the scores of all validations so far, those of an interrupted run too."""
        if not self.path.exists():
            return []
        entries = map(json.loads, self.path.read_text(encoding="utf-8").splitlines())
        return [entry["held_out_abs_rel"] for entry in entries if "held_out_abs_rel" in entry]

    def _write(self, entry: Mapping[str, int | float]) -> None:
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(entry) + "\n")
