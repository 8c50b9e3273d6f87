import pytest

from flexdepth.runtime import predictor


@pytest.fixture
def edges_as_seen(monkeypatch):
    """Leave edges of depth as the network sees them."""
    monkeypatch.setattr(predictor, "with_sharp_edges", lambda log_depth, _: log_depth)
