from math import isnan, nan

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.runtime.colour import SKY, UNKNOWN, Limits, coloured, limits, merged
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError


def of(values, space=Space.METRIC):
    return DepthMap(np.atleast_2d(np.asarray(values, np.float32)), space)


def lightness(picture):
    return cv2.cvtColor(picture, cv2.COLOR_RGB2LAB)[..., 0].astype(int)


def test_limits_leave_out_the_rarest_hundredth_at_either_end():
    found = limits(of(np.arange(1, 102)))
    assert (found.nearest, found.farthest, found.sky) == (2, 100, False)


def test_limits_of_disparity_begin_at_the_largest():
    found = limits(of(np.arange(1, 102), Space.AFFINE_DISPARITY))
    assert (found.nearest, found.farthest) == (100, 2)


def test_limits_heed_neither_sky_nor_the_unknown_nor_what_lies_behind():
    found = limits(of([np.inf, np.nan, -3, 0, *np.linspace(2, 4, 101)]))
    assert found.nearest == pytest.approx(2.02)
    assert found.farthest == pytest.approx(3.98)
    assert found.sky


@pytest.mark.parametrize("space", list(Space))
@pytest.mark.parametrize("value", [2.0, 0.0, -5.0])
def test_limits_of_a_single_value_have_it_between_them(space, value):
    if value <= 0 and space in (Space.METRIC, Space.SCALE):
        assert limits(of([value], space)).empty
        return
    found = limits(of([value], space))
    assert min(found.nearest, found.farthest) < value < max(found.nearest, found.farthest)
    assert (found.nearest > found.farthest) == (space is Space.AFFINE_DISPARITY)


def test_limits_of_a_map_of_sky_are_empty():
    found = limits(of([np.inf, np.inf]))
    assert found.empty
    assert isnan(found.farthest)
    assert found.sky


def test_merged_limits_hold_all():
    each = [Limits(2, 5), Limits(nan, nan, sky=True), Limits(1, 3), Limits(4, 9)]
    assert merged(each) == Limits(1, 9, sky=True)
    assert merged([Limits(5, 2), Limits(3, 1)]) == Limits(5, 1)
    assert merged([]).empty


@pytest.mark.parametrize("ends", [(1, 1), (1, nan), (nan, 1)])
def test_limits_without_length_are_refused(ends):
    with pytest.raises(InputError, match="two different ends"):
        Limits(*ends)


@given(st.sampled_from(Space), st.floats(0.01, 10), st.floats(1.1, 1000))
def test_the_nearer_is_never_the_darker(space, low, ratio):
    values = np.geomspace(low, low * ratio, 50)
    if space is Space.AFFINE_DISPARITY:
        values = values[::-1]
    ends = Limits(float(values[0]), float(values[-1]))
    light = lightness(coloured(of(values, space), ends))[0]
    assert (np.diff(light) <= 0).all()
    assert light[0] > 240
    assert light[-1] < 15


def test_metres_are_coloured_by_their_ratio_and_affine_depth_by_its_difference():
    ends = Limits(1, 100)
    metres = coloured(of([1, 10, 100]), ends)
    affine = coloured(of([1, 50.5, 100], Space.AFFINE_DEPTH), ends)
    np.testing.assert_array_equal(metres, affine)


def test_beyond_the_limits_the_colours_stay():
    picture = coloured(of([0.1, 1, 2, 50]), Limits(1, 2))
    np.testing.assert_array_equal(picture[0, 0], picture[0, 1])
    np.testing.assert_array_equal(picture[0, 2], picture[0, 3])


@pytest.mark.parametrize("space", list(Space))
def test_sky_and_the_unknown_have_their_own_colours(space):
    sky = -np.inf if space is Space.AFFINE_DISPARITY else np.inf
    values = np.append(np.linspace(1, 9, 500), [sky, np.nan])
    picture = coloured(of(values, space), limits(of(values, space)))
    assert tuple(picture[0, -2]) == SKY
    assert tuple(picture[0, -1]) == UNKNOWN
    depths = picture[0, :-2].astype(int)
    for own in (SKY, UNKNOWN):
        assert abs(depths - np.array(own)).max(-1).min() > 40


def test_metres_need_positive_limits():
    with pytest.raises(InputError, match="> 0"):
        coloured(of([1, 2]), Limits(0, 2))


@pytest.mark.parametrize("space", list(Space))
def test_limits_the_wrong_way_round_are_refused(space):
    ends = Limits(1, 2) if space is Space.AFFINE_DISPARITY else Limits(2, 1)
    with pytest.raises(InputError, match="exchange"):
        coloured(of([1, 2], space), ends)
