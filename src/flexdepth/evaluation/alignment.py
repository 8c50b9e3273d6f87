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

from flexdepth.evaluation import lines
from flexdepth.evaluation.lines import Line
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError

_Numbers: TypeAlias = NDArray[np.float64]

NEAREST = 1e-3
"""Metres. No fitted depth is nearer, the floor of the published protocols."""

LEAST_DISPARITY = 1e-3
"""1/metres. No fitted inverse depth is smaller, as published, where no cap says so first."""


class Alignment(StrEnum):
    """How a prediction is fitted to the truth, from weak to strong."""

    NONE = "none"
    MEDIAN = "median"
    """Times median(truth) / median(depth)."""
    SCALE = "scale"
    """Times the factor that is best in the least-squares sense."""
    SCALE_WEISZFELD = "scale_weiszfeld"
    """Times the factor that is nearly best in the least-absolute sense (`lines.weiszfeld`)."""
    DESCENT = "descent"
    """Factor and offset by a thousand small steps from the median (`lines.descended`)."""
    LEAST_SQUARES = "least_squares"
    """Factor and offset, least squares in depth."""
    LEAST_SQUARES_DISPARITY = "least_squares_disparity"
    """Factor and offset, least squares in inverse depth."""


_ENOUGH: Mapping[Space, frozenset[Alignment]] = MappingProxyType(
    {
        Space.METRIC: frozenset(Alignment),
        Space.SCALE: frozenset(Alignment) - {Alignment.NONE},
        # Descent takes the offset a tenth of a metre far, whatever it is.
        Space.AFFINE_DEPTH: frozenset({Alignment.LEAST_SQUARES}),
        Space.AFFINE_DISPARITY: frozenset({Alignment.LEAST_SQUARES_DISPARITY}),
    }
)


_LINES: Mapping[Alignment, Callable[[_Numbers, _Numbers], Line]] = MappingProxyType(
    {
        Alignment.NONE: lambda _x, _y: Line(1.0),
        Alignment.MEDIAN: lines.median,
        Alignment.SCALE: lines.scale,
        Alignment.SCALE_WEISZFELD: lines.weiszfeld,
        Alignment.DESCENT: lines.descended,
        Alignment.LEAST_SQUARES: lines.least_squares,
        Alignment.LEAST_SQUARES_DISPARITY: lines.least_squares,
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
            f"leaves open; choose one of: {enough} (--alignment, or a protocol that fits so)"
        )


def weakest(space: Space) -> Alignment:
    """Return the weakest alignment that undoes what the space leaves open."""
    return next(each for each in Alignment if each in _ENOUGH[space])


@dataclass(frozen=True, eq=False)
class Points:
    """What a line is fitted to, at the scored pixels whose depth is predicted.

    Attributes:
        x: What the prediction says: depth, or inverse depth.
        y: What was measured of the same.
    """

    x: _Numbers
    y: _Numbers


@dataclass(frozen=True)
class Fit:
    """How to turn a prediction into metres.

    Attributes:
        line: From what the prediction says to the truth.
        inverse: The line is one of inverse depth.
        least: Predicted inverse depth below this is raised to it first.
    """

    line: Line
    inverse: bool
    least: float | None = None

    def depth(self, prediction: DepthMap, clip: tuple[float, float] | None, sky: float) -> _Numbers:
        """Return the whole map as depth in metres; unknown pixels stay NaN.

        Args:
            prediction: The map.
            clip: The nearest and the farthest depth that comes out; None leaves it as it is.
            sky: The depth in metres that the prediction's sky stands for.
        """
        x = _said(prediction, self.inverse, self.least)
        known = np.isfinite(x) & ~prediction.sky
        # Unknown pixels would carry NaN and inf through the line, so they walk it as 0.
        height = self.line(np.where(known, x, 0.0))
        if self.inverse:
            height = 1 / np.maximum(height, LEAST_DISPARITY if clip is None else 1 / clip[1])
        if clip is not None:
            height = np.clip(height, *clip)
        return np.where(prediction.sky, sky, np.where(known, height, np.nan))


def scored_points(
    prediction: DepthMap,
    alignment: Alignment,
    truth: NDArray[np.floating],
    valid: NDArray[np.bool_],
    least: float | None = None,
) -> Points:
    """Return what a line is fitted to in one image. The prediction's sky is left out.

    Args:
        prediction: What is to be fitted.
        alignment: How.
        truth: Measured depth in metres; read at the scored pixels only.
        valid: The scored pixels.
        least: Predicted inverse depth below this is raised to it first.

    Raises:
        InputError: The alignment is too weak for the prediction, or the sizes differ.
    """
    check_alignment(prediction.space, alignment)
    if not prediction.values.shape == truth.shape == valid.shape:
        raise InputError(
            f"prediction, truth and scored pixels must be of one size, "
            f"got {prediction.values.shape}, {truth.shape} and {valid.shape}"
        )
    inverse = alignment is Alignment.LEAST_SQUARES_DISPARITY
    x, y = _said(prediction, inverse, least)[valid], truth[valid].astype(np.float64)
    known = np.isfinite(x) & ~prediction.sky[valid]
    x, y = x[known], y[known]
    return Points(x, 1 / y if inverse else y)


def fitted(points: Points, alignment: Alignment, least: float | None = None) -> Fit:
    """Return the fit of an alignment to some points.

    Raises:
        InputError: There are none, or no factor fits.
    """
    if not points.x.size:
        raise InputError("no scored pixel has a predicted depth: there is nothing to fit")
    inverse = alignment is Alignment.LEAST_SQUARES_DISPARITY
    return Fit(_LINES[alignment](points.x, points.y), inverse, least)


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
    points = scored_points(prediction, alignment, truth, valid)
    return fitted(points, alignment).depth(prediction, (NEAREST, cap), cap)


def _said(prediction: DepthMap, inverse: bool, least: float | None) -> _Numbers:
    """Return what the map says of depth or of inverse depth.

    Inverse depth is NaN where the map holds no positive depth, and at least `least` elsewhere.
    """
    if not inverse:
        return prediction.depth.astype(np.float64)
    if prediction.space is Space.AFFINE_DISPARITY:
        said = prediction.disparity.astype(np.float64)
    else:
        depth = prediction.depth.astype(np.float64)
        positive = depth > 0
        said = np.where(positive, 1 / np.where(positive, depth, 1.0), np.nan)
    return said if least is None else np.where(prediction.sky, said, np.maximum(said, least))
