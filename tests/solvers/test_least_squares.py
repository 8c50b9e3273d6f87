from dataclasses import dataclass

import numpy as np
import pytest

from flexdepth.solvers.least_squares import cost, deviation, refined, squares, weights


@dataclass(frozen=True)
class Valley:
    """Rosenbrock's: r = (10 (y - x²), 1 - x), at its least at (1, 1)."""

    def residuals(self, state):
        return np.array([[10 * (state[1] - state[0] ** 2)], [1 - state[0]]])

    def jacobian(self, state):
        return np.array([[[-20 * state[0], 10]], [[-1, 0]]])

    def moved(self, state, step):
        return state + step


@dataclass(frozen=True)
class Line:
    """y = a x + b."""

    x: np.ndarray
    y: np.ndarray

    def residuals(self, state):
        return (state[0] * self.x + state[1] - self.y)[:, None]

    def jacobian(self, _state):
        return np.stack([self.x, np.ones_like(self.x)], 1)[:, None]

    def moved(self, state, step):
        return state + step


def test_the_bottom_of_rosenbrocks_valley_is_reached():
    found = refined(Valley(), np.array([-1.2, 1.0]), scale=100, steps=200)
    np.testing.assert_allclose(found, (1, 1), atol=1e-6)


def test_the_cost_never_rises():
    states = [refined(Valley(), np.array([-1.2, 1.0]), 100, steps) for steps in range(30)]
    costs = [cost(squares(Valley(), state), 100) for state in states]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < costs[0] / 2


def test_points_far_from_a_line_do_not_bend_it():
    x = np.linspace(-1, 1, 50)
    y = 2 * x + 1
    y[::5] += 40
    found = refined(Line(x, y), np.array([1.5, 0.5]), scale=1)
    np.testing.assert_allclose(found, (2, 1), atol=1e-3)


def test_weights_are_the_slope_of_the_cost():
    # s = 2, |r|² = 4: (4 / 8)² = 1/4, and the cost 4 · 4 / 8 = 2.
    assert weights(np.array([4.0]), 2.0) == pytest.approx(0.25)
    assert cost(np.array([4.0]), 2.0) == pytest.approx(2.0)
    rise = cost(np.array([4.0 + 1e-6]), 2.0) - cost(np.array([4.0 - 1e-6]), 2.0)
    assert rise / 2e-6 == pytest.approx(0.25, rel=1e-6)


def test_what_no_residual_depends_on_stays_where_it_is():
    found = refined(Line(np.zeros(9), np.ones(9)), np.array([5.0, 0.0]), scale=3)
    np.testing.assert_allclose(found, (5, 1), atol=1e-6)


def test_the_deviation_is_that_of_a_normal_variable_whatever_a_few_values_are():
    # Half of a normal variable's values are within .6745 of its deviations.
    assert deviation(2 * np.array([0.1, -0.5, 0.6745, -3.0, 1e9])) == pytest.approx(2.0)
