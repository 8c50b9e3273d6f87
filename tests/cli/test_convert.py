from typing import get_args, get_type_hints

import cv2
import numpy as np
import pytest

from flexdepth.cli.convert import Convert, run
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import SUFFIXES, read_depth, read_origin, write_depth

VALUES = np.array([[0.5, 2.0, np.inf], [1.0, np.nan, 6.25]], np.float32)
STATED = ["--space", "metric", "--scale", "0.001"]
CAMERA = Intrinsics(4.0, 4.0, 1.5, 1.0, FocalSource.EXIF)


@pytest.fixture
def room(tmp_path):
    path = tmp_path / "room.npz"
    write_depth(path, DepthMap(VALUES, Space.SCALE, CAMERA, "compact 0.1.0"), {"input": "r.jpg"})
    return path


def test_every_format_is_offered():
    assert get_args(get_type_hints(Convert)["format"]) == tuple(SUFFIXES)


@pytest.mark.parametrize("name", ["npy", "exr", "pfm"])
def test_values_and_meaning_survive_the_way_there_and_back(room, tmp_path, name, capsys):
    there, back = tmp_path / "there", tmp_path / "back"
    assert run([str(room), "--format", name, "-o", str(there)]) == 0
    made = there / f"room{SUFFIXES[name]}"
    assert capsys.readouterr().out == f"{made}\n"
    assert run([str(made), "--format", "npz", "--output-dir", str(back)]) == 0
    found = read_depth(back / "room.npz")
    np.testing.assert_array_equal(found.values, VALUES)
    assert (found.space, found.intrinsics, found.model) == (Space.SCALE, CAMERA, "compact 0.1.0")
    assert read_origin(back / "room.npz") == {"input": "r.jpg", "converted_from": made.name}


def test_the_result_lies_beside_the_file_by_default(room):
    run([str(room), "--format", "png16"])
    # Half a step of 6.25 / 65534.
    np.testing.assert_allclose(read_depth(room.with_suffix(".png")).values, VALUES, atol=4.8e-5)


def test_nothing_is_overwritten_unasked(room):
    target = room.with_suffix(".pfm")
    target.write_text("precious")
    with pytest.raises(InputError, match=r"room\.pfm: exists already; --overwrite"):
        run([str(room), "--format", "pfm"])
    assert target.read_text() == "precious"
    assert not room.with_suffix(".json").exists()
    run([str(room), "--format", "pfm", "--overwrite"])
    np.testing.assert_array_equal(read_depth(target).values, VALUES)


def test_two_files_for_one_place_are_refused_before_anything_is_written(room, tmp_path):
    run([str(room), "--format", "exr"])
    both = [str(room), str(room.with_suffix(".exr"))]
    with pytest.raises(InputError, match=r"room\.npy: 2 of the files"):
        run([*both, "--format", "npy", "-o", str(tmp_path / "out")])
    assert not (tmp_path / "out").exists()


def test_the_good_files_are_converted_beside_a_broken_one(room, tmp_path):
    (tmp_path / "broken.npz").touch()
    with pytest.raises(InputError, match=r"broken\.npz"):
        run([str(tmp_path / "broken.npz"), str(room), "--format", "exr"])
    assert room.with_suffix(".exr").exists()
    assert not (tmp_path / "broken.exr").exists()


def test_a_file_of_other_make_is_taken_as_stated(tmp_path):
    cv2.imwrite(str(tmp_path / "truth.png"), np.array([[0, 1500]], np.uint16))
    with pytest.raises(InputError, match=r"--space metric --scale 0\.001"):
        run([str(tmp_path / "truth.png"), "--format", "npz"])
    run([str(tmp_path / "truth.png"), "--format", "npz", *STATED])
    found = read_depth(tmp_path / "truth.npz")
    np.testing.assert_array_equal(found.values, np.array([[np.nan, 1.5]], np.float32))
    assert found.space is Space.METRIC


def test_a_scale_without_a_space_is_refused(room):
    with pytest.raises(InputError, match="give --space too"):
        run([str(room), "--format", "npy", "--scale", "0.001"])


def test_no_file_is_refused():
    with pytest.raises(InputError, match="at least one"):
        run(["--format", "npy"])
