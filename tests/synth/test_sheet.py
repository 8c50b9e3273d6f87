import numpy as np
import pytest

from flexdepth.runtime.images import read_photo
from flexdepth.synth.generate import SynthSettings, write_image
from flexdepth.synth.sheet import flow_colours, write_image_sheet


def test_flow_to_the_right_is_red_to_the_left_is_cyan_and_still_is_white():
    flow = np.array([[(5.0, 0.0), (-5.0, 0.0), (0.0, 0.0), (np.nan, np.nan)]])
    colours = flow_colours(np.repeat(flow, 3, 0))
    assert colours[0, 0] == pytest.approx([255, 0, 0], abs=2)
    assert colours[0, 1] == pytest.approx([0, 255, 255], abs=2)
    assert colours[0, 2] == pytest.approx([255, 255, 255])
    assert colours[0, 3] == pytest.approx([0, 0, 0])


def test_no_flow_at_all_is_white():
    assert (flow_colours(np.zeros((2, 2, 2))) == 255).all()


def test_a_sheet_of_images_has_each_above_its_depth(tmp_path):
    settings = SynthSettings(seed=3, width=64, height=48)
    for index in range(3):
        write_image(settings, index, tmp_path)
    sheet = read_photo(write_image_sheet(tmp_path, 3)).pixels
    assert sheet.shape == (240, 3 * 160, 3)
