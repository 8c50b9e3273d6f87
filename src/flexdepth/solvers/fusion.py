"""Two estimates of inverse depth made one, by how certain each is."""

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.regions import weighted_deviation, weighted_median

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_LEAST = 1e-4
"""No depth is said to be more certain than this."""

_EXPLAINED = 6.0
"""Standard deviations of a depth that explain that it differs from another: the spread of what
estimated flow shows may be told too small by half."""


def fused(one: tuple[Array, Array], other: tuple[Array, Array]) -> tuple[Array, Array, Array]:
    """Return inverse depth, its relative standard deviation, and the other's share of it.

    The mean is taken of logarithms, weighted by certainty; where one is not known, the other
    stands alone.

    Args:
        one: Inverse depth, NaN where unknown, and its relative standard deviation.
        other: Likewise.
    """
    certain, logarithm = [], []
    for inverse, spread in (one, other):
        known = np.isfinite(inverse) & (inverse > 0) & np.isfinite(spread)
        certain.append(certainty(spread, known))
        logarithm.append(np.log(np.where(known, inverse, 1.0)))
    total = certain[0] + certain[1]
    safe = np.where(total > 0, total, 1.0)
    mean = (certain[0] * logarithm[0] + certain[1] * logarithm[1]) / safe
    inverse = np.where(total > 0, np.exp(mean), np.nan)
    return inverse, np.where(total > 0, 1 / np.sqrt(safe), np.inf), certain[1] / safe


def measured_spread(one: tuple[Array, Array], other: tuple[Array, Array]) -> Array:
    """Return the other's spread, at least what shows of its error: max(σ², d² - (6 σ₁)²).

    d is the logarithm by which the two differ, σ₁ the one's spread: what six of them do not
    explain is the other's error. So the more wrong the other is, the less `fused` moves the one.
    Where the one is not known, nothing shows.

    Args:
        one: Inverse depth, NaN where unknown, and its relative standard deviation.
        other: Likewise.
    """
    known = [np.isfinite(inverse) & (inverse > 0) for inverse, _ in (one, other)]
    both = known[0] & known[1]
    apart = np.log(np.where(both, one[0], 1.0) / np.where(both, other[0], 1.0))
    shown = apart**2 - (_EXPLAINED * one[1]) ** 2
    return np.sqrt(np.maximum(other[1] ** 2, shown))


def certainty(spread: Array, where: Mask) -> Array:
    """Return 1 / spread² where it is finite and asked for, else 0."""
    return np.where(where & np.isfinite(spread), 1 / np.maximum(spread, _LEAST) ** 2, 0.0)


def common_factor(one: Array, other: Array, certain: Array) -> tuple[float, float] | None:
    """Return the factor that takes one map to the other, and ln's standard deviation.

    It is the weighted median of their ratio; its deviation that of the ratios, for as many as
    ten independent ones. None where they share nothing.

    Args:
        one: Inverse depths; NaN is unknown.
        other: Likewise.
        certain: Weights.
    """
    both = np.isfinite(one) & np.isfinite(other) & (one > 0) & (other > 0) & (certain > 0)
    if both.sum() < 6:
        return None
    ratio = np.log(other[both] / one[both])
    middle = weighted_median(ratio, certain[both])
    off = weighted_deviation(ratio - middle, certain[both])
    return float(np.exp(middle)), off / np.sqrt(min(10.0, float(both.sum())))
