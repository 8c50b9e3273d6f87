import numpy as np
import pytest

from flexdepth.flow.field import given
from flexdepth.runtime.errors import InputError
from flexdepth.scenes.stereo import right_view


def shifted(across, down):
    flow = np.empty((40, 50, 2), np.float32)
    flow[...] = across, down
    return given(flow, (50, 40), 0.2)


def test_what_lies_farther_left_in_the_right_picture_is_taken_as_it_is():
    stereo, notes = right_view(shifted(-8, 0.3), 0.54, "right.png")
    assert stereo.baseline == 0.54
    assert (stereo.flow[..., 0] == -8).all()
    assert notes == ()


def test_the_left_picture_is_not_taken_for_the_right_one():
    with pytest.raises(InputError, match=r"left\.png: things lie farther right in it"):
        right_view(shifted(8, 0), 0.54, "left.png")


def test_pictures_that_are_not_rectified_are_said_to_be():
    _, notes = right_view(shifted(-8, 4), 0.54, "right.png")
    assert "4.0 px higher or lower" in notes[0]
