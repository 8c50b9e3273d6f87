"""Two rows, three seeds, numbers by hand."""

import csv
from dataclasses import replace

import pytest

from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.estimates import Estimate, differences, measured
from flexdepth.experiments.published_tables import TABLES
from flexdepth.experiments.table_report import latex, markdown, write_table
from flexdepth.experiments.tables import Outcome, Plan

TABLE = replace(
    TABLES["3.4"],
    metrics=("abs_rel", "delta1"),
    rows=tuple(
        replace(row, published=row.published[:1] + row.published[3:4])
        for row in TABLES["3.4"].rows
        if row.name in {"S1", "S6", "S7"}
    ),
)
PLAN = Plan(TABLE, CATALOGUE["chapter3-short"], 3)


def outcomes(row, errors, shares):
    scores = zip(errors, shares, strict=True)
    return [
        Outcome(row, seed, None if error is None else {"abs_rel": error, "delta1": share})
        for seed, (error, share) in enumerate(scores)
    ]


FOUND = [
    *outcomes("S1", (0.30, 0.32, 0.34), (0.5, 0.5, 0.5)),
    *outcomes("S6", (0.31, 0.31, 0.31), (0.6, 0.4, 0.5)),
    *outcomes("S7", (0.29, 0.31, 0.33), (0.4, 0.3, 0.2)),
]


def test_the_spread_is_the_sample_deviation_over_seeds():
    found = measured(TABLE, FOUND)["S1"]["abs_rel"]
    assert (found.mean, found.spread, found.count) == (pytest.approx(0.32), pytest.approx(0.02), 3)


def test_differences_are_taken_seed_by_seed():
    """S7 is .01 below S1 with every seed, though both spread by .02."""
    found = differences(TABLE, FOUND)
    assert set(found) == {"S6", "S7"}
    seven, six = found["S7"]["abs_rel"], found["S6"]["abs_rel"]
    assert (seven.mean, seven.spread) == (pytest.approx(-0.01), pytest.approx(0.0, abs=1e-9))
    assert (six.mean, six.spread) == (pytest.approx(-0.01), pytest.approx(0.02))
    assert seven.stands_out
    assert not six.stands_out


def test_one_seed_has_no_spread_and_none_no_mean():
    alone, nothing = Estimate.of([0.5]), Estimate.of([])
    assert (alone.mean, str(alone.spread), alone.stands_out) == (0.5, "nan", False)
    assert (str(nothing.mean), nothing.count) == ("nan", 0)


def test_the_best_is_bold_and_the_second_underlined():
    """Less is better in AbsRel, where S6 and S7 share .31; more in delta1, S1 and S6 with .5."""
    lines = markdown(PLAN, FOUND).splitlines()
    assert "| S1 | CA | <u>0.3200 ± 0.0200</u> | **0.5000 ± 0.0000** |" in lines
    assert (
        "| S7 | SA exp(SA) + CA, with l2 | **0.3100 ± 0.0200** | <u>0.3000 ± 0.1000</u> |" in lines
    )
    assert "| S7 | **-0.0100 ± 0.0000** | **-0.2000 ± 0.1000** |" in lines
    assert "| S6 | -0.0100 ± 0.0200 | +0.0000 ± 0.1000 |" in lines


def test_the_published_numbers_and_their_caveats_stand_beside():
    text = markdown(PLAN, FOUND)
    assert "| S6 | SA exp(SA) + CA | **0.1345** | <u>0.8302</u> |" in text
    assert "| S7 | SA exp(SA) + CA, with l2 | <u>0.1364</u> | **0.8319** |" in text
    assert all(f"- {caveat}" in text for caveat in TABLE.caveats)


def test_latex_has_the_same_marks():
    text = latex(PLAN, FOUND)
    assert "S7 & \\textbf{0.3100 $\\pm$ 0.0200} & \\underline{0.3000 $\\pm$ 0.1000} \\\\" in text
    assert "S6 & \\textbf{0.1345} & \\underline{0.8302} \\\\" in text
    assert "AbsRel $\\downarrow$ & $\\delta$1 $\\uparrow$" in text
    assert text.count("{") == text.count("}")


def test_a_run_that_diverged_is_left_out_and_named():
    lost = [*FOUND[:6], *outcomes("S7", (0.29, None, None), (0.4, None, None))]
    text = markdown(PLAN, lost)
    assert "S7: the objective ceased to be finite with seed 1, 2, left out above." in text
    assert "| S7 | SA exp(SA) + CA, with l2 | **0.2900** |" in text
    gone = [*FOUND[:6], *outcomes("S7", (None, None, None), (None, None, None))]
    assert "| S7 | SA exp(SA) + CA, with l2 | - | - |" in markdown(PLAN, gone)


def test_the_files_of_a_table(tmp_path):
    gone = [*FOUND[:6], *outcomes("S7", (0.29, None, None), (0.4, None, None))]
    write_table(tmp_path, PLAN, gone)
    assert {path.name for path in tmp_path.iterdir()} == {
        "table.md",
        "table.tex",
        "table.csv",
        "runs.csv",
    }
    with (tmp_path / "table.csv").open(newline="") as file:
        rows = {row["row"]: row for row in csv.DictReader(file)}
    assert float(rows["S1"]["abs_rel_spread"]) == pytest.approx(0.02)
    assert rows["S1"]["abs_rel_published"] == "0.1408"
    assert (rows["S7"]["seeds"], rows["S7"]["abs_rel_spread"]) == ("1", "")
    with (tmp_path / "runs.csv").open(newline="") as file:
        runs = list(csv.DictReader(file))
    assert [run["abs_rel"] for run in runs[6:]] == ["0.29", "diverged", "diverged"]


def test_a_budget_with_few_evaluations_says_so():
    short = replace(PLAN, experiment=CATALOGUE["chapter3-small"], seeds=1)
    assert "Each row: 1 seed, 1000 iterations of 8 crops of 192x192" in markdown(short, FOUND)
    assert "last 4 evaluations, for a run has no 15 of them" in markdown(short, FOUND)
    assert "last 15 evaluations; then" in markdown(PLAN, FOUND)
