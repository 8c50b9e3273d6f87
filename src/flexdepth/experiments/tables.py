"""The tables of chapter 3 as loops over named experiments.

A row is an experiment with some changes; each is trained once for each seed in a folder of its
own, `ROW-seedN`. What a run comes to is the moving average of its last evaluations, as in the
dissertation. Run again, a table goes on where it was interrupted.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import fsum
from pathlib import Path

from flexdepth.experiments.ablations import changed, seeded
from flexdepth.experiments.experiment import CODEC, Experiment
from flexdepth.experiments.published_tables import Row, Table
from flexdepth.experiments.run import LATEST, LOG, difference, run_experiment
from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.errors import InputError
from flexdepth.training.checkpoint import progress
from flexdepth.training.objective import DivergedError
from flexdepth.training.record import validations

AVERAGED = 15
"""Evaluations at the end of a run that its scores are the mean of (caption of Table 3.4)."""

_DIVERGED = "diverged.json"
"""In the folder of a run whose objective ceased to be finite: its settings, and what it said."""


@dataclass(frozen=True)
class Plan:
    """A table to be made.

    Attributes:
        table: Its rows.
        experiment: What the rows are changes of: its data and its budget.
        seeds: How often each row is trained.
    """

    table: Table
    experiment: Experiment
    seeds: int

    def __post_init__(self) -> None:
        """Refuse a table of nothing.

        Raises:
            InputError: There is no seed, or a row does not suit the experiment.
        """
        if self.seeds < 1:
            raise InputError(f"a table needs at least 1 seed, got {self.seeds}")
        list(self.runs())

    def runs(self) -> Iterator["Planned"]:
        """Give the runs: every row with one seed before any with the next."""
        for seed in range(self.seeds):
            for row in self.table.rows:
                varied = changed(self.experiment, (*row.changes, seeded(seed)))
                yield Planned(row, seed, varied)

    @property
    def evaluations(self) -> int:
        """How many evaluations a run has."""
        loop = self.experiment.loop
        return -(-loop.iterations // loop.save_every)


@dataclass(frozen=True)
class Planned:
    """One of the runs of a table."""

    row: Row
    seed: int
    experiment: Experiment

    @property
    def name(self) -> str:
        """What its folder is called."""
        return f"{self.row.name}-seed{self.seed}"


@dataclass(frozen=True)
class Outcome:
    """What one run came to.

    Attributes:
        row: The row's name.
        seed: The number of the repetition.
        scores: By metric; None where the objective ceased to be finite.
    """

    row: str
    seed: int
    scores: Mapping[str, float] | None


def run_table(
    plan: Plan, folder: Path, processes: int, show: Callable[[str], None]
) -> list[Outcome]:
    """Train what has not been trained yet, and return what all runs came to.

    Args:
        plan: What to train.
        folder: Holds a folder for each run.
        processes: That load images, in each run.
        show: Takes the lines meant for people.

    Raises:
        InputError: The data cannot be read, or a run in the folder is of other settings.
    """
    runs = list(plan.runs())
    left = [run for run in runs if not _finished(run, folder / run.name)]
    show(f"{len(runs)} runs, {len(runs) - len(left)} of them finished before")
    for number, run in enumerate(left, 1):
        show(f"run {number} of {len(left)}: {run.name}")
        try:
            run_experiment(run.experiment, folder / run.name, processes, show)
        except DivergedError as said:
            show(f"{run.name}: {said}")
            _note(folder / run.name, run.experiment, str(said))
    return [Outcome(run.row.name, run.seed, _scores(folder / run.name)) for run in runs]


def smoothed(scores: Sequence[Mapping[str, float]]) -> Mapping[str, float]:
    """Return the mean of the last `AVERAGED` evaluations, or of all where there are fewer."""
    last = scores[-AVERAGED:]
    return {name: fsum(each[name] for each in last) / len(last) for name in last[-1]}


def _scores(folder: Path) -> Mapping[str, float] | None:
    return None if (folder / _DIVERGED).exists() else smoothed(validations(folder / LOG))


def _finished(run: Planned, folder: Path) -> bool:
    """Return whether a folder holds the run's end.

    Raises:
        InputError: It holds another run.
    """
    latest, diverged = folder / LATEST, folder / _DIVERGED
    if diverged.exists():
        settings, done = json.loads(diverged.read_text(encoding="utf-8"))["settings"], True
    elif latest.exists():
        iteration, settings = progress(latest)
        done = iteration >= run.experiment.loop.iterations
    else:
        return False
    found = CODEC.restored(Experiment, settings, str(folder))
    if found != run.experiment:
        raise InputError(
            f"{folder}: is a run of other settings; choose another --output-dir "
            f"({difference(found, run.experiment)})"
        )
    return done


def _note(folder: Path, experiment: Experiment, said: str) -> None:
    words = {"said": said, "settings": CODEC.plain(experiment)}
    with replacing(folder / _DIVERGED) as temporary:
        temporary.write_text(json.dumps(words), encoding="utf-8")
