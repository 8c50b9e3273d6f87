import json

import numpy as np
import pytest

from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth
from flexdepth.scenes.camera import read_camera

NAMED = {"focal_x": 500.0, "focal_y": 510.0, "centre_x": 319.5, "centre_y": 239.5}


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.json", json.dumps(NAMED)),
        ("b.json", json.dumps({"width": 640, "height": 480, "intrinsics": NAMED})),
        ("c.json", json.dumps([[500, 0, 319.5], [0, 510, 239.5], [0, 0, 1]])),
        ("d.json", json.dumps({"focal": [500, 510], "centre": [319.5, 239.5]})),
        ("e.txt", "500 510 319.5 239.5\n"),
        ("f.txt", "500 0 319.5\n0 510 239.5\n0 0 1\n"),
        ("g.csv", "500, 510, 319.5, 239.5"),
    ],
)
def test_every_way_to_write_a_camera_says_the_same(name, text, tmp_path):
    (tmp_path / name).write_text(text)
    camera = read_camera(tmp_path / name, 640, 480)
    assert camera == Intrinsics(500.0, 510.0, 320.0, 240.0, FocalSource.GIVEN)


def test_a_depth_file_knows_its_camera(tmp_path):
    known = Intrinsics(30.0, 31.0, 20.0, 10.0, FocalSource.EXIF)
    write_depth(
        tmp_path / "d.npz", DepthMap(np.ones((20, 40), np.float32), Space.METRIC, known), None
    )
    camera = read_camera(tmp_path / "d.npz", 40, 20)
    assert camera == Intrinsics(30.0, 31.0, 20.0, 10.0, FocalSource.GIVEN)
    with pytest.raises(InputError, match="of pictures of 40x20, the frames are 80x40"):
        read_camera(tmp_path / "d.npz", 80, 40)


def test_a_camera_of_sintel_is_read(tmp_path):
    numbers = [1120.0, 0, 511.5, 0, 1120.0, 217.5, 0, 0, 1, *np.eye(3, 4).ravel()]
    tag = np.array([202021.25], "<f4").tobytes()
    (tmp_path / "a.cam").write_bytes(tag + np.array(numbers, "<f8").tobytes())
    camera = read_camera(tmp_path / "a.cam", 1024, 436)
    assert (camera.focal_x, camera.centre_x, camera.centre_y) == (1120.0, 512.0, 218.0)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.txt", "500 510 319.5", "got 3 numbers"),
        ("a.txt", "fx = 500", "cannot be read as a camera"),
        ("a.txt", "500 510 nan 239.5", "principal point nan"),
        ("a.json", "{", "cannot be read as a camera in JSON"),
        ("a.json", "3", "wanted focal_x"),
        ("a.json", '{"focal_x": 500}', "focal_y, centre_x, centre_y is missing"),
        ("a.json", "[[0.58, 0, 0.5], [0, 1.92, 0.5], [0, 0, 1]]", "in units of the picture's size"),
        ("a.txt", "500 510 900 239.5", "outside the frames of 640x480"),
        ("a.txt", "", "is empty"),
    ],
)
def test_what_is_no_camera_is_refused_in_one_line(name, text, said, tmp_path):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=said) as refused:
        read_camera(tmp_path / name, 640, 480)
    assert str(tmp_path / name) in str(refused.value)
    assert "\n" not in str(refused.value)
