import json
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def certainty(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module("certainty")


def errors(shares, sizes):
    """A thousand errors, in spreads: such shares of them are not above such sizes."""
    return np.interp(np.linspace(0, 1, 1001)[1:], [0, *shares, 1], [0, *sizes, 9])


def test_the_shares_are_counted_and_the_factor_of_the_map_is_apart(certainty):
    factors = np.array([-0.3, 0.1, 0.2])
    spreads = np.array([0.1, 0.2, 0.6])
    found = certainty.Foretold(np.array([0.5, 1.0, 1.2, 2.0, 2.1]), spreads, factors)
    said = certainty.reliability(found)
    assert said["within one spread"] == 0.4
    assert said["within two spreads"] == 0.8
    assert said["median spread"] == 0.2
    # 68.27 % of the way from the first to the last of .1, .2, .3: .1 + 2 * .6827 * .1.
    assert said["scale"] == 0.237


@pytest.mark.parametrize("factor", [0.8, 1.0, 1.25])
def test_spreads_that_are_too_small_are_better_multiplied(certainty, factor):
    found = certainty.spread_factor(errors((0.68, 0.95), (factor, 2 * factor)))
    assert found == pytest.approx(factor, abs=0.01)


def test_both_shares_miss_by_as_much_of_what_is_allowed(certainty):
    # 4 of 5 points above 68 % where 2.4 of 3 points are missing at 95 %.
    found = certainty.spread_factor(errors((0.72, 0.926), (1.1, 2.2)))
    assert found == pytest.approx(1.1, abs=0.006)


def report(one=0.68, two=0.95, lower=0.2):
    return {
        "held-out scenes": {"within one spread": one, "within two spreads": two},
        "NYU": {"lower by": lower},
    }


def test_every_bar_is_met_where_all_is_well(certainty):
    bars = [each.record() for each in certainty.asked(report())]
    assert [(each["name"], each["asked"], each["measured"]) for each in bars] == [
        ("held-out scenes: within one spread", ">= .63", 0.68),
        ("held-out scenes: within one spread", "<= .73", 0.68),
        ("held-out scenes: within two spreads", ">= .92", 0.95),
        ("held-out scenes: within two spreads", "<= .98", 0.95),
        ("NYU, without the least sure fifth: AbsRel lower by", ">= .15", 0.2),
    ]
    assert all(each["met"] for each in bars)


@pytest.mark.parametrize(
    ("change", "missed"),
    [
        ({"one": 0.63, "two": 0.92, "lower": 0.15}, []),
        ({"one": 0.73, "two": 0.98}, []),
        ({"one": 0.6299}, [0]),
        ({"one": 0.7301}, [1]),
        ({"two": 0.9199}, [2]),
        ({"two": 0.9801}, [3]),
        ({"lower": 0.1499}, [4]),
        ({"lower": -0.02}, [4]),
    ],
)
def test_what_is_allowed_ends_where_it_says(certainty, change, missed):
    bars = list(certainty.asked(report(**change)))
    assert [number for number, each in enumerate(bars) if not each.met] == missed


@pytest.mark.parametrize(("lower", "code"), [(0.15, 0), (0.1, 1)])
def test_only_strict_makes_a_missed_bar_an_error(
    certainty, monkeypatch, tmp_path, capsys, lower, code
):
    monkeypatch.setattr(certainty, "held", lambda _samples: [(certainty.SETS[1], ())])
    monkeypatch.setattr(certainty, "on_real", lambda *_: {"lower by": lower})
    command = ["certainty.py", "--held-out", str(tmp_path / "nowhere")]
    monkeypatch.setattr("sys.argv", command)
    assert certainty.main() == 0
    printed = capsys.readouterr()
    (bar,) = json.loads(printed.out)["bars"]
    assert bar["met"] is (code == 0)
    assert "skipped held-out scenes" in printed.err
    monkeypatch.setattr("sys.argv", [*command, "--strict"])
    assert certainty.main() == code
