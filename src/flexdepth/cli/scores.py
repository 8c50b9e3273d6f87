"""Scores as text: tables that fit a terminal."""

from collections.abc import Mapping, Sequence

from flexdepth.evaluation.audit import Audit, Row
from flexdepth.evaluation.evaluate import Evaluation
from flexdepth.evaluation.score import ALL_METRICS
from flexdepth.evaluation.summary import Difference, Estimate

_SHOWN = ("abs_rel", "rmse", "silog", "silog_half", "delta1")
"""Of an audit, what fits beside one another."""


_NOTHING = 5e-5


def table(found: Evaluation, remarks: Sequence[str]) -> str:
    """Return the metrics of a set with their intervals, and what must be known of them."""
    protocol = found.protocol
    left_out = f", {len(found.left_out)} left out" if found.left_out else ""
    lines = [
        f"{protocol.title}: {protocol.summary}",
        f"{len(found.scores)} images scored{left_out}; alignment {protocol.alignment} per "
        f"{protocol.per}; averaged over {protocol.averaging}",
        "",
        f"  {'metric':<12}{'value':>9}  {'95 % interval':<21}",
    ]
    for name, estimate in found.results.items():
        metric = ALL_METRICS[name]
        better = "higher is better" if metric.higher_is_better else "lower is better"
        lines.append(
            f"  {metric.title:<12}{number(estimate.value):>9}  {interval(estimate):<21}{better}"
        )
    lines += ["", *(f"note: {each}" for each in remarks)]
    lines += [f"left out: {each.name}: {each.reason}" for each in found.left_out[:10]]
    if len(found.left_out) > 10:
        lines.append(f"left out: {len(found.left_out) - 10} more, in images.csv")
    return "\n".join(lines) + "\n"


def audit_table(found: Audit) -> str:
    """Return the scores under every protocol, and the chains that lead from the first to each."""
    titles = "".join(f"{ALL_METRICS[name].title:>9}" for name in _SHOWN)
    lines = [f"{'protocol':<29}{'fit':<25}{'images':>7}{titles}", *map(_audit_row, found.rows), ""]
    first = found.rows[0]
    metric = ALL_METRICS[found.explained].title
    for row in found.rows[1:]:
        before, after = (each.results[found.explained].value for each in (first, row))
        lines.append(
            f"{metric} from {first.protocol.name} to {row.protocol.name}: "
            f"{number(before)} -> {number(after)} ({after - before:+.4f})"
        )
        lines += [
            f"  {link.change:+.4f}  {link.name}: {link.before} -> {link.after}"
            for link in row.chain
            if not abs(link.change) < _NOTHING
        ]
        same = [link.name for link in row.chain if abs(link.change) < _NOTHING]
        lines += [f"  no change by the {', '.join(same)}"] if same else []
    lines += [f"not applied: {name}: {reason}" for name, reason in found.refused.items()]
    return "\n".join(lines) + "\n"


def _audit_row(row: Row) -> str:
    protocol = row.protocol
    star = "*" if row.replaced is not None else ""
    images = f"{row.scored}" + (f"-{row.left_out}" if row.left_out else "")
    values = "".join(f"{number(row.results[name].value):>9}" for name in _SHOWN)
    return f"{protocol.name:<29}{protocol.alignment + star:<25}{images:>7}{values}"


def comparison(found: Mapping[str, Difference], names: tuple[str, str]) -> str:
    """Return how two results differ, metric by metric."""
    lines = [
        f"A: {names[0]}",
        f"B: {names[1]}",
        "",
        f"  {'metric':<12}{'A':>9}{'B':>9}{'B - A':>10}  {'95 % interval':<21}{'p':>7}  B better",
    ]
    for name, each in found.items():
        lines.append(
            f"  {ALL_METRICS[name].title:<12}{number(each.first):>9}{number(each.second):>9}"
            f"{each.apart.value:>+10.4f}  {interval(each.apart):<21}{each.p:>7.4f}  "
            f"on {each.second_better:.0%}"
        )
    return "\n".join(lines) + "\n"


def number(value: float) -> str:
    """Return a metric in four digits after the point, or two where it is large."""
    return f"{value:.4f}" if abs(value) < 10 else f"{value:.2f}"


def interval(estimate: Estimate) -> str:
    """Return the ends of an interval."""
    if estimate.low is None or estimate.high is None:
        return "-"
    return f"{number(estimate.low)} to {number(estimate.high)}"
