"""Benchmarks are scripts: their modules are imported from their folder."""

from importlib import import_module
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def room(monkeypatch):
    """Return a function that imports one of the benchmark's modules."""
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module
