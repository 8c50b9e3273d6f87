import json
from importlib import import_module
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def scoring(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module("scoring")


def test_predictions_of_every_format_are_made_and_scored(scoring, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(scoring, "DIFFERENT", 2)
    scoring.make(tmp_path, 3)
    for kind in scoring.FORMATS:
        monkeypatch.setattr(
            "sys.argv", ["scoring.py", "--score", str(tmp_path), kind, "--images", "3"]
        )
        assert scoring.main() == 0
        cost = json.loads(capsys.readouterr().out)
        assert (cost["images"], cost["format"]) == (3, kind)
        assert cost["cpu_seconds"] > 0
        assert cost["peak_mb"] > 10
