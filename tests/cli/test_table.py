import pytest

from flexdepth.cli import table
from flexdepth.cli.main import main
from flexdepth.experiments.tables import Outcome


@pytest.fixture
def planned(monkeypatch):
    """What would have been trained; each run comes to an AbsRel of .3 less a tenth of its seed."""
    plans = []

    def run_table(plan, folder, _processes, _show):
        plans.append((plan, folder))
        names = plan.table.metrics
        return [
            Outcome(run.row.name, run.seed, dict.fromkeys(names, 0.3 - run.seed / 10))
            for run in plan.runs()
        ]

    monkeypatch.setattr(table, "run_table", run_table)
    return plans


@pytest.mark.usefixtures("here")
def test_a_table_is_of_the_experiment_behind_it_unless_another_is_named(planned):
    assert main(["table", "3.4"]) == 0
    assert main(["table", "3.4", "chapter3-short", "--seeds", "2"]) == 0
    (large, first), (short, second) = planned
    assert large.experiment.loop.iterations == 5000
    assert (short.experiment.loop.iterations, short.seeds) == (100, 2)
    assert (first.as_posix(), second.as_posix()) == (
        "runs/table-3.4-nyu-small",
        "runs/table-3.4-chapter3-short",
    )


def test_fields_of_the_experiment_can_be_set_and_rows_be_chosen(planned, here, capsys):
    arguments = ["--rows", "S1", "S7", "--loop.iterations", "7", "-o", "out"]
    assert main(["table", "3.4", "chapter3-short", *arguments]) == 0
    ((plan, _),) = planned
    assert plan.experiment.loop.iterations == 7
    assert [row.name for row in plan.table.rows] == ["S1", "S7"]
    assert "| S7 | SA exp(SA) + CA, with l2 | **0.2000 ± 0.1000** |" in capsys.readouterr().out
    assert (here / "out" / "table.tex").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["3.9"], "no table '3.9'; choose one of 3.1, 3.2, 3.3, 3.4, 3.5"),
        (["3.4", "nyu-smal"], "no experiment 'nyu-smal'; did you mean 'nyu-small'?"),
        (["3.4", "--rows", "S9"], "--rows: no row 'S9' in table 3.4; it has ['S1', 'S2',"),
        (["3.4", "--seeds", "0"], "a table needs at least 1 seed, got 0"),
        (["3.4", "compact"], "no term 'squared' to drop"),
        (["3.1", "compact", "--rows", "EDRB"], "the EDRB network takes the widths of an AGA"),
        (["3.4", "--sed", "2"], "--sed"),
    ],
)
@pytest.mark.usefixtures("here", "planned")
def test_a_mistake_is_told_in_one_line(arguments, said, capsys):
    assert main(["table", *arguments]) == 2
    line = capsys.readouterr().err
    assert said in line
    assert line.count("\n") == 1


def test_without_a_number_the_tables_are_listed(capsys):
    assert main(["table", "--help"]) == 0
    assert "3.5  AGA and conventional attention" in capsys.readouterr().out
