import numpy as np
import pytest

from flexdepth.data.folder import Pair
from flexdepth.data.registration import REACH, agreement, reduction
from flexdepth.runtime.depthmap import DepthMap, Space


def board(space=Space.METRIC, width=400, height=300, near=1.0, known=1.0):
    """Return a bright rectangle 1 m before a dark wall at 2 m."""
    values = np.full((height, width), 2.0, np.float32)
    values[height // 4 : height // 2, width // 4 : width // 2] = near
    image = np.repeat((255 - 100 * values)[..., None].clip(0, 255), 3, axis=2).astype(np.uint8)
    drawn = np.random.default_rng(1).random(values.shape) < known
    return image, np.where(drawn, values, np.float32(np.nan)), space


def best_shift(image, values, space):
    found = agreement(Pair("a", image, DepthMap(values, space)))
    row, column = np.unravel_index(found.argmax(), found.shape)
    return column - REACH, row - REACH


@pytest.mark.parametrize("space", [Space.METRIC, Space.SCALE, Space.AFFINE_DISPARITY])
def test_depth_that_lies_on_its_picture_should_not_move(space):
    assert best_shift(*board(space)) == (0, 0)


@pytest.mark.parametrize(("right", "down"), [(8, 0), (0, 8), (-5, 3), (15, -15)])
def test_depth_that_was_moved_should_move_back(right, down):
    image, values, space = board()
    assert best_shift(image, np.roll(values, (down, right), (0, 1)), space) == (-right, -down)


def test_a_large_picture_is_searched_at_a_fraction_of_its_size():
    assert [reduction(width) for width in (320, 640, 1242, 2048)] == [1, 2, 3, 5]
    image, values, space = board(width=800, height=600)
    assert best_shift(image, np.roll(values, 8, 1), space) == (-4, 0)


def test_sparse_depth_stands_for_its_surroundings():
    right, down = best_shift(*board(known=0.3))
    assert max(abs(right), abs(down)) <= 1


def test_a_wall_without_edges_says_nothing():
    image, values, space = board(near=2.0)
    assert agreement(Pair("a", image, DepthMap(values, space))) is None
    unknown = np.full_like(values, np.nan)
    assert agreement(Pair("a", image, DepthMap(unknown, space))) is None


def test_the_mean_over_all_shifts_of_a_gradient_without_edges_is_small():
    image, values, space = board()
    noise = np.random.default_rng(2).integers(0, 255, image.shape).astype(np.uint8)
    found = agreement(Pair("a", noise, DepthMap(values, space)))
    assert np.abs(found).max() < 0.6
