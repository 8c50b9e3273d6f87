import numpy as np
import pytest

from flexdepth.synth.streaks import streaked

HEIGHT, WIDTH = 12, 40


def square(flow, depth=2.0):
    """Return light, depth and flow of a bright square before a dark wall at 5 m."""
    light = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    deep = np.full((HEIGHT, WIDTH), 5.0)
    moves = np.zeros((HEIGHT, WIDTH, 2))
    light[4:8, 16:24] = 1
    deep[4:8, 16:24] = depth
    moves[4:8, 16:24] = flow
    return light, deep, moves


def test_what_does_not_move_is_sharp():
    light, depth, flow = square((0, 0))
    assert (streaked(light, depth, flow, 1.0) == light).all()


def test_a_shutter_that_is_hardly_open_leaves_the_frame_as_it_is():
    light, depth, flow = square((8, 0))
    assert (streaked(light, depth, flow, 0.1) == light).all()


def test_a_thing_is_smeared_over_half_its_path_on_either_side():
    light, depth, flow = square((8, 0))
    row = streaked(light, depth, flow, 1.0)[5, :, 0]
    # Nine moments, 4 pixels to either side; the frame itself stands where nothing is known.
    assert row[:12] == pytest.approx(0)
    assert row[28:] == pytest.approx(0)
    assert row[24:28] == pytest.approx([4 / 9, 3 / 9, 2 / 9, 1 / 9], abs=1e-6)
    assert row[12:16] == pytest.approx([1 / 9, 2 / 9, 3 / 9, 4 / 9], abs=1e-6)
    assert row[16:24] == pytest.approx(1)


def test_half_the_exposure_smears_half_as_far():
    light, depth, flow = square((0, 8))
    column = streaked(light, depth, flow, 0.5)[:, 18, 0]
    assert (column > 0).sum() == 4 + 2 * 2


def test_what_is_nearer_covers_what_moves_behind_it():
    light, depth, flow = square((12, 0))
    depth[:, 26:30], light[:, 26:30] = 1.0, 0.25
    smeared = streaked(light, depth, flow, 1.0)
    assert smeared[5, 26:30, 0] == pytest.approx(0.25)
    assert smeared[5, 24, 0] > 0.3


def test_a_point_whose_way_is_unknown_stays():
    light, depth, flow = square((np.nan, np.nan))
    flow[0, 0] = 3, 0
    assert streaked(light, depth, flow, 1.0)[4:8, 16:24] == pytest.approx(1)
