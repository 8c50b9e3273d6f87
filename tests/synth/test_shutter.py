import numpy as np
import pytest

from flexdepth.synth.shutter import smeared

HEIGHT, WIDTH = 24, 60


def flat(value):
    return np.full((HEIGHT, WIDTH), value, np.float32)


def stripe(first, last):
    light = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    light[:, first:last] = 1
    return light


def moving(pixels, where=slice(None)):
    flow = np.zeros((HEIGHT, WIDTH, 2), np.float32)
    flow[:, where, 0] = pixels
    return flow


def straight(flow, share):
    """The way of what goes evenly along its flow while the shutter is open for this share of it."""
    return lambda time: time * share / 2 * flow


def test_what_stands_still_or_a_closed_shutter_leaves_the_light_alone():
    light = stripe(20, 30)
    assert np.array_equal(smeared(light, flat(2.0), straight(moving(0.0), 0.5)), light)
    assert np.array_equal(smeared(light, flat(2.0), straight(moving(9.0), 0.0)), light)


def test_an_edge_is_as_wide_as_the_way_that_it_goes_while_the_shutter_is_open():
    light = stripe(30, WIDTH)
    # 16 pixels a frame, open for half of it: 8 pixels, 4 to either side of the edge at 30.
    row = smeared(light, flat(2.0), straight(moving(16.0), 0.5))[12, :, 0]
    between = np.flatnonzero((row > 0.02) & (row < 0.98))
    assert len(between) == pytest.approx(8, abs=1)
    assert between.mean() == pytest.approx(29.5, abs=0.6)
    assert (np.diff(row) >= -1e-6).all()


def test_what_moves_along_an_edge_does_not_blur_it():
    light = stripe(30, WIDTH)
    down = moving(0.0)
    down[..., 1] = 16.0
    assert smeared(light, flat(2.0), straight(down, 0.5)) == pytest.approx(light, abs=1e-6)


def test_a_near_thing_that_moves_spreads_over_what_stands_behind_it():
    depth = flat(5.0)
    depth[:, 25:35] = 1.0
    seen = smeared(stripe(25, 35), depth, straight(moving(12.0, slice(25, 35)), 0.5))[12, :, 0]
    assert seen[23] > 0.05
    assert seen[36] > 0.05
    assert seen[26] < 0.95
    assert seen[30] == pytest.approx(1, abs=1e-6)
    assert seen[15] == seen[45] == 0


def test_what_moves_behind_a_near_thing_does_not_spread_over_it():
    depth = flat(5.0)
    depth[:, 25:35] = 1.0
    light = 1 - stripe(25, 35)
    flow = moving(12.0)
    flow[:, 25:35] = 0
    seen = smeared(light, depth, straight(flow, 0.5))[12, 25:35, 0]
    assert seen == pytest.approx(np.zeros(10), abs=1e-6)


def test_unknown_flow_and_sky_are_no_obstacle():
    flow = moving(12.0)
    flow[:5] = np.nan
    seen = smeared(stripe(20, 40), flat(np.inf), straight(flow, 0.5))
    assert np.isfinite(seen).all()


def test_the_blur_of_a_bent_way_is_where_it_went():
    """A point of light that goes right and then down lights an angle."""
    light = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    light[10, 20] = 1

    def bent(time):
        way = np.zeros((HEIGHT, WIDTH, 2), np.float32)
        way[...] = 8 * min(time, 0), 8 * max(time, 0)
        return way

    row, column = np.nonzero(smeared(light, flat(2.0), bent)[..., 0])
    assert ((row == 10) | (column == 20)).all()
    assert (column.min(), column.max(), row.min(), row.max()) == (12, 20, 10, 18)


def test_a_gap_that_a_near_thing_leaves_shows_what_is_far():
    """A near square goes by 12 pixels, so that its cover falls by a twelfth with each pixel.

    What is seen is the mean of twelve times.
    """
    depth = flat(5.0)
    depth[:, 20:40] = 1.0
    seen = smeared(stripe(20, 40), depth, straight(moving(12.0, slice(20, 40)), 1.0))[12, :, 0]
    assert seen[14:26] == pytest.approx(np.linspace(1 / 24, 23 / 24, 12), abs=1 / 12)
    assert seen[34:46] == pytest.approx(np.linspace(23 / 24, 1 / 24, 12), abs=1 / 12)


def test_an_obstacle_in_a_moving_picture_keeps_its_width():
    """A near post before a far wall that passes: none of the post is left on the wall."""
    depth = flat(5.0)
    depth[:, 25:35] = 1.0
    flow = moving(12.0)
    flow[:, 25:35] = 0
    seen = smeared(stripe(25, 35), depth, straight(flow, 1.0))[12, :, 0]
    assert np.array_equal(seen, stripe(25, 35)[12, :, 0])
