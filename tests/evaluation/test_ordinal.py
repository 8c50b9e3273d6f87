import numpy as np
import pytest

from flexdepth.evaluation.ordinal import OrdinalPairs, whdr
from flexdepth.runtime.errors import InputError

DEPTH = np.array([[1.0, 2.0], [2.1, np.inf]])
A, B, C, SKY = (0, 0), (0, 1), (1, 0), (1, 1)


def pairs(*said):
    first, second, order = zip(*said, strict=True)
    return OrdinalPairs(np.array(first), np.array(second), np.array(order))


def test_it_is_the_share_of_pairs_in_the_wrong_order():
    # 1 m is nearer than 2 m: right; 2 m is not farther than 2.1 m: wrong; not equal: wrong.
    assert whdr(DEPTH, pairs((A, B, -1), (B, C, 1), (B, C, 0), (C, A, 1))) == 0.5


def test_a_tolerance_makes_neighbours_in_depth_equal():
    # 2.1 / 2 is 1.05.
    assert whdr(DEPTH, pairs((B, C, 0)), tolerance=0.06) == 0
    assert whdr(DEPTH, pairs((B, C, 0)), tolerance=0.04) == 1
    assert whdr(DEPTH, pairs((C, B, 0)), tolerance=0.06) == 0


def test_weights_say_how_much_a_pair_counts():
    assert whdr(DEPTH, pairs((A, B, -1), (A, B, 1)), weights=np.array([3.0, 1.0])) == 0.25


def test_sky_is_farther_than_anything_and_as_far_as_sky():
    assert whdr(DEPTH, pairs((SKY, C, 1), (A, SKY, -1), (SKY, SKY, 0))) == 0


def test_a_factor_and_any_rising_change_of_depth_keep_the_order():
    known = pairs((A, B, -1), (B, C, -1))
    assert whdr(np.log(DEPTH), known) == whdr(3 * DEPTH, known) == 0


def test_what_cannot_be_scored_is_refused():
    with pytest.raises(InputError, match="no pair of points"):
        whdr(DEPTH, OrdinalPairs(np.zeros((0, 2), int), np.zeros((0, 2), int), np.zeros(0)))
    with pytest.raises(InputError, match="outside the depth map of 2x2"):
        whdr(DEPTH, pairs((A, (0, 2), 1)))
    with pytest.raises(InputError, match="no depth at a point"):
        whdr(np.where(DEPTH > 2, np.nan, DEPTH), pairs((A, C, 1)))
    with pytest.raises(InputError, match="needs depth > 0"):
        whdr(DEPTH - 5, pairs((A, B, 1)), tolerance=0.1)
    with pytest.raises(InputError, match="order of two points is 1"):
        pairs((A, B, 2))
    with pytest.raises(InputError, match="two points"):
        OrdinalPairs(np.zeros((2, 2), int), np.zeros((1, 2), int), np.ones(2))
