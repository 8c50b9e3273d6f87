from math import log

import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.runtime.bundle import Description
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.sizes import network_size, times_larger

ABOUT = Description("compact", "0.1.0", "MIT", Space.METRIC, (384, 288), 32, 0.8, "a test")
AREA = 384 * 288


@pytest.mark.parametrize(
    ("picture", "network"),
    [
        ((640, 480), (384, 288)),
        ((480, 640), (288, 384)),
        ((4000, 3000), (384, 288)),
        ((1242, 375), (608, 192)),
        ((1920, 1080), (448, 256)),
        ((6000, 4000), (384, 256)),
        ((1000, 1000), (320, 320)),
        ((1, 1), (320, 320)),
        ((1, 5000), (32, 3456)),
        ((5000, 1), (3456, 32)),
    ],
)
def test_a_picture_keeps_its_aspect_and_the_network_its_area(picture, network):
    assert network_size(*picture, ABOUT) == network


@pytest.mark.parametrize(
    ("picture", "long_side", "network"),
    [
        ((640, 480), 512, (512, 384)),
        ((480, 640), 512, (384, 512)),
        ((640, 480), 500, (512, 384)),
        ((5000, 1), 640, (640, 32)),
        ((640, 480), 32, (32, 32)),
    ],
)
def test_a_long_side_is_kept_to_the_nearest_multiple(picture, long_side, network):
    assert network_size(*picture, ABOUT, long_side) == network


def test_a_long_side_below_one_multiple_is_refused():
    with pytest.raises(InputError, match="--long-side: wanted a number of pixels >= 32, got 31"):
        network_size(640, 480, ABOUT, 31)


sides = st.integers(1, 10**5)


@given(sides, sides)
def test_any_picture_has_a_size_that_the_network_can_take(width, height):
    across, down = network_size(width, height, ABOUT)
    assert across % 32 == down % 32 == 0
    assert min(across, down) >= 32
    assert across * down <= 1.5 * AREA


@given(st.integers(100, 10**4), st.floats(0.25, 4))
def test_an_ordinary_picture_is_not_squeezed(width, aspect):
    height = round(width / aspect)
    across, down = network_size(width, height, ABOUT)
    assert abs(log(across / down * height / width)) < log(1.15)
    assert abs(log(across * down / AREA)) < log(1.25)


def test_the_smallest_area_still_holds_one_multiple():
    tiny = Description("x", "1", "MIT", Space.METRIC, (16, 16), 32, 0.8, "a test")
    assert network_size(640, 480, tiny) == (32, 32)


def test_of_two_sizes_with_the_right_aspect_that_of_the_nearer_area_is_taken():
    about = Description("x", "1", "MIT", Space.METRIC, (350, 350), 32, 0.8, "a test")
    assert network_size(1000, 1000, about) == (352, 352)


@pytest.mark.parametrize(
    ("size", "times", "wanted"),
    [
        ((384, 288), 1, (384, 288)),
        ((384, 288), 2 / 3, (256, 192)),
        ((384, 288), 4 / 3, (512, 384)),
        ((608, 192), 2 / 3, (416, 128)),
        ((32, 3456), 1, (32, 3456)),
        ((32, 32), 2 / 3, (32, 32)),
    ],
)
def test_another_size_keeps_the_aspect_as_nearly_as_multiples_allow(size, times, wanted):
    assert times_larger(size, times, 32) == wanted
