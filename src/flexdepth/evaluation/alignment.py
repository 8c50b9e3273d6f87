"""Fitting a prediction to measured depth before it is scored.

A prediction that knows depth only up to a factor, or up to a factor and an offset, cannot be
scored as it stands. The fit must undo at least what the prediction leaves open; it may undo more,
and then the score says so by the fit's name.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError

_Numbers: TypeAlias = NDArray[np.float64]

NEAREST = 1e-3
"""Metres. No fitted depth is nearer, the floor of the published protocols."""


class Alignment(StrEnum):
    """How a prediction is fitted to the truth of its own image, from weak to strong."""

    NONE = "none"
    MEDIAN = "median"
    """Times median(truth) / median(depth)."""
    SCALE = "scale"
    """Times the factor that is best in the least-squares sense."""
    LEAST_SQUARES = "least_squares"
    """Factor and offset, least squares in depth."""
    LEAST_SQUARES_DISPARITY = "least_squares_disparity"
    """Factor and offset, least squares in inverse depth."""


_ENOUGH: Mapping[Space, frozenset[Alignment]] = MappingProxyType(
    {
        Space.METRIC: frozenset(Alignment),
        Space.SCALE: frozenset(Alignment) - {Alignment.NONE},
        Space.AFFINE_DEPTH: frozenset({Alignment.LEAST_SQUARES}),
        Space.AFFINE_DISPARITY: frozenset({Alignment.LEAST_SQUARES_DISPARITY}),
    }
)


@dataclass(frozen=True)
class Line:
    """The function `factor · x + offset`."""

    factor: float
    offset: float = 0.0

    def __call__(self, x: _Numbers) -> _Numbers:
        """Return the line's height at each x."""
        return self.factor * x + self.offset


def median(x: _Numbers, y: _Numbers) -> Line:
    """Return the line through 0 that takes the median of x to the median of y.

    References:
        Zhou, Brown, Snavely and Lowe, CVPR 2017 (single-view depth, where the scale is unknown).
    """
    return Line(_ratio(float(np.median(y)), float(np.median(x))))


def scale(x: _Numbers, y: _Numbers) -> Line:
    """Return the line through 0 nearest to y: the factor is Σxy / Σx²."""
    return Line(_ratio(float(x @ y), float(x @ x)))


def least_squares(x: _Numbers, y: _Numbers) -> Line:
    """Return the line that minimises Σ(factor · x + offset − y)².

    The factor may come out negative, for a prediction that has near and far the wrong way round.
    Where x is constant any factor fits as well as another, and it is 0.
    """
    if np.ptp(x) == 0:
        return Line(0.0, float(y.mean()))
    from_mean = x - x.mean()
    factor = float(from_mean @ y) / float(from_mean @ from_mean)
    return Line(factor, float(y.mean() - factor * x.mean()))


_FITS: Mapping[Alignment, Callable[[_Numbers, _Numbers], Line]] = MappingProxyType(
    {
        Alignment.NONE: lambda _x, _y: Line(1.0),
        Alignment.MEDIAN: median,
        Alignment.SCALE: scale,
        Alignment.LEAST_SQUARES: least_squares,
        Alignment.LEAST_SQUARES_DISPARITY: least_squares,
    }
)


def check_alignment(space: Space, alignment: Alignment) -> None:
    """Refuse an alignment that does not undo what the space leaves open.

    Raises:
        InputError: The alignment is too weak, or fits an offset in the wrong one of depth and
            inverse depth.
    """
    if alignment not in _ENOUGH[space]:
        enough = ", ".join(a for a in Alignment if a in _ENOUGH[space])
        raise InputError(
            f"alignment {alignment} does not undo what a prediction in the space {space} "
            f"leaves open; choose one of: {enough}"
        )


def aligned(
    prediction: DepthMap,
    alignment: Alignment,
    truth: NDArray[np.floating],
    valid: NDArray[np.bool_],
    cap: float,
) -> _Numbers:
    """Return the prediction in the unit of the truth: depth within [`NEAREST`, `cap`].

    The line is fitted over the scored pixels and then laid over the whole map. Pixels that the
    prediction calls sky are left out of the fit and come out at the cap; unknown ones stay NaN.

    Args:
        prediction: What is to be fitted.
        alignment: How.
        truth: Measured depth in metres; read at the scored pixels only.
        valid: The scored pixels.
        cap: The farthest depth that the protocol scores, in metres.

    Raises:
        InputError: The alignment is too weak for the prediction, the sizes differ, or no scored
            pixel has a predicted depth.
    """
    check_alignment(prediction.space, alignment)
    if not prediction.values.shape == truth.shape == valid.shape:
        raise InputError(
            f"prediction, truth and scored pixels must be of one size, "
            f"got {prediction.values.shape}, {truth.shape} and {valid.shape}"
        )
    inverse = alignment is Alignment.LEAST_SQUARES_DISPARITY
    x = _disparity(prediction) if inverse else prediction.depth.astype(np.float64)
    known = np.isfinite(x) & ~prediction.sky
    fitted = known & valid
    if not fitted.any():
        raise InputError("no scored pixel has a predicted depth: there is nothing to fit")
    y = truth[fitted].astype(np.float64)
    line = _FITS[alignment](x[fitted], 1 / y if inverse else y)
    # Unknown pixels would carry NaN and inf through the line, so they walk it as 0.
    height = line(np.where(known, x, 0.0))
    depth = 1 / np.maximum(height, 1 / cap) if inverse else height
    depth = np.where(known, np.clip(depth, NEAREST, cap), np.nan)
    return np.where(prediction.sky, cap, depth)


def _disparity(prediction: DepthMap) -> _Numbers:
    """Return what the map says of inverse depth; NaN where it holds no positive depth."""
    if prediction.space is Space.AFFINE_DISPARITY:
        return prediction.disparity.astype(np.float64)
    depth = prediction.depth.astype(np.float64)
    positive = depth > 0
    return np.where(positive, 1 / np.where(positive, depth, 1.0), np.nan)


def _ratio(wanted: float, predicted: float) -> float:
    if not min(wanted, predicted) > 0:
        raise InputError("the predicted depths are not positive: no factor fits them to the truth")
    return wanted / predicted
