"""The scores as text: for a terminal, one table for each fit; for a README, one Markdown table."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from bars import RIVALS, Bar, Limit, written
from blind import BEST_CONSTANT, CONSTANT
from scores import Fit, Result
from verdict import verdict

from flexdepth.runtime.errors import InputError

_SHORT = MappingProxyType({Fit.DISPARITY: "disparity", Fit.MEDIAN: "median", Fit.METRES: "metres"})

Edges = Mapping[str, Mapping[str, float]]
"""Boundary F1 by set, then by who predicted."""


def text(results: Mapping[str, Result], edges: Edges, models: Sequence[str]) -> str:
    """Return the tables: sets down, those who predict across.

    Args:
        results: By set.
        edges: By set.
        models: Their names.
    """
    blocks = [_block(results, fit) for fit in Fit]
    sizes = {name: of.enlarged for name, of in results.items()}
    if any(sizes.values()):
        blocks.append(_plain("metres are times too large", sizes, models, "{:.2f}"))
    if edges:
        whos = list(next(iter(edges.values())))
        blocks.append(_plain("boundary F1, larger is better", edges, whos, "{:.3f}"))
    return "\n\n".join(blocks)


def markdown(results: Mapping[str, Result], edges: Edges, models: Sequence[str]) -> str:
    """Return one table: sets down; across, those who predict under each fit.

    The best constant, which needs no fit, stands there once, and the fitted one not at all.
    """
    whos = [who for who in _whos(results, Fit.DISPARITY) if who not in (CONSTANT, BEST_CONSTANT)]
    columns = [(who, fit) for who in whos for fit in Fit if who in _whos(results, fit)]
    head = ["AbsRel/delta1", "frames"]
    head += [f"{who}, {_SHORT[fit]}" for who, fit in columns]
    head += [BEST_CONSTANT, *(f"metres x, {who}" for who in models)]
    sharp = list(next(iter(edges.values()))) if edges else []
    head += [f"boundary F1, {who}" for who in sharp]
    rows = []
    for name, result in results.items():
        cells = [name, f"{result.frames - result.unscored}"]
        cells += [str(result.scores[fit].get(who, "-")) for who, fit in columns]
        cells += [str(result.scores[Fit.DISPARITY][BEST_CONSTANT])]
        cells += [_number(result.enlarged.get(who), "{:.2f}") for who in models]
        cells += [_number(edges.get(name, {}).get(who), "{:.3f}") for who in sharp]
        rows.append(cells)
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def verdicts(asked: Sequence[Bar], blind: Sequence[Bar], model: str) -> str:
    """Return the bars as a list, those beside the blind as a count and as what is missed.

    Args:
        asked: Shown one by one.
        blind: One for each figure.
        model: Whose numbers they are.
    """
    names = f"{', '.join(RIVALS[:-1])} and {RIVALS[-1]}"
    missed = [each for each in blind if not each.met]
    better = Bar(f"figures better than {names}", len(blind) - len(missed), Limit(">=", len(blind)))
    rows = [[f"bars for {model}", "asked", "measured", ""]]
    for each in (*asked, better, *missed):
        measured = "-" if each.measured is None else written(each.measured)
        rows.append([each.name, str(each.limit), measured, verdict(each.met)])
    return _lined_up(rows)


def _whos(results: Mapping[str, Result], fit: Fit) -> list[str]:
    """Return who has a score under a fit in any set, models first."""
    found: dict[str, None] = {}
    for result in results.values():
        found.update(dict.fromkeys(result.scores[fit]))
    return list(found)


def _block(results: Mapping[str, Result], fit: Fit) -> str:
    whos = _whos(results, fit)
    if not whos:
        raise InputError(f"nothing is scored {fit}")
    rows = [[f"{fit}: AbsRel/delta1", "frames", *whos]]
    for name, result in results.items():
        scores = result.scores[fit]
        row = [name, f"{result.frames - result.unscored}/{result.frames}"]
        row += [str(scores.get(who, "-")) for who in whos]
        rows.append(row)
    return _lined_up(rows)


def _plain(
    title: str, values: Mapping[str, Mapping[str, float]], whos: Sequence[str], form: str
) -> str:
    rows = [[title, *whos]]
    rows += [[name, *(_number(of.get(who), form) for who in whos)] for name, of in values.items()]
    return _lined_up(rows)


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else form.format(value).removeprefix("0")


def _lined_up(rows: Sequence[Sequence[str]]) -> str:
    count = max(map(len, rows))
    widths = [max((len(row[i]) for row in rows if i < len(row)), default=0) for i in range(count)]
    return "\n".join(
        "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=False)).rstrip()
        for row in rows
    )
