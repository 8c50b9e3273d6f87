"""Depth from two frames of a moving world: all methods on the pinned pairs, in one table.

    python benchmarks/solve/two_frames.py [--flow NAME]... [--only ROW]... [--without ROW]...
                                          [--pairs N] [--ablation] [--kept DIR]
                                          [--json FILE] [--strict]

`suite.yaml` says which pairs and which bars, `scored_pairs.py` how depth is scored. A name may be
cut short: `--flow exact --only dense --pairs 3`. Pairs are rendered on the first run (minutes) and
kept in build/solve-suite. `speed_of_solving.py` measures time against size; --ablation takes the
two innovations of chapter 5 out of its objective. With --strict it exits with 1 where a bar is
missed.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median

from pairs import KEPT, SYNTH, pair, suite
from rows import ABLATION, ROWS, Row, case, timed
from scored_pairs import mean, scores
from table import Line, record, text, verdicts

from flexdepth.runtime.errors import InputError


def chosen(names: Sequence[str], asked: Sequence[str] | None, what: str) -> list[str]:
    """Return the names that begin with one of those asked for; an exact name is itself alone.

    Raises:
        InputError: One begins nothing.
    """
    if asked is None:
        return list(names)
    found: list[str] = []
    for word in asked:
        hits = [word] if word in names else [name for name in names if name.startswith(word)]
        if not hits:
            raise InputError(f"no {what} begins with {word!r}; there are {', '.join(names)}")
        found += [name for name in hits if name not in found]
    return [name for name in names if name in found]


def lines(flow: str, rows: Mapping[str, Row], pairs: int | None, kept: Path) -> Iterator[Line]:
    """Yield each row's line for one kind of flow, once all its pairs are done."""
    said = suite()
    one = said["flow"][flow]
    seeds = said[one["set"]]["seeds"][:pairs]
    cases = [case(pair(said, one["set"], seed, kept), seed, one.get("noise")) for seed in seeds]
    for name, row in rows.items():
        results = [timed(row, each) for each in cases]
        found = [scores(r.depth, each.truth) for r, each in zip(results, cases, strict=True)]
        yield Line(
            flow,
            name,
            tuple(seeds),
            tuple(found),
            mean(found),
            median(result.seconds for result in results),
            median(result.cpu for result in results),
        )


def main() -> int:
    """Measure and print; 1 where --strict and a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--flow", action="append", help="exact, noise .05, noise .10, DIS")
    parser.add_argument("--only", action="append", help="a row; may be given again")
    parser.add_argument("--without", action="append", default=[], help="rows to leave out")
    parser.add_argument("--ablation", action="store_true", help="chapter 5's table 5.3 instead")
    parser.add_argument("--pairs", type=int, help="the first N pairs alone")
    parser.add_argument("--kept", type=Path, default=KEPT, help="where rendered pairs are")
    parser.add_argument("--json", type=Path, help="write the figures here too")
    parser.add_argument("--strict", action="store_true", help="exit with 1 where a bar is missed")
    asked = parser.parse_args()
    said = suite()
    try:
        flows = chosen(list(said["flow"]), asked.flow, "flow")
        offered = ABLATION if asked.ablation else ROWS
        out = chosen(list(offered), asked.without, "row")
        names = [name for name in chosen(list(offered), asked.only, "row") if name not in out]
        asked_rows = {name: offered[name] for name in names}
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    if said["synth"] != SYNTH:
        print(f"synth renders {SYNTH}, the suite is {said['synth']}: other pairs", file=sys.stderr)
    measured: list[Line] = []
    for flow in flows:
        for line in lines(flow, asked_rows, asked.pairs, asked.kept):
            measured.append(line)
            print(f"{flow}: {line.row}, {line.cpu:.2f} s of CPU a pair", file=sys.stderr)
            if asked.json is not None:  # What is done is kept, should the rest take too long.
                said_so_far = record(measured, verdicts(measured, said["bars"]))
                asked.json.write_text(json.dumps(said_so_far, indent=1) + "\n")
    judged = verdicts(measured, said["bars"])
    print(text(measured, judged))
    return int(asked.strict and not all(each.passed for each in judged))


if __name__ == "__main__":
    sys.exit(main())
