import cv2
import numpy as np
import pytest

from flexdepth.data.read import Measured, MeasuredPairs, lines, measured_depth, opencv_camera
from flexdepth.runtime.errors import InputError

CAMERA = opencv_camera((7.0, 8.0), (3.5, 2.5))


def pairs_of(folder, size=(8, 6), image_size=(8, 6), depth_size=(8, 6)):
    cv2.imwrite(str(folder / "a.png"), np.full((*image_size[::-1], 3), (0, 0, 200), np.uint8))
    codes = np.full(depth_size[::-1], 640, np.uint16)
    codes[0, 0] = 0
    cv2.imwrite(str(folder / "depth.png"), codes)
    files = Measured("a", folder / "a.png", folder / "depth.png", CAMERA, size)
    return MeasuredPairs((files,), 256.0)


def test_a_camera_that_counts_the_first_centre_as_0_moves_by_half_a_pixel():
    assert (CAMERA.centre_x, CAMERA.centre_y) == (4.0, 3.0)
    assert (CAMERA.focal_x, CAMERA.focal_y) == (7.0, 8.0)


def test_depth_comes_in_metres_and_zero_is_unknown(tmp_path):
    pair = pairs_of(tmp_path)[0]
    assert (pair.image == (200, 0, 0)).all()
    assert np.isnan(pair.truth.values[0, 0])
    assert np.unique(pair.truth.values[1:]).tolist() == [2.5]
    assert pair.truth.intrinsics == CAMERA


@pytest.mark.parametrize("rubbish", [0.0, -1.0, np.nan, np.inf, -np.inf])
def test_what_is_no_distance_is_unknown(rubbish):
    depth = measured_depth(np.array([[rubbish, 3.0]], np.float32), CAMERA)
    assert depth.valid.tolist() == [[False, True]]
    assert not depth.sky.any()


@pytest.mark.parametrize(
    ("sizes", "complaint"),
    [
        ({"image_size": (9, 6)}, r"a\.png: wanted 8x6.*got 9x6"),
        ({"depth_size": (8, 5)}, r"depth\.png: wanted 8x6.*got 8x5"),
    ],
)
def test_a_file_of_another_size_is_named(tmp_path, sizes, complaint):
    with pytest.raises(InputError, match=complaint):
        pairs_of(tmp_path, **sizes)[0]


def test_a_damaged_file_is_named(tmp_path):
    pairs = pairs_of(tmp_path)
    whole = (tmp_path / "depth.png").read_bytes()
    (tmp_path / "depth.png").write_bytes(whole[:-20])
    with pytest.raises(InputError, match=r"depth\.png"):
        pairs[0]


def test_blank_lines_are_passed_over_but_counted(tmp_path):
    path = tmp_path / "list.txt"
    path.write_text("a b\n\n  c\td \n")
    first, second = lines(path)
    assert (first.words, second.words) == (("a", "b"), ("c", "d"))
    assert second.where == f"{path}, line 3"


@pytest.mark.parametrize(
    ("content", "complaint"),
    [(None, "no such list"), (b" \n", "wanted .* it is empty"), (b"\xff\xfe\x00", "wanted a list")],
)
def test_a_list_that_is_none_is_named(tmp_path, content, complaint):
    path = tmp_path / "list.txt"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=rf"list\.txt: {complaint}"):
        lines(path)
