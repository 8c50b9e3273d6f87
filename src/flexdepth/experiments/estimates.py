"""Mean and spread over seeds of what the runs of a table came to."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan
from typing import TypeAlias

import numpy as np

from flexdepth.experiments.published_tables import Table
from flexdepth.experiments.tables import Outcome


@dataclass(frozen=True)
class Estimate:
    """A mean over seeds.

    Attributes:
        mean: NaN where there was nothing to average.
        spread: The sample standard deviation over seeds; NaN for fewer than two.
        count: Seeds that have a number.
    """

    mean: float
    spread: float
    count: int

    @classmethod
    def of(cls, values: Sequence[float]) -> "Estimate":
        """Return mean and spread of some values."""
        count = len(values)
        mean = float(np.mean(values)) if count else nan
        return cls(mean, float(np.std(values, ddof=1)) if count > 1 else nan, count)

    @property
    def stands_out(self) -> bool:
        """Whether a difference is larger than its spread."""
        return self.count > 1 and abs(self.mean) > self.spread


Estimates: TypeAlias = Mapping[str, Mapping[str, Estimate]]
"""By row and metric."""


def measured(table: Table, outcomes: Sequence[Outcome]) -> Estimates:
    """Return mean and spread over the seeds of each row, of those that did not diverge."""
    return {
        row.name: {
            metric: Estimate.of([s[metric] for s in _scores(outcomes, row.name).values()])
            for metric in table.metrics
        }
        for row in table.rows
    }


def differences(table: Table, outcomes: Sequence[Outcome]) -> Estimates:
    """Return by how much each row differs from the first with the same seed."""
    first = _scores(outcomes, table.rows[0].name)
    return {
        row.name: {
            metric: Estimate.of(
                [
                    score[metric] - first[seed][metric]
                    for seed, score in _scores(outcomes, row.name).items()
                    if seed in first
                ]
            )
            for metric in table.metrics
        }
        for row in table.rows[1:]
    }


def _scores(outcomes: Sequence[Outcome], row: str) -> dict[int, Mapping[str, float]]:
    """Return the scores of a row's runs that ended well, by seed."""
    return {o.seed: o.scores for o in outcomes if o.row == row and o.scores is not None}
