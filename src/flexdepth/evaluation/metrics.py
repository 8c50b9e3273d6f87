"""The error of one depth map against measured depth.

Each metric is for one image; a set's figure is the mean over its images. Arithmetic is float64.
"""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError

_Reals: TypeAlias = NDArray[np.floating]


def abs_rel(depth: _Reals, truth: _Reals, valid: NDArray[np.bool_]) -> float:
    """Return `mean(|depth − truth| / truth)` over the scored pixels: 0 is perfect.

    Args:
        depth: Predicted depth, in the unit of `truth`. +inf (sky) is scored as it stands.
        truth: Measured depth; read at the scored pixels only.
        valid: The scored pixels.

    Raises:
        InputError: No pixel is scored, or a scored pixel holds no positive depth: an image
            without truth has no error, neither 0 nor any other.
    """
    predicted, measured = _scored(depth, truth, valid)
    return float(np.mean(np.abs(predicted - measured) / measured))


def delta1(depth: _Reals, truth: _Reals, valid: NDArray[np.bool_]) -> float:
    """Return the part of the scored pixels with `max(depth/truth, truth/depth) < 1.25`.

    1 is perfect. A ratio of exactly 1.25 is a miss.

    Args:
        depth: Predicted depth, in the unit of `truth`.
        truth: Measured depth; read at the scored pixels only.
        valid: The scored pixels.

    Raises:
        InputError: As in `abs_rel`.

    References:
        Eigen, Puhrsch and Fergus, NeurIPS 2014 (threshold accuracy).
    """
    predicted, measured = _scored(depth, truth, valid)
    return float(np.mean(np.maximum(predicted / measured, measured / predicted) < 1.25))


def _scored(
    depth: _Reals, truth: _Reals, valid: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return depth and truth at the scored pixels, all of them positive.

    A negative depth would pass delta1, since its ratio lies below 1.25, and a NaN would count as
    a mere miss: both are refused.
    """
    if not depth.shape == truth.shape == valid.shape:
        raise InputError(
            f"depth, truth and scored pixels must be of one size, "
            f"got {depth.shape}, {truth.shape} and {valid.shape}"
        )
    if not valid.any():
        raise InputError("no pixel of this image is scored; leave the image out and report it")
    predicted, measured = depth[valid].astype(np.float64), truth[valid].astype(np.float64)
    if not (np.isfinite(measured) & (measured > 0)).all():
        raise InputError("a scored pixel has no measured depth; leave it out of the scored pixels")
    unknown = int(np.count_nonzero(~(predicted > 0)))
    if unknown:
        raise InputError(
            f"the prediction has no depth > 0 at {unknown} of {predicted.size} scored pixels"
        )
    return predicted, measured
