"""`flexdepth table N`: train the rows of a table of chapter 3, and write it."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.experiments.catalogue import experiment_named
from flexdepth.experiments.experiment import Experiment
from flexdepth.experiments.published_tables import TABLES, Table
from flexdepth.experiments.table_report import markdown, write_table
from flexdepth.experiments.tables import Plan, run_table
from flexdepth.runtime.atomic import check_writable
from flexdepth.runtime.errors import InputError

_PAGE = """\
usage: flexdepth table NUMBER [EXPERIMENT] [options]

Trains every row of a table of the dissertation, once for each seed, and writes the table as
Markdown, LaTeX and CSV. EXPERIMENT gives the data and the budget: one of `flexdepth train`, or a
.yaml file; without it, the one behind each table:
{tables}

flexdepth table NUMBER EXPERIMENT --help lists the options. On two cores, in a night:
  flexdepth table 3.4 chapter3-short
"""


@dataclass(frozen=True)
class Making:
    """Train the rows of a table; any field of the experiment can be set to another value.

    Each run has a folder; started again with the same settings, finished ones are skipped.
    """

    experiment: Annotated[Experiment, tyro.conf.arg(name="")]
    """What the rows are changes of."""
    output_dir: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="DIR")]
    """Holds table.md, table.tex, table.csv, runs.csv and the runs."""
    seeds: Annotated[int, tyro.conf.arg(metavar="N")] = 3
    """How often each row is trained, each time with other first weights and crops."""
    rows: Annotated[tuple[str, ...], tyro.conf.arg(metavar="ROW")] = ()
    """Some of the rows; without it, all."""
    processes: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """Processes that read and augment images while the network computes."""


def run(arguments: Sequence[str]) -> int:
    """Make the table that the first argument numbers."""
    if not arguments or arguments[0] in {"-h", "--help"}:
        lines = [f"  {t.number}  {t.title} ({t.experiment})" for t in TABLES.values()]
        sys.stdout.write(_PAGE.format(tables="\n".join(lines)))
        return 0 if arguments else 2
    number, *rest = arguments
    if number not in TABLES:
        raise InputError(f"no table {number!r}; choose one of {', '.join(TABLES)}")
    table = TABLES[number]
    named = bool(rest) and not rest[0].startswith("-")
    name, options = (rest[0], rest[1:]) if named else (table.experiment, rest)
    experiment = experiment_named(name)
    with told_in_one_line(f"flexdepth table {number} {name}"):
        making = tyro.cli(
            Making,
            args=options,
            prog=f"flexdepth table {number} {name}",
            default=Making(experiment, Path("runs") / f"table-{number}-{Path(name).stem}"),
            config=(tyro.conf.AvoidSubcommands,),
        )
    plan = Plan(_with_rows(table, making.rows), making.experiment, making.seeds)
    check_writable(making.output_dir)
    outcomes = run_table(plan, making.output_dir, making.processes, _say)
    write_table(making.output_dir, plan, outcomes)
    _say("\n" + markdown(plan, outcomes) + f"\n{making.output_dir}: table.md, table.tex, table.csv")
    return 0


def _with_rows(table: Table, names: tuple[str, ...]) -> Table:
    known = [row.name for row in table.rows]
    unknown = [name for name in names if name not in known]
    if unknown:
        raise InputError(f"--rows: no row {unknown[0]!r} in table {table.number}; it has {known}")
    return replace(table, rows=tuple(r for r in table.rows if r.name in names)) if names else table


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()
