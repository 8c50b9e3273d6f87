"""Levenberg-Marquardt on the field: a step is taken only where it lowers the energy."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.compiled import compiled
from flexdepth.solvers.conjugate import solved
from flexdepth.solvers.curvature import linear
from flexdepth.solvers.field import Field, Scales, Terms, energy

Array = NDArray[np.float64]

_LARGEST = 1e6
_SMALLEST = 1e-6

_ITERATIONS = 16
_TOLERANCE = 5e-2


@dataclass(frozen=True, eq=False)
class State:
    """Where the solver is.

    Attributes:
        field: Depth and motion.
        damping: μ of the next step.
        energy: At `field`, for the scales of the last step; NaN before the first.
        iterations: Of conjugate gradients in the last step.
        accepted: Whether the last step was taken.
    """

    field: Field
    damping: float = 1e-2
    energy: float = float("nan")
    iterations: int = 0
    accepted: bool = True


def step(state: State, terms: Terms, scales: Scales) -> State:
    """Take one step: linearise once, then raise μ until the energy falls.

    Args:
        state: Where to begin; it is not changed.
        terms: What is solved.
        scales: Where its terms let go.
    """
    at = linear(state.field, terms, scales)
    before = energy(state.field, terms, scales)
    damping, iterations = state.damping, 0
    while damping <= _LARGEST:
        change, count = solved(at, damping, _ITERATIONS, _TOLERANCE)
        iterations += count
        field = moved(state.field, terms, change)
        after = energy(field, terms, scales)
        if after <= before:
            return State(field, max(damping / 10, _SMALLEST), after, iterations)
        damping *= 10
    return replace(state, damping=_LARGEST, energy=before, iterations=iterations, accepted=False)


def moved(field: Field, terms: Terms, change: Array) -> Field:
    """Return the field after a step: places and turns anchored at the points that move."""
    out = Field(*(np.empty_like(each) for each in field))
    _move(field, terms, change, out)
    return out


@compiled
def _move(field: Field, terms: Terms, change: Array, out: Field) -> None:
    height, width = field.inverse_depth.shape
    f = (terms.focal[0] + terms.focal[1]) / 2
    turn, twist = np.empty((3, 3)), np.empty(3)
    for i in range(height):
        for j in range(width):
            rho = field.inverse_depth[i, j]
            for k in range(3):
                twist[k] = min(max(change[i, j, 4 + k] / terms.lever, -0.2), 0.2)
            _rotation(twist, turn)
            for m in range(3):
                here = 0.0
                for n in range(3):
                    total = 0.0
                    for k in range(3):
                        total += turn[m, k] * field.rotation[i, j, k, n]
                    out.rotation[i, j, m, n] = total
                    own = field.rotation[i, j, m, n] - total
                    here += own * terms.key[i, j, n]
                along = change[i, j, 1 + m] / f
                out.translation[i, j, m] = field.translation[i, j, m] + (here + along) / rho
            nearer = change[i, j, 0] / terms.unit
            out.inverse_depth[i, j] = rho + min(max(nearer, -0.3 * rho), 0.5 * rho)


@compiled
def _rotation(twist: Array, out: Array) -> None:
    """Write exp [ω]x; |ω| is small, so that series serve."""
    square = twist[0] ** 2 + twist[1] ** 2 + twist[2] ** 2
    one = 1 - square / 6 * (1 - square / 20 * (1 - square / 42))
    two = 0.5 * (1 - square / 12 * (1 - square / 30 * (1 - square / 56)))
    for m in range(3):
        for n in range(3):
            out[m, n] = two * twist[m] * twist[n]
        out[m, m] += 1 - two * square
    for k in range(3):
        m, n = (k + 1) % 3, (k + 2) % 3
        out[n, m] += one * twist[k]
        out[m, n] -= one * twist[k]
