"""Lines through pairs of numbers: what takes a prediction to the truth."""

from dataclasses import dataclass
from math import sqrt
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError

_Numbers: TypeAlias = NDArray[np.float64]

_LEAST_FACTOR = 1e-3
_ROUNDS = 10
_RATE, _BETAS, _EPSILON, _SETTLED = 1e-4, (0.9, 0.999), 1e-8, 1e-6


@dataclass(frozen=True)
class Line:
    """The function `factor · x + offset`."""

    factor: float
    offset: float = 0.0

    def __call__(self, x: _Numbers) -> _Numbers:
        """Return the line's height at each x."""
        return self.factor * x + self.offset


@dataclass(frozen=True)
class Moments:
    """Sums over pairs of numbers, all that a least-squares line needs of them.

    Attributes:
        count: How many pairs.
        mean_x: The mean of x.
        mean_y: The mean of y.
        xx: Σ(x − mean)².
        xy: The same of x and y.
        flat: The value that every x has, None where they differ.
    """

    count: int
    mean_x: float
    mean_y: float
    xx: float
    xy: float
    flat: float | None

    @classmethod
    def of(cls, x: _Numbers, y: _Numbers) -> "Moments":
        """Return the sums over at least one pair."""
        mean_x, mean_y = float(x.mean()), float(y.mean())
        from_mean = x - mean_x
        flat = float(x[0]) if np.ptp(x) == 0 else None
        # Σ dx · y is Σ dx · dy, for Σ dx = 0.
        return cls(x.size, mean_x, mean_y, float(from_mean @ from_mean), float(from_mean @ y), flat)

    def __add__(self, other: "Moments") -> "Moments":
        """Return the sums over the pairs of both.

        References:
            Chan, Golub and LeVeque, 1983, The American Statistician 37.
        """
        count = self.count + other.count
        share, apart_x = other.count / count, other.mean_x - self.mean_x
        apart_y = other.mean_y - self.mean_y
        between = self.count * share
        return Moments(
            count,
            self.mean_x + share * apart_x,
            self.mean_y + share * apart_y,
            self.xx + other.xx + between * apart_x**2,
            self.xy + other.xy + between * apart_x * apart_y,
            self.flat if self.flat == other.flat else None,
        )

    def scale(self) -> Line:
        """Return the line through 0 nearest to y: the factor is Σxy / Σx²."""
        wanted = self.xy + self.count * self.mean_x * self.mean_y
        return Line(_ratio(wanted, self.xx + self.count * self.mean_x**2))

    def least_squares(self) -> Line:
        """Return the line that minimises Σ(factor · x + offset − y)².

        The factor may come out negative, for a prediction that has near and far the wrong way
        round. Where x is constant any factor fits as well as another, and it is 0.
        """
        if self.flat is not None or not self.xx:
            return Line(0.0, self.mean_y)
        factor = self.xy / self.xx
        return Line(factor, self.mean_y - factor * self.mean_x)


def median(x: _Numbers, y: _Numbers) -> Line:
    """Return the line through 0 that takes the median of x to the median of y.

    References:
        Zhou, Brown, Snavely and Lowe, CVPR 2017 (single-view depth, where the scale is unknown).
    """
    return Line(_ratio(float(np.median(y)), float(np.median(x))))


def scale(x: _Numbers, y: _Numbers) -> Line:
    """Return the line through 0 nearest to y in the least-squares sense."""
    return Line(_ratio(float(x @ y), float(x @ x)))


def least_squares(x: _Numbers, y: _Numbers) -> Line:
    """Return the line that minimises Σ(factor · x + offset − y)² (`Moments.least_squares`)."""
    return Moments.of(x, y).least_squares()


def weiszfeld(x: _Numbers, y: _Numbers) -> Line:
    """Return the line through 0 that nearly minimises Σ|factor · x − y|.

    Ten rounds of reweighted least squares from mean(y) / mean(x), the factor at least 0.001: what
    is published, not the minimum.

    References:
        MonST3R (ICLR 2025) and CUT3R (CVPR 2025), `depth_evaluation(align_with_scale=True)`.
    """
    factor = _ratio(float(y.mean()), float(x.mean()))
    for _ in range(_ROUNDS):
        weight = 1 / (np.abs(factor * x - y) + 1e-8)
        factor = float((weight * x) @ y) / float((weight * x) @ x)
    return Line(max(factor, _LEAST_FACTOR))


def descended(x: _Numbers, y: _Numbers, steps: int = 1000) -> Line:
    """Return the line to which Adam takes Σ|factor · x + offset − y| from the ratio of medians.

    A thousand steps of 0.0001 change factor and offset by about a tenth, by 0.316 at most: what is
    published, not the minimum. So it depends on the unit of x, and undoes no offset of any size.

    References:
        MonST3R (ICLR 2025) and CUT3R (CVPR 2025), `absolute_value_scaling2`; Kingma and Ba, Adam,
        ICLR 2015, algorithm 1.
    """
    at = np.array([median(x, y).factor, 0.0])
    mean, square = np.zeros(2), np.zeros(2)
    before = None
    for step in range(1, steps + 1):
        error = at[0] * x + at[1] - y
        loss, sign = float(np.abs(error).sum()), np.sign(error)
        gradient = np.array([sign @ x, sign.sum()])
        mean = _BETAS[0] * mean + (1 - _BETAS[0]) * gradient
        square = _BETAS[1] * square + (1 - _BETAS[1]) * gradient**2
        rate = _RATE * sqrt(1 - _BETAS[1] ** step) / (1 - _BETAS[0] ** step)
        at = at - rate * mean / (np.sqrt(square) + _EPSILON * sqrt(1 - _BETAS[1] ** step))
        if before is not None and abs(before - loss) < _SETTLED:
            break
        before = loss
    return Line(float(at[0]), float(at[1]))


def _ratio(wanted: float, predicted: float) -> float:
    if not min(wanted, predicted) > 0:
        raise InputError("the predicted depths are not positive: no factor fits them to the truth")
    return wanted / predicted
