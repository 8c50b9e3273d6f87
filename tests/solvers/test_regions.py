"""Which pieces of a frame move by themselves, and which of them together."""

import numpy as np
import pytest

from flexdepth.solvers.borders import goes_on
from flexdepth.solvers.ordering import Still, with_sunk
from flexdepth.solvers.regions import moving_regions
from flexdepth.solvers.sight import Sight
from flexdepth.solvers.two_view import Along

HEIGHT, WIDTH = 48, 64
MIDDLE = np.s_[24:28, 20:44]
"""A strip across a thing that fills rows 10 to 42, columns 20 to 44."""


def found(flow_of_strip, flow_of_thing=(6.0, 0.0)):
    """Return the labels of a thing that is off the epipolar lines but for a strip across it.

    A still piece lies below it.
    """
    cut = np.arange(12).repeat(HEIGHT * WIDTH // 12).reshape(HEIGHT, WIDTH).astype(np.int32)
    cut[10:42, 20:44], cut[MIDDLE], cut[28:42, 20:44] = 12, 13, 14
    cut[42:46, 20:44] = 15
    flow = np.zeros((HEIGHT, WIDTH, 2))
    flow[10:42, 20:44] = flow_of_thing
    flow[MIDDLE] = flow_of_strip
    across = np.zeros((HEIGHT, WIDTH))
    across[10:42, 20:44], across[MIDDLE] = 3.0, 0.0
    ones = np.ones((HEIGHT, WIDTH))
    along = Along(ones, across, ones, ones)
    return moving_regions(cut, flow, along, 0.05 * ones, np.ones((HEIGHT, WIDTH), bool)).labels


def test_a_strip_that_seems_still_is_of_the_thing_from_which_alone_flow_goes_on():
    labels = found((6.0, 0.0))
    assert (labels[10:42, 20:44] == 1).all()
    assert (labels == 1).sum() == 32 * 24


def test_a_piece_into_which_flow_goes_on_from_the_still_world_too_stays_still():
    labels = found((0.5, 0.0), flow_of_thing=(0.5, 0.0))
    assert (labels[10:42, 20:44] == 1).all()
    assert (labels[42:46, 20:44] == 0).all()


@pytest.mark.parametrize("flow", [(0.0, 0.0), (30.0, 0.0)])
def test_what_moves_as_the_world_around_or_as_nothing_around_stays_still(flow):
    labels = found(flow)
    assert (labels[MIDDLE] == 0).all()
    assert (labels[10:24, 20:44] > 0).all()


@pytest.mark.parametrize(("jump", "same"), [(1.0, True), (3.0, False)])
def test_motion_goes_on_where_flow_does_not_jump(jump, same):
    first, second = np.zeros((2, 30, 40), bool)
    first[5:25, 10:20], second[5:25, 20:30] = True, True
    flow = np.zeros((30, 40, 2))
    flow[:, 20:, 1] = jump
    assert goes_on(first, second, flow) is same
    # A third of the border is enough.
    flow[5:12] = 0.0
    assert goes_on(first, second, flow)


def test_motion_does_not_go_on_between_regions_that_do_not_touch():
    first, second = np.zeros((2, 30, 40), bool)
    first[5:25, 10:18], second[5:25, 22:30] = True, True
    assert not goes_on(first, second, np.zeros((30, 40, 2)))


@pytest.mark.parametrize(("nearness", "still"), [(0.3, False), (1.0, True)])
def test_a_strip_that_would_be_still_behind_the_ground_is_of_the_thing(nearness, still):
    """The camera is 1 above a floor; the strip's inverse depth is a part of the floor's."""
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    key = np.stack([(column - WIDTH / 2) / 60, (row - 8) / 60, np.ones_like(row)], -1)
    inverse = np.maximum(key[..., 1], 0.01)
    cut = np.zeros((HEIGHT, WIDTH), np.int32)
    cut[14:42, 20:44] = 1
    cut[MIDDLE] = 2
    labels = (cut == 1).astype(np.int32)
    inverse[MIDDLE] *= nearness
    flow = np.zeros((HEIGHT, WIDTH, 2))
    flow[14:42, 20:44] = 6.0
    ones, all_of_it = np.ones((HEIGHT, WIDTH)), np.ones((HEIGHT, WIDTH), bool)
    along = Along(9 * ones, 0 * ones, inverse, ones)
    sight = Sight(key, key, flow, 0.05 * ones, all_of_it, np.array([60.0, 60.0]))
    found = with_sunk(Still(cut, labels, along), sight)
    assert (found[MIDDLE] == (0 if still else 1)).all()
    assert (found[cut != 2] == labels[cut != 2]).all()
