"""Which pieces of a frame move by themselves, and which of them together."""

from statistics import NormalDist

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


def strewn(off_of_piece, noise, size=np.s_[10:42, 20:44], times=1.0):
    """Return the labels of a still world, flow with noise, with one piece that is off its lines.

    Args:
        off_of_piece: Pixels off the epipolar lines, as a function of the piece's rows x columns.
        noise: Pixels.
        size: Where the piece is.
        times: The piece's noise, in that of the others.
    """
    cut = np.arange(12).repeat(HEIGHT * WIDTH // 12).reshape(HEIGHT, WIDTH).astype(np.int32)
    cut[size] = 12
    each = [NormalDist().inv_cdf((k + 0.5) / WIDTH) for k in range(WIDTH)]
    across = noise * np.random.default_rng(0).permuted(np.tile(each, (HEIGHT, 1)), axis=1)
    across[size] = times * across[size] + off_of_piece(*np.indices(cut[size].shape))
    ones = np.ones((HEIGHT, WIDTH))
    said = max(noise, 0.01) * np.where(cut == 12, times, 1.0)
    flow = np.zeros((HEIGHT, WIDTH, 2))
    everywhere = np.ones((HEIGHT, WIDTH), bool)
    along = Along(ones, across, ones, ones)
    return moving_regions(cut, flow, along, said, everywhere).labels


@pytest.mark.parametrize(("noise", "sways"), [(0.0, 0.2), (0.05, 0.4)])
def test_cloth_that_is_off_its_lines_to_both_sides_alike_moves(noise, sways):
    labels = strewn(lambda row, _: sways * np.sin(2 * np.pi * row / 16), noise)
    assert (labels[10:42, 20:44] == 1).all()
    assert (labels == 1).sum() == 32 * 24


def test_noise_that_is_told_too_small_moves_nothing():
    """Half as much again: noise of .05 with .08 to either side in turn."""
    labels = strewn(lambda row, _: 0.08 * (-1.0) ** row, 0.05)
    assert (labels == 0).all()


@pytest.mark.parametrize("noise", [0.0, 0.05, 0.5])
@pytest.mark.parametrize("times", [1.0, 4.0])
def test_noise_that_is_told_moves_nothing(noise, times):
    assert (strewn(lambda row, _: 0.0 * row, noise, times=times) == 0).all()


def test_a_piece_of_which_a_third_is_of_something_that_moves_stays_still():
    labels = strewn(lambda row, _: np.where(row < 5, 3.0, 0.0), 0.05, np.s_[10:26])
    assert (labels == 0).all()


@pytest.mark.parametrize(("size", "moves"), [(32, True), (5, False)])
def test_what_is_off_a_little_moves_if_many_pixels_say_so(size, moves):
    """.075 pixels, of noise .05: of 5 x 5 pixels the median strays by .0125, which is a sixth."""
    labels = strewn(lambda row, _: 0.075 + 0.0 * row, 0.05, np.s_[10 : 10 + size, 26 : 26 + size])
    assert (labels > 0).any() == moves


@pytest.mark.parametrize(("columns", "number"), [(30, 1), (44, 1), (50, 0)])
@pytest.mark.parametrize("piece", [0, 2])
def test_the_little_that_moves_is_of_the_thing_that_it_touches(columns, number, piece):
    """Inside the thing, at its rim, or away from it; left in a still piece, or a piece itself.

    Flow leaps between the two, as on a ball that spins.
    """
    cut = np.zeros((HEIGHT, WIDTH), np.int32)
    little = np.s_[20:26, columns : columns + 2]
    thing = np.zeros((HEIGHT, WIDTH), bool)
    thing[10:42, 20:44] = True
    cut[thing], cut[little] = 1, piece
    moves = thing.copy()
    moves[little] = True
    flow = np.where(thing[..., None], [6.0, 0.0], 0.0)
    flow[little] = 12.0, 0.0
    ones = np.ones((HEIGHT, WIDTH))
    along = Along(ones, np.where(moves, 3.0, 0.0), ones, ones)
    labels = moving_regions(cut, flow, along, 0.05 * ones, ones > 0).labels
    assert (labels[thing] == 1).all()
    assert (labels[~moves] == 0).all()
    assert (labels[little] == number).all()


@pytest.mark.parametrize("leaves", [False, True])
def test_what_has_sunk_into_the_ground_moves_unless_the_picture_cuts_it_off(leaves):
    """The camera is 1 above a floor; a box seems twice as far as the floor at its foot.

    Where the box leaves the picture, flow is not to be trusted.
    """
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    key = np.stack([(column - WIDTH / 2) / 60, (row - 8) / 60, np.ones_like(row)], -1)
    inverse = np.maximum(key[..., 1], 0.01)
    cut, trusted = np.zeros((HEIGHT, WIDTH), np.int32), np.ones((HEIGHT, WIDTH), bool)
    box = np.s_[20:36, 0 if leaves else 4 : 20]
    cut[box] = 1
    trusted[:, :4] = False
    inverse[box] = 0.5 * key[35, 0, 1]
    flow = np.zeros((HEIGHT, WIDTH, 2))
    flow[box] = 6.0
    ones = np.ones((HEIGHT, WIDTH))
    along = Along(9 * ones, 0 * ones, inverse, ones)
    sight = Sight(key, key, flow, 0.05 * ones, trusted, np.array([60.0, 60.0]))
    found = with_sunk(Still(cut, np.zeros_like(cut), along), sight)
    assert (found[box] == (0 if leaves else 1)).all()
    assert (found[cut == 0] == 0).all()
