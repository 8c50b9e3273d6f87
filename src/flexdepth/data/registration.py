"""Whether depth lies on its picture: where the edges of one meet the edges of the other.

A thing's outline is an edge of depth, and more often than not an edge of the picture. So the
gradient of the picture, averaged over the edges of depth, is larger where the two lie on one
another than where depth is moved by some pixels.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.data.folder import Pair
from flexdepth.runtime.depthmap import Space

REACH = 16
"""Shifts are tried up to so many pixels of the reduced picture in every direction."""

_WIDTH = 400
_JUMP = 0.08
_FEWEST = 200


def reduction(width: int) -> int:
    """Return by what whole number a picture is reduced for the search."""
    return max(1, round(width / _WIDTH))


def agreement(pair: Pair) -> NDArray[np.float64] | None:
    """Return the mean gradient of the picture on the edges of depth, by shift of depth.

    In standard deviations of the gradient; row and column `REACH` are no shift. Where depth should
    be moved by dx to the right and dy down, the largest is at [REACH + dy, REACH + dx].

    Args:
        pair: With depth or disparity; of sparse depth the nearest known pixel counts.

    Returns:
        None where depth has too few edges.
    """
    factor = reduction(pair.image.shape[1])
    gray = cv2.cvtColor(np.ascontiguousarray(pair.image), cv2.COLOR_RGB2GRAY)
    values = np.ascontiguousarray(pair.truth.values[::factor, ::factor])
    size = (values.shape[1], values.shape[0])
    small = cv2.resize(gray, size, interpolation=cv2.INTER_AREA) if factor > 1 else gray
    smooth = cv2.GaussianBlur(small.astype(np.float32), (0, 0), 1)
    level = _level(values, pair.truth.space)
    if level is None:
        return None
    found, edges = np.zeros((2 * REACH + 1,) * 2), 0
    for axis in (0, 1):
        jump = np.abs(np.diff(level, axis=axis))
        edge = np.where(np.isfinite(jump), jump > _JUMP, False).astype(np.float64)
        found += _correlation(edge, np.abs(np.diff(smooth, axis=axis)))
        edges += int(edge.sum())
    return found / edges if edges >= _FEWEST else None


def _level(values: NDArray[np.float32], space: Space) -> NDArray[np.float64] | None:
    """Return a map in which a jump of 0.08 is an edge; holes are filled where they prevail."""
    known = np.isfinite(values) & (values > 0)
    if not known.any():
        return None
    level = np.where(known, values, np.nan).astype(np.float64)
    if space in (Space.METRIC, Space.SCALE):
        level = np.log(level)
    else:
        level /= float(np.ptp(values[known])) or 1.0
    if known.mean() > 0.5:
        return level
    _, label = cv2.distanceTransformWithLabels(
        (~known).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    nearest = np.zeros(int(label.max()) + 1)
    nearest[label[known]] = level[known]
    filled: NDArray[np.float64] = nearest[label]
    return filled


def _correlation(edge: NDArray[np.float64], gradient: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return Σ edge(x, y) · gradient(x + dx, y + dy) for each shift, by FFT.

    The strongest twentieth of the gradients count alike, lest a few bright lines decide.
    """
    steep = gradient[gradient > 0]
    cap = float(np.quantile(steep, 0.95)) if steep.size else 0.0
    capped = np.minimum(gradient, cap).astype(np.float64)
    normal = (capped - capped.mean()) / (capped.std() or 1.0)
    padded = np.pad(normal, REACH)
    edges = np.pad(edge, ((0, 2 * REACH), (0, 2 * REACH)))
    spectrum = np.fft.rfft2(padded) * np.conj(np.fft.rfft2(edges))
    side = 2 * REACH + 1
    return np.fft.irfft2(spectrum, padded.shape)[:side, :side]
