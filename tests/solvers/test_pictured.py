"""What a single picture says of depth, and how far it is believed."""

import numpy as np
import pytest

from flexdepth.solvers.pictured import by_picture, pictured
from flexdepth.solvers.seen import Prior

GRID = np.arange(-15.0, 15.0, 0.01)


def spread_over(depth, doubt=0.1):
    return Prior(np.asarray(depth), np.full(np.shape(depth), doubt))


def test_what_has_no_depth_says_nothing_and_the_prior_is_left_as_it_was():
    prior = spread_over([[2.0, np.inf, np.nan, 0.0]])
    found = pictured(prior)
    np.testing.assert_array_equal(found.inverse_depth, [[0.5, np.nan, np.nan, np.nan]])
    np.testing.assert_array_equal(found.doubt, [[0.1, np.inf, np.inf, np.inf]])
    np.testing.assert_array_equal(prior.depth, [[2.0, np.inf, np.nan, 0.0]])


def test_its_unit_is_told_by_what_is_still_and_well_seen():
    picture = pictured(spread_over(np.full((4, 5), 2.0)))
    seen, spread = np.full((4, 5), 1.5), np.full((4, 5), 0.05)
    still = np.ones((4, 5), bool)
    seen[0], still[0] = 9.0, False  # moves
    seen[1], spread[1] = 7.0, 5.0  # hardly shows any parallax
    factor, _ = picture.unit(seen, spread, still)
    assert factor == pytest.approx(3.0)
    assert picture.unit(np.full((4, 5), np.nan), spread, still) is None


def test_a_thing_is_as_near_as_the_middle_of_what_is_said_of_its_pixels():
    inside = np.zeros((4, 5), bool)
    inside[1:3, 1:4] = True
    depth = np.where(inside, 2.0, 40.0)
    depth[1, 1], depth[2, 3] = 50.0, np.inf  # behind its rim
    inside[3, :2], depth[3, :2] = True, 2.0
    own = np.where(inside, 0.25, 0.0)
    at, doubt = pictured(spread_over(depth, 0.3)).of_thing(inside, own)
    assert at == pytest.approx(np.log(2.0))
    assert doubt == pytest.approx(0.3)


def test_of_a_thing_in_the_sky_nothing_is_said():
    picture = pictured(spread_over(np.full((4, 5), np.inf)))
    everywhere = np.ones((4, 5), bool)
    assert picture.of_thing(everywhere, everywhere.astype(float)) is None


@pytest.mark.parametrize("place", [0, 1])
def test_what_is_said_is_a_density(place):
    # Over what is said, at one scale; the picture's error does not depend on the scale.
    density = by_picture((0.3, 0.4), GRID)[place]
    assert density.sum() * 0.01 == pytest.approx(1.0, abs=1e-3)


def test_what_is_on_the_ground_is_where_the_picture_says_what_flies_is_nearer():
    grounded, flying = by_picture((0.3, 0.2), GRID)
    assert GRID[grounded.argmax()] == pytest.approx(0.3, abs=0.03)
    assert GRID[flying.argmax()] == pytest.approx(0.8, abs=0.011)
    # Where a thing is much nearer than said, it flies; where it is farther, it does not.
    nearer, farther = np.searchsorted(GRID, [1.8, 0.2])
    assert flying[nearer] > grounded[nearer]
    assert flying[farther] < grounded[farther]


def test_more_doubt_says_less():
    sure, unsure = (by_picture((0.0, doubt), GRID)[0] for doubt in (0.0, 1.0))
    assert sure.max() > 2 * unsure.max()


def test_what_flies_before_the_sky_is_not_drawn_into_it():
    # Said to be 30 and 60 times as far as it may be: hardly a reason to put it any farther.
    _, flying = by_picture((0.0, 0.2), GRID)
    near, nearer = np.searchsorted(GRID, np.log([30.0, 60.0]))
    assert flying[near] < 3 * flying[nearer]
