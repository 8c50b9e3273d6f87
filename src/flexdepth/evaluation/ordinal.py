"""Whether the nearer of two points is seen to be the nearer: for sets that say nothing else."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError

_Reals: TypeAlias = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class OrdinalPairs:
    """Pairs of points of one image, and what people or a sensor say of their depths.

    Attributes:
        first: n x 2, row and column of a pixel, counted from 0.
        second: Likewise.
        order: n values: 1 where the first is farther, -1 where it is nearer, 0 where they are
            equally far.
    """

    first: NDArray[np.integer]
    second: NDArray[np.integer]
    order: NDArray[np.number]

    def __post_init__(self) -> None:
        """Refuse pairs that are none."""
        count = len(self.order)
        if self.first.shape != (count, 2) or self.second.shape != (count, 2):
            raise InputError(
                f"ordinal pairs need two points (row, column) for each order, got "
                f"{self.first.shape} and {self.second.shape} for {count}"
            )
        if not np.isin(self.order, (-1, 0, 1)).all():
            raise InputError("the order of two points is 1 (farther), -1 (nearer) or 0 (equal)")


def whdr(
    depth: _Reals, pairs: OrdinalPairs, tolerance: float = 0.0, weights: _Reals | None = None
) -> float:
    """Return the share of pairs whose order is predicted wrongly: 0 is perfect.

    The first point is farther where its depth is more than 1 + tolerance times the second's,
    nearer where it is the other way round, and else they are equally far. Depth may be up to a
    factor; of affine disparity, `-disparity` has the same order, for the tolerance 0.

    Args:
        depth: Predicted depth; larger is farther.
        pairs: What is true.
        tolerance: 0.1 in Chen et al., 0.02 in VNL; 0 for DIW, which has no equal pairs.
        weights: How much each pair counts; alike without.

    Raises:
        InputError: There is no pair, a point lies outside, its depth is unknown, or a tolerance
            is asked for depth that is not positive.

    References:
        Zoran, Isola, Krishnan and Freeman, ICCV 2015 (WKDR); Chen, Fu, Yang and Deng, Depth in
        the Wild, NeurIPS 2016 (WHDR).
    """
    if not len(pairs.order):
        raise InputError("no pair of points is scored; leave the image out and report it")
    first, second = (_at(depth, points) for points in (pairs.first, pairs.second))
    if tolerance and not (min(first.min(), second.min()) > 0):
        raise InputError("a tolerance in the ratio of depths needs depth > 0")
    if tolerance:
        first, second = np.log(first), np.log(second)
    # Sky, which is infinitely far, is as far as sky.
    apart = np.subtract(first, second, where=first != second, out=np.zeros_like(first))
    predicted = np.where(np.abs(apart) > np.log1p(tolerance), np.sign(apart), 0)
    return float(np.average(predicted != pairs.order, weights=weights))


def _at(depth: _Reals, points: NDArray[np.integer]) -> NDArray[np.float64]:
    if not ((points >= 0) & (points < depth.shape)).all():
        raise InputError(
            f"a point of an ordinal pair lies outside the depth map of "
            f"{depth.shape[1]}x{depth.shape[0]}; depth must be at the size of the set's image"
        )
    values = np.asarray(depth[points[:, 0], points[:, 1]], np.float64)
    if np.isnan(values).any():
        raise InputError("the prediction has no depth at a point of an ordinal pair")
    return values
