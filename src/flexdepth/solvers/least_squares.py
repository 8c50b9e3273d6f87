"""Robust nonlinear least squares for few unknowns."""

from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
State = TypeVar("State")

_LARGEST_DAMPING = 1e8
_SMALLEST_DAMPING = 1e-12
_CONVERGED = 1e-9

MEDIAN_OF_NORMAL = 0.6745
"""The median of a normal variable's magnitude, in standard deviations."""


class Problem(Protocol[State]):
    """n residuals of k components, in standard deviations of their noise, and p unknowns."""

    def residuals(self, state: State) -> Array:
        """Return n x k."""
        ...

    def jacobian(self, state: State) -> Array:
        """Return n x k x p: the residuals' derivative by a step, at the step 0."""
        ...

    def moved(self, state: State, step: Array) -> State:
        """Return the state after a step of p numbers."""
        ...


def dot(one: Array, other: Array) -> Array:
    """Return the n inner products of the rows of two n x k arrays; numpy's sum over few is slow."""
    return np.asarray(np.einsum("nk,nk->n", one, other))


def squares(problem: Problem[State], state: State) -> Array:
    """Return |r|² of each of the n residuals."""
    residuals = problem.residuals(state)
    return dot(residuals, residuals)


def deviation(values: Array) -> float:
    """Return the standard deviation about 0 of a normal variable, from the median magnitude."""
    return float(np.median(np.abs(values))) / MEDIAN_OF_NORMAL


def weights(square: Array, scale: float) -> Array:
    """Return Geman and McClure's weight (s² / (s² + |r|²))²: 1 at 0, 1/4 at s, then ~ |r|⁻⁴."""
    return np.asarray((scale**2 / (scale**2 + square)) ** 2)


def cost(square: Array, scale: float) -> float:
    """Return Σ s² |r|² / (s² + |r|²); no residual counts more than s²."""
    return float((scale**2 * square / (scale**2 + square)).sum())


def refined(problem: Problem[State], state: State, scale: float, steps: int = 50) -> State:
    """Return the state at a minimum of the robust cost that is downhill from the given one.

    Iteratively reweighted Gauss-Newton, damped after Levenberg and Marquardt: a step is taken only
    where it lowers the cost, so that the cost never rises.

    Args:
        problem: What is solved.
        state: Where to begin.
        scale: The residual, in standard deviations, at which one stops pulling.
        steps: The most that are taken.
    """
    damping = 1e-6
    residuals = problem.residuals(state)
    square = dot(residuals, residuals)
    for _ in range(steps):
        before = cost(square, scale)
        jacobian = problem.jacobian(state)
        weighted = (jacobian * weights(square, scale)[:, None, None]).reshape(residuals.size, -1)
        normal = weighted.T @ jacobian.reshape(weighted.shape)
        gradient = weighted.T @ residuals.ravel()
        ridge = np.diag(np.maximum(np.diag(normal), 1e-12))
        while damping <= _LARGEST_DAMPING:
            step = -np.asarray(np.linalg.solve(normal + damping * ridge, gradient), np.float64)
            candidate = problem.moved(state, step)
            left = problem.residuals(candidate)
            candidate_square = dot(left, left)
            if cost(candidate_square, scale) < before:
                break
            damping *= 10
        else:
            return state
        state, residuals, square = candidate, left, candidate_square
        damping = max(damping / 10, _SMALLEST_DAMPING)
        if before - cost(square, scale) <= _CONVERGED * before:
            return state
    return state
