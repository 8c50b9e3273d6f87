from importlib import import_module
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def rendering(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module("rendering")


@pytest.mark.parametrize(("seconds", "word"), [(0.3, "pass"), (0.4, "MISS")])
def test_the_mean_over_the_kinds_stands_beside_the_bar(
    rendering, monkeypatch, capsys, seconds, word
):
    monkeypatch.setattr(rendering.Library, "made", lambda *_: None)
    monkeypatch.setattr(rendering, "image_seconds", lambda *_: (0.1, seconds - 0.1, 9.0))
    monkeypatch.setattr("sys.argv", ["rendering.py", "--strict"])
    assert rendering.main() == (word == "MISS")
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.endswith(f"asked <= .35  measured .{round(10 * seconds)}  {word}")


def test_kinds_count_by_their_shares(rendering, monkeypatch, capsys):
    """A second for a fifth of the scenes under a roof, which are six tenths: .12 in the mean."""

    def dear(rng): ...

    def cheap(rng): ...

    monkeypatch.setattr(rendering.Library, "made", lambda *_: None)
    monkeypatch.setattr(rendering, "INDOORS", ((1.0, dear), (4.0, cheap)))
    monkeypatch.setattr(rendering, "image_seconds", lambda make, *_: (0.0, make is dear, 9.0))
    monkeypatch.setattr("sys.argv", ["rendering.py"])
    assert rendering.main() == 0
    assert "measured .12 " in capsys.readouterr().out


def test_an_image_of_a_kind_is_timed(rendering):
    kinds = {make.__name__: make for _, make in rendering.OUTDOORS}
    library = rendering.Library.made(rendering.np.random.default_rng(0), 1)
    scene, picture, triangles = rendering.image_seconds(kinds["hoop"], library, 1)
    assert scene > 0
    assert picture > 0
    assert triangles > 100
