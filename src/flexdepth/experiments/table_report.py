"""What a table of runs comes to: mean and spread over seeds, beside the published numbers.

Written as Markdown, LaTeX and CSV. The best number of a column is bold, the second underlined;
which is better is the metric's own (`evaluation.metrics`).
"""

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from math import isnan
from pathlib import Path

from flexdepth.evaluation.metrics import METRICS
from flexdepth.experiments.estimates import Estimate, Estimates, differences, measured
from flexdepth.experiments.published_tables import Row, Table
from flexdepth.experiments.tables import AVERAGED, Outcome, Plan
from flexdepth.runtime.atomic import replacing

NAMES = ("table.md", "table.tex", "table.csv", "runs.csv")
"""The files of a table."""

_UP, _DOWN = "\\uparrow", "\\downarrow"


def markdown(plan: Plan, outcomes: Sequence[Outcome]) -> str:
    """Return the table as Markdown: measured, the differences, published, the caveats."""
    table = plan.table
    found, against = measured(table, outcomes), differences(table, outcomes)
    heads = [
        f"{METRICS[m].title} {'↑' if METRICS[m].higher_is_better else '↓'}" for m in table.metrics
    ]
    blocks = [
        f"## Table {table.number}: {table.title}",
        _budget(plan),
        _grid(["measured", "", *heads], _marked_rows(table, _means(table, found), _html(found))),
        *_lost(table, outcomes),
    ]
    if against and plan.seeds > 1:
        blocks += [
            f"Less {table.rows[0].name} with the same seed, mean ± spread of the difference; bold "
            f"where the mean is larger than the spread:",
            _grid(["difference", *heads], [_difference(table, n, e) for n, e in against.items()]),
        ]
    published = {
        row.name: dict(zip(table.metrics, row.published, strict=True)) for row in table.rows
    }
    blocks += [
        "In the dissertation:",
        _grid(["published", "", *heads], _marked_rows(table, published, _plain(table))),
        "\n".join(f"- {caveat}" for caveat in table.caveats),
    ]
    return "\n\n".join(blocks) + "\n"


def latex(plan: Plan, outcomes: Sequence[Outcome]) -> str:
    """Return the table as LaTeX, the measured rows above the published ones."""
    table = plan.table
    found = measured(table, outcomes)
    published = {
        row.name: dict(zip(table.metrics, row.published, strict=True)) for row in table.rows
    }
    heads = [
        f"{_escaped(METRICS[m].title)} ${_UP if METRICS[m].higher_is_better else _DOWN}$"
        for m in table.metrics
    ]
    upper = _marked(table, _means(table, found), _tex(found), "\\textbf{%s}", "\\underline{%s}")
    lower = _marked(table, published, _plain(table), "\\textbf{%s}", "\\underline{%s}")
    lines = [
        "\\begin{tabular}{l" + "c" * len(heads) + "}",
        "\\hline",
        " & ".join([f"measured, {plan.seeds} seeds", *heads]) + " \\\\",
        "\\hline",
        *(" & ".join([_escaped(name), *cells]) + " \\\\" for name, cells in upper.items()),
        "\\hline",
        " & ".join(["published", *("" for _ in heads)]) + " \\\\",
        "\\hline",
        *(" & ".join([_escaped(name), *cells]) + " \\\\" for name, cells in lower.items()),
        "\\hline",
        "\\end{tabular}",
    ]
    return "\n".join(lines) + "\n"


def write_table(folder: Path, plan: Plan, outcomes: Sequence[Outcome]) -> None:
    """Write the table in each format, and what each run came to.

    Raises:
        InputError: They cannot be written.
    """
    texts = (
        markdown(plan, outcomes),
        latex(plan, outcomes),
        _summary_csv(plan, outcomes),
        _runs_csv(plan, outcomes),
    )
    for name, text in zip(NAMES, texts, strict=True):
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _means(table: Table, found: Estimates) -> dict[str, dict[str, float]]:
    return {row.name: {m: found[row.name][m].mean for m in table.metrics} for row in table.rows}


def _budget(plan: Plan) -> str:
    loop = plan.experiment.loop
    averaged = min(AVERAGED, plan.evaluations)
    few = "" if averaged == AVERAGED else f", for a run has no {AVERAGED} of them"
    shape = " or ".join(f"{width}x{height}" for width, height in sorted(set(loop.batches.shapes)))
    return (
        f"Each row: {plan.seeds} {'seed' if plan.seeds == 1 else 'seeds'}, {loop.iterations} "
        f"iterations of {loop.batches.size} crops of {shape}; depth fitted by "
        f"`{loop.alignment.value}`. A run's number is the mean of its last {averaged} "
        f"evaluations{few}; then mean ± sample standard deviation over seeds."
    )


def _lost(table: Table, outcomes: Sequence[Outcome]) -> list[str]:
    """Return a line for each row of which runs have no number."""
    lines = []
    for row in table.rows:
        lost = [o.seed for o in outcomes if o.row == row.name and o.scores is None]
        if lost:
            lines.append(
                f"{row.name}: the objective ceased to be finite with seed "
                f"{', '.join(map(str, lost))}, left out above."
            )
    return lines


Cell = Callable[[str, str], str]
"""From the names of a row and a metric to what is written."""


def _marked(
    table: Table, values: Mapping[str, Mapping[str, float]], cell: Cell, bold: str, under: str
) -> dict[str, list[str]]:
    """Return the cells of each row, the best of each column bold and the second underlined.

    What is equal as it is shown is marked alike.
    """
    rows: dict[str, list[str]] = {row.name: [] for row in table.rows}
    for metric in table.metrics:
        column = {name: cell(name, metric) for name in rows}
        sign = -1 if METRICS[metric].higher_is_better else 1
        known = {name: sign * round(values[name][metric], 4) for name in rows}
        order = sorted({value for value in known.values() if not isnan(value)})
        marks = dict(zip(order[:2], (bold, under), strict=False)) if len(rows) > 1 else {}
        for name, text in column.items():
            rows[name].append(marks.get(known[name], "%s") % text)
    return rows


def _marked_rows(
    table: Table, values: Mapping[str, Mapping[str, float]], cell: Cell
) -> list[list[str]]:
    about = {row.name: row.about for row in table.rows}
    marked = _marked(table, values, cell, "**%s**", "<u>%s</u>")
    return [[name, about[name], *cells] for name, cells in marked.items()]


def _html(found: Estimates) -> Cell:
    return lambda row, metric: _shown(found[row][metric], "%.4f ± %.4f")


def _tex(found: Estimates) -> Cell:
    return lambda row, metric: _shown(found[row][metric], "%.4f $\\pm$ %.4f")


def _shown(estimate: Estimate, form: str) -> str:
    if not estimate.count:
        return "-"
    if estimate.count == 1:
        return f"{estimate.mean:.4f}"
    return form % (estimate.mean, estimate.spread)


def _plain(table: Table) -> Cell:
    numbers: dict[str, Row] = {row.name: row for row in table.rows}
    return lambda row, metric: f"{numbers[row].published[table.metrics.index(metric)]:g}"


def _difference(table: Table, name: str, found: Mapping[str, Estimate]) -> list[str]:
    cells = []
    for metric in table.metrics:
        text = _shown(found[metric], "%+.4f ± %.4f")
        cells.append(f"**{text}**" if found[metric].stands_out else text)
    return [name, *cells]


def _grid(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _escaped(text: str) -> str:
    greek = text.replace("δ", "$\\delta$")
    return greek.replace("_", "\\_").replace("%", "\\%")


def _summary_csv(plan: Plan, outcomes: Sequence[Outcome]) -> str:
    table = plan.table
    found = measured(table, outcomes)
    kinds = ("mean", "spread", "published")
    rows = []
    for row in table.rows:
        values = [
            (each.mean, each.spread, published)
            for each, published in zip(found[row.name].values(), row.published, strict=True)
        ]
        count = next(iter(found[row.name].values())).count
        rows.append([row.name, row.about, count, *(value for three in values for value in three)])
    heads = [f"{metric}_{kind}" for metric in table.metrics for kind in kinds]
    return _csv(["row", "about", "seeds", *heads], rows)


def _runs_csv(plan: Plan, outcomes: Sequence[Outcome]) -> str:
    metrics = next((list(o.scores) for o in outcomes if o.scores), list(plan.table.metrics))
    rows = [
        [o.row, o.seed, *(o.scores[m] if o.scores else "diverged" for m in metrics)]
        for o in outcomes
    ]
    return _csv(["row", "seed", *metrics], rows)


def _csv(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(
        [["" if isinstance(x, float) and isnan(x) else x for x in row] for row in rows]
    )
    return text.getvalue()
