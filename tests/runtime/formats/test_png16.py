import numpy as np
import pytest
from PIL import Image

from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.files import read_depth, read_meaning, write_depth
from flexdepth.runtime.formats.png16 import codes, coding


def row(*values):
    return np.array([values], np.float32)


def coded(space, *values):
    chosen = coding(row(*values), space)
    return chosen.scale, chosen.offset, codes(row(*values), chosen)[0].tolist()


def test_metres_are_stored_as_millimetres():
    scale, offset, stored = coded(Space.METRIC, 1.2344, 65.534, np.nan, np.inf)
    assert (scale, offset) == (0.001, 0.0)
    assert stored == [1234, 65534, 0, 65535]


def test_a_value_below_half_a_step_stays_valid():
    assert coded(Space.METRIC, 0.0001, 0.0, 1.0)[2] == [1, 1, 1000]


@pytest.mark.parametrize("farthest", [65.535, 80.0, 131.068])
def test_metres_too_far_for_millimetres_fill_the_range(farthest):
    scale, offset, stored = coded(Space.METRIC, farthest / 2, farthest, np.inf)
    assert scale == pytest.approx(farthest / 65534)
    assert offset == 0
    assert stored == [32767, 65534, 65535]


def test_relative_depth_fills_the_range_from_zero():
    assert coded(Space.SCALE, 0.5, 1.0) == (1 / 65534, 0.0, [32767, 65534])


@pytest.mark.parametrize("space", [Space.AFFINE_DEPTH, Space.AFFINE_DISPARITY])
def test_affine_values_fill_the_range_from_the_least(space):
    scale, offset, stored = coded(space, -3.0, 65530.0, np.nan)
    assert (scale, offset) == (1.0, -4.0)
    assert stored == [1, 65534, 0]


@pytest.mark.parametrize("value", [0.0, -2.5, 1e-30])
@pytest.mark.parametrize("space", [Space.SCALE, Space.AFFINE_DISPARITY])
def test_a_constant_map_survives(tmp_path, value, space):
    write_depth(tmp_path / "a.png", DepthMap(row(value, value), space), None)
    # Of 1e-30 nothing more is asked than that it stays small: its step is 1.
    np.testing.assert_allclose(read_depth(tmp_path / "a.png").values, value, atol=1e-29)


def test_the_widest_range_of_float32_survives(tmp_path):
    widest = np.finfo(np.float32).max
    write_depth(tmp_path / "a.png", DepthMap(row(-widest, widest), Space.AFFINE_DEPTH), None)
    np.testing.assert_allclose(
        read_depth(tmp_path / "a.png").values, row(-widest, widest), rtol=1e-6
    )


def test_a_map_without_a_finite_value_survives(tmp_path):
    for space, sky in ((Space.METRIC, np.inf), (Space.AFFINE_DISPARITY, -np.inf)):
        write_depth(tmp_path / "a.png", DepthMap(row(np.nan, sky), space), None)
        np.testing.assert_array_equal(read_depth(tmp_path / "a.png").values, row(np.nan, sky))


def test_the_text_chunk_states_the_reserved_codes(tmp_path):
    write_depth(tmp_path / "a.png", DepthMap(row(1.0), Space.METRIC), None)
    said = read_meaning(tmp_path / "a.png")
    assert (said["scale"], said["invalid"], said["sky"]) == (0.001, 0, 65535)
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.text["flexdepth"].startswith('{"version": 1, "quantity": "depth"')
