import re
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.runtime.depthmap import FocalSource
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.lens import FieldOfView, FocalLength, Said, intrinsics

SILENT = Said()


def test_what_the_user_says_comes_before_what_the_photo_says():
    camera = intrinsics(640, 480, FocalLength(525), Said(0.6, 0.8))
    assert (camera.focal_x, camera.focal_y, camera.source) == (525, 525, FocalSource.GIVEN)
    assert (camera.centre_x, camera.centre_y) == (320, 240)


def test_a_field_of_view_of_90_degrees_is_half_the_width():
    camera = intrinsics(640, 480, FieldOfView(90), SILENT)
    assert camera.focal_x == pytest.approx(320)
    assert camera.source is FocalSource.GIVEN


def test_what_the_file_says_comes_before_what_a_network_sees():
    camera = intrinsics(30, 40, None, Said(0.6, 0.8))
    assert camera.focal_x == pytest.approx(30)
    assert camera.source is FocalSource.EXIF


def test_what_a_network_sees_comes_before_the_assumption():
    camera = intrinsics(30, 40, None, Said(None, 0.8))
    assert camera.focal_x == pytest.approx(40)
    assert camera.source is FocalSource.PREDICTED


def test_a_landscape_photo_that_says_nothing_is_taken_to_see_60_degrees():
    camera = intrinsics(640, 480, None, SILENT)
    assert camera.focal_x == pytest.approx(320 * 3**0.5)
    assert camera.source is FocalSource.ASSUMED


@given(st.integers(1, 9999), st.integers(1, 9999))
def test_a_photo_that_says_nothing_is_assumed_the_same_lens_when_it_is_turned(width, height):
    sizes = (width, height), (height, width)
    lying, standing = (intrinsics(*size, None, SILENT) for size in sizes)
    assert lying.focal_x == standing.focal_x


@pytest.mark.parametrize("pixels", [0, -5, nan, inf, 1e-30, 1e30])
def test_a_focal_length_that_is_none_is_refused(pixels):
    with pytest.raises(InputError, match=re.escape(f"0.001 to 1e9, got {pixels:g}")):
        FocalLength(pixels)


@pytest.mark.parametrize("degrees", [0, -5, 180, nan, inf])
def test_a_field_of_view_that_is_none_is_refused(degrees):
    with pytest.raises(InputError, match=f"between 0 and 180 degrees, got {degrees:g}"):
        FieldOfView(degrees)


def test_a_bare_number_is_no_lens():
    with pytest.raises(InputError, match="a lens is a FocalLength or a FieldOfView, got 500"):
        intrinsics(640, 480, 500, SILENT)
