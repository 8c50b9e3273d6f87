"""Two estimates of depth and their spreads, by numbers worked out by hand."""

import numpy as np
import pytest

from flexdepth.solvers.fusion import fused, measured_spread


def estimate(inverse, spread):
    return np.array([inverse]), np.array([spread])


# 1 - .36 = .8²; .6 is just what six deviations of .1 explain.
@pytest.mark.parametrize(("apart", "shown"), [(0.0, 0.2), (0.6, 0.2), (1.0, 0.8), (-1.0, 0.8)])
def test_what_one_depth_does_not_explain_is_the_others_error(apart, shown):
    found = measured_spread(estimate(2.0, 0.1), estimate(2.0 * np.exp(apart), 0.2))
    np.testing.assert_allclose(found, shown, rtol=1e-12)


@pytest.mark.parametrize(
    "unknown",
    [(np.nan, 0.01), (0.0, 0.01), (-1.0, 0.01), (2.0, np.inf)],
)
def test_where_a_depth_is_not_known_nothing_shows_of_the_others_error(unknown):
    assert measured_spread(estimate(*unknown), estimate(9.0, 0.2)) == 0.2


@pytest.mark.parametrize("nothing", [np.nan, 0.0])
def test_what_says_no_depth_has_the_spread_that_it_says(nothing):
    assert np.isposinf(measured_spread(estimate(2.0, 0.1), estimate(nothing, np.inf)))


def test_the_more_wrong_another_depth_is_the_less_it_moves_what_is_seen():
    seen = estimate(1.0, 0.05)
    moves = []
    for apart in (0.2, 0.4, 0.8):
        other = estimate(np.exp(apart), 0.15)
        inverse, _, _ = fused(seen, (other[0], measured_spread(seen, other)))
        moves.append(float(np.log(inverse[0])))
    # apart · .05² / (.05² + σ²) with σ² = .15², .07 and .55.
    np.testing.assert_allclose(moves, [0.02, 0.4 / 29, 0.8 / 221], rtol=1e-9)
