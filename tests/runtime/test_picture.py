import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.runtime.colour import SKY, Limits
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.picture import NARROWEST_LEGEND, panels, preview, round_numbers


def ramp(height, width, space=Space.METRIC, low=1.0, high=20.0):
    row = np.geomspace(low, high, width, dtype=np.float32)
    return DepthMap(np.tile(row, (height, 1)), space)


def legend(depth_map, shown=None):
    return preview(depth_map, shown)[depth_map.values.shape[0] :]


def ticks(strip):
    """The columns of the marks: the dark groups just below the bar, which ends at half height."""
    columns = np.flatnonzero((strip[len(strip) // 2 + 2] < 100).all(-1))
    return [group.mean() for group in np.split(columns, np.flatnonzero(np.diff(columns) > 1) + 1)]


def ends_of_bar(strip):
    """The first and last column of the bar."""
    columns = np.flatnonzero((strip[len(strip) * 3 // 8] != 255).any(-1))
    return columns[0], columns[-1]


@given(st.integers(1, 200), st.integers(1, 200), st.sampled_from(Space))
def test_the_picture_keeps_its_size_and_the_legend_lies_below(height, width, space):
    depth_map = ramp(height, width, space) if width > 1 else ramp(height, 1, space, 2, 2)
    found = preview(depth_map)
    assert found.dtype == np.uint8
    assert found.shape[1:] == (width, 3)
    assert (found.shape[0] > height) == (width >= NARROWEST_LEGEND)


@pytest.mark.parametrize(("width", "words"), [(63, False), (64, True)])
def test_a_legend_begins_at_64_pixels(width, words):
    assert bool(legend(ramp(48, width)).size) is words


def test_the_bar_runs_from_the_nearest_colour_to_the_farthest():
    strip = legend(ramp(480, 640), Limits(1, 30))
    left, right = ends_of_bar(strip)
    near, far = preview(DepthMap(np.array([[1, 30]], np.float32), Space.METRIC))[0]
    np.testing.assert_array_equal(strip[len(strip) * 3 // 8, [left, right]], [near, far])


def test_the_marks_stand_where_their_metres_are():
    strip = legend(ramp(480, 640), Limits(1, 30))
    left, right = ends_of_bar(strip)
    metres = np.array([1, 2, 5, 10, 20])
    expected = left + (right - left) * np.log(metres) / np.log(30)
    np.testing.assert_allclose(ticks(strip), expected, atol=1)


def test_a_mark_has_the_colour_that_its_depth_has_in_the_picture():
    depth_map = ramp(480, 640, low=1, high=30)
    depth_map.values[0] = 10.0
    found = preview(depth_map, Limits(1, 30))
    strip = found[480:]
    ten = round(ticks(strip)[3])
    np.testing.assert_allclose(strip[len(strip) * 3 // 8, ten], found[0, 0], atol=4)


def test_where_words_have_no_room_there_are_fewer():
    shown = Limits(0.1, 1000)
    assert len(ticks(legend(ramp(48, 1200), shown))) == 13
    narrow = ticks(legend(ramp(48, 100), shown))
    # Letters of 10 pixels: "10 m" is some 20 wide.
    assert np.diff(narrow).min() > 20


@pytest.mark.parametrize("space", [Space.SCALE, Space.AFFINE_DEPTH, Space.AFFINE_DISPARITY])
def test_what_is_not_metric_has_the_same_legend_whatever_its_numbers(space):
    one, other = ramp(100, 200, space, 1, 5), ramp(100, 200, space, 10, 90)
    np.testing.assert_array_equal(legend(one), legend(other))
    assert len(ticks(legend(one))) == 2


def test_metres_are_written_on_metric_legends_only():
    differing = legend(ramp(100, 200)) != legend(ramp(100, 200, Space.SCALE))
    assert differing.any()


def test_sky_is_explained_where_there_is_sky():
    depth_map = ramp(100, 200)
    assert not (legend(depth_map) == SKY).all(-1).any()
    depth_map.values[:10] = np.inf
    assert (legend(depth_map) == SKY).all(-1).any()


def test_a_picture_of_sky_alone_has_a_legend_of_sky_alone():
    depth_map = DepthMap(np.full((100, 200), np.inf, np.float32), Space.METRIC)
    found = preview(depth_map)
    assert (found[:100] == SKY).all()
    strip = found[100:]
    assert (strip[:, :100] == 255).all()
    assert (strip == SKY).all(-1).any()


def test_the_frames_of_a_clip_share_size_and_legend():
    shown = Limits(1, 20, sky=True)
    clear, cloudy = ramp(90, 160), ramp(90, 160, low=2, high=7)
    clear.values[:30] = np.inf
    np.testing.assert_array_equal(legend(clear, shown), legend(cloudy, shown))


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0.9, 12.0, [1, 2, 5, 10]),
        (4.0, 80.0, [5, 10, 20, 50]),
        (0.04, 0.3, [0.05, 0.1, 0.2]),
        (2.02, 2.31, [2.1, 2.2, 2.3]),
        (2.95, 9.1, [4, 6, 8]),
        (100.0, 101.0, [100, 100.5, 101]),
    ],
)
def test_round_numbers_are_those_a_person_would_choose(low, high, expected):
    assert sorted(round_numbers(low, high)) == expected


@given(st.floats(1e-3, 1e4), st.floats(1.001, 1e4))
def test_round_numbers_lie_in_the_range_and_are_at_least_three(low, ratio):
    found = round_numbers(low, low * ratio)
    assert len(found) == len(set(found)) >= 3
    assert all(low * (1 - 1e-9) <= value <= low * ratio * (1 + 1e-9) for value in found)


def test_panels_stand_side_by_side_at_the_width_of_the_widest():
    red = np.full((50, 100, 3), (255, 0, 0), np.uint8)
    blue = np.full((25, 50, 3), (0, 0, 255), np.uint8)
    found = panels([red, blue], ["one", "a title far too long for so small a picture"])
    assert (found == (255, 0, 0)).all(-1).sum() == 50 * 100
    assert (found == (0, 0, 255)).all(-1).sum() == 50 * 100
    assert (found[-1, 0] == (255, 0, 0)).all()
    assert (found[-1, -1] == (0, 0, 255)).all()
    head = found[: found.shape[0] - 50]
    assert (head < 100).all(-1)[:, :100].any()
    assert not (head < 200).all(-1)[:, 100:105].any()


@pytest.mark.parametrize(("pictures", "titles"), [([], []), ([np.zeros((2, 2, 3), np.uint8)], [])])
def test_panels_need_one_title_for_each_picture(pictures, titles):
    with pytest.raises(InputError, match="one title for each"):
        panels(pictures, titles)
