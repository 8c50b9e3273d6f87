"""What was measured, as one table, with the bars beside it."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rows import BASELINE, FULL, PRIOR, WITH_PRIOR
from scored_pairs import GROUPS, SHAPES, Scores

sys.path.insert(0, str(Path(__file__).parents[1]))

from verdict import verdict

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Line:
    """One method on one kind of flow.

    Attributes:
        flow: Its name in the suite.
        row: The method.
        seeds: Of the pairs that were scored.
        each: What each pair scored.
        scores: The mean over them.
        seconds: Median wall clock of a pair.
        cpu: Median CPU time of a pair.
    """

    flow: str
    row: str
    seeds: tuple[int, ...]
    each: tuple[Scores, ...]
    scores: Scores
    seconds: float
    cpu: float


@dataclass(frozen=True)
class Verdict:
    """What a bar asks, and what was measured."""

    flow: str
    what: str
    bar: float
    measured: float

    @property
    def passed(self) -> bool:
        """Whether the bar is met: delta1 and coverage from below, all else from above."""
        if self.what.endswith(("_delta1", "_coverage")):
            return self.measured >= self.bar - _ROUNDING
        return self.measured <= self.bar + _ROUNDING


def verdicts(lines: Sequence[Line], bars: dict[str, dict[str, float]]) -> list[Verdict]:
    """Return how the full method stands to each bar whose flow and rows were run."""
    found = []
    for flow, asked in bars.items():
        rows = {line.row: line.scores for line in lines if line.flow == flow}
        for what, bar in asked.items():
            measured = _measured(what, rows)
            if measured is not None:
                found.append(Verdict(flow, what, bar, measured))
    return found


def _measured(what: str, rows: Mapping[str, Scores]) -> float | None:
    group, _, kind = what.partition("_")
    if kind == "of_essential":
        return _share(group, FULL, (BASELINE,), rows)
    if kind == "with_prior":
        return _share(group, WITH_PRIOR, (FULL, PRIOR), rows)
    score = rows.get(FULL, {}).get(group)
    if score is None:
        return None
    return {"": score.abs_rel, "delta1": score.delta1, "coverage": score.coverage}[kind]


def _share(group: str, row: str, others: Sequence[str], rows: Mapping[str, Scores]) -> float | None:
    """Return a row's AbsRel as a share of the least of others; None where one of them lacks it."""
    errors = [rows[name][group].abs_rel for name in (row, *others) if group in rows.get(name, {})]
    if len(errors) <= len(others):
        return None
    return errors[0] / max(min(errors[1:]), _ROUNDING)


def text(lines: Sequence[Line], judged: Sequence[Verdict]) -> str:
    """Return the table: AbsRel/delta1 in percent of each group, then coverage and time."""
    head = f"{'flow':10} {'method':26} {'pairs':>5}"
    head += "".join(f"{group:>12}" for group in GROUPS)
    head += "".join(f"{shape:>16}" for shape in SHAPES)
    head += f"{'still known':>13}{'moving known':>14}{'seconds':>9}{'CPU s':>8}"
    rows = [head, "-" * len(head)]
    last = None
    for line in lines:
        if last not in (None, line.flow):
            rows.append("")
        last = line.flow
        rows.append(_row(line))
    rows += ["", f"bars for `{FULL}`, and for `{WITH_PRIOR}` as a share of the better one alone:"]
    for each in judged:
        mark = verdict(each.passed)
        what = f"{each.flow}: {each.what.replace('_', ' ')}"
        rows.append(f"  {what:38} {each.bar:>7.4g}  measured {each.measured:>7.4f}  {mark}")
    return "\n".join(rows)


def _row(line: Line) -> str:
    shapes = [
        abs_rel(line.scores[shape].abs_rel) if shape in line.scores else "-" for shape in SHAPES
    ]
    cells = [
        f"{abs_rel(line.scores[group].abs_rel)}/{100 * line.scores[group].delta1:.0f}"
        if group in line.scores
        else "-"
        for group in GROUPS
    ]
    known = [
        f"{100 * line.scores[group].coverage:.0f} %" if group in line.scores else "-"
        for group in ("static", "moving")
    ]
    row = f"{line.flow:10} {line.row:26} {len(line.seeds):>5}"
    row += "".join(f"{cell:>12}" for cell in cells)
    row += "".join(f"{shape:>16}" for shape in shapes)
    return row + f"{known[0]:>13}{known[1]:>14}{line.seconds:>9.2f}{line.cpu:>8.2f}"


def abs_rel(value: float) -> str:
    """Return .032 or 1.83."""
    return f"{value:.3f}".removeprefix("0") if value < 1 else f"{value:.2f}"


def record(lines: Sequence[Line], judged: Sequence[Verdict]) -> dict[str, Any]:
    """Return the same for JSON."""
    return {
        "lines": [asdict(line) for line in lines],
        "bars": [asdict(each) | {"passed": each.passed} for each in judged],
    }
