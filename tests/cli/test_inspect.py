import json
import sys
from io import StringIO

import numpy as np
import pytest

from flexdepth.cli.inspect import run
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth


@pytest.fixture
def room(tmp_path):
    values = np.array([[0.5, 2.0, 6.25, np.inf], [1.0, 1.0, np.nan, np.nan]], np.float32)
    camera = Intrinsics(4.0, 4.0, 2.0, 1.0, FocalSource.ASSUMED)
    path = tmp_path / "room [red].npz"
    write_depth(path, DepthMap(values, Space.METRIC, camera, "compact 0.1.0"), {"input": "r.jpg"})
    return path


def test_the_table_says_what_a_person_asks(room, capsys):
    assert run([str(room)]) == 0
    shown = capsys.readouterr().out
    for part in (
        "room [red].npz",
        "4 x 2",
        "depth, metric",
        "0.5 to 6.25 m",
        "62.5%",
        "12.5%",
        "unknown nan, sky inf",
        "53.1 degrees",
        "compact 0.1.0",
        "r.jpg",
    ):
        assert part in shown


def test_json_is_for_scripts(room, capsys):
    run([str(room), str(room), "--json"])
    first, second = json.loads(capsys.readouterr().out)
    assert first == second
    assert first["file"] == str(room)
    assert (first["least"], first["largest"]) == (0.5, 6.25)
    assert (first["share_valid"], first["share_sky"]) == (0.625, 0.125)
    assert (first["space"], first["unit"]) == ("metric", "m")


def test_a_map_without_a_camera_or_a_finite_value_is_shown(tmp_path, capsys):
    path = tmp_path / "a.png"
    write_depth(path, DepthMap(np.full((2, 2), np.nan, np.float32), Space.AFFINE_DISPARITY), None)
    run([str(path)])
    shown = capsys.readouterr().out
    assert "disparity, affine_disparity" in shown
    assert "no finite value" in shown
    assert "not known" in shown
    run([str(path), "--json"])
    assert json.loads(capsys.readouterr().out)[0]["least"] is None


def test_the_good_files_are_shown_beside_a_broken_one(room, tmp_path, capsys):
    (tmp_path / "broken.npz").write_bytes(b"PK")
    with pytest.raises(InputError, match=r"broken\.npz: cannot be read as a npz file") as refusal:
        run([str(tmp_path / "broken.npz"), str(room)])
    assert "\n" not in str(refusal.value)
    assert "0.5 to 6.25 m" in capsys.readouterr().out


def test_no_file_is_refused():
    with pytest.raises(InputError, match="at least one"):
        run([])


def test_help_lists_the_options(capsys):
    with pytest.raises(SystemExit, match="0"):
        run(["--help"])
    assert "--json" in capsys.readouterr().out


def test_a_reader_that_has_seen_enough_is_no_mistake(room, monkeypatch):
    class Closed(StringIO):
        def write(self, _text):
            raise BrokenPipeError

    monkeypatch.setattr(sys, "stdout", Closed())
    with pytest.raises(BrokenPipeError):
        run([str(room)])
