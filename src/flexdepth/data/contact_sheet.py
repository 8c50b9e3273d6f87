"""Pairs to look at: the picture, the edges of depth on it, and depth in colours."""

from collections.abc import Sequence
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.data.folder import Pair
from flexdepth.runtime.colour import coloured, limits
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.picture import panels, preview

Pixels: TypeAlias = NDArray[np.uint8]

_WIDTH = 480
_JUMP = 0.08
_SPARSE = 0.25
_RED, _PAPER = (255, 40, 40), 255


def sheet(pairs: Sequence[Pair]) -> Pixels:
    """Return a row for each pair, below one another: RGB, uint8."""
    rows = [row(pair) for pair in pairs]
    width = max(each.shape[1] for each in rows)
    filled = [
        np.pad(each, ((0, 0), (0, width - each.shape[1]), (0, 0)), constant_values=_PAPER)
        for each in rows
    ]
    return np.concatenate(filled)


def row(pair: Pair) -> Pixels:
    """Return picture, edges and depth of one pair, side by side under their titles.

    Sparse depth is laid on the picture in its colours, its points thickened to be seen.
    """
    height, width = pair.image.shape[:2]
    size = (_WIDTH, max(1, round(height * _WIDTH / width)))
    image = np.asarray(cv2.resize(pair.image, size, interpolation=cv2.INTER_AREA), np.uint8)
    truth = pair.truth
    known = float((truth.valid | truth.sky).mean())
    values = (
        truth.values if known > _SPARSE else _thickened(truth.values, 2 * (width // _WIDTH) + 1)
    )
    shrunk = cv2.resize(values, size, interpolation=cv2.INTER_NEAREST_EXACT)
    small = DepthMap(np.asarray(shrunk, np.float32), truth.space)
    marked = outlined(image, small) if known > _SPARSE else laid_on(image, small)
    title = "edges of depth" if known > _SPARSE else "depth on the picture"
    return panels([image, marked, preview(small)], [pair.name, title, f"{known:.0%} known"])


def outlined(image: Pixels, depth_map: DepthMap) -> Pixels:
    """Return the picture in gray with the edges of depth in red."""
    shown = _gray(image)
    values = depth_map.values
    known = np.isfinite(values) & (values > 0)
    level = np.where(known, values, np.nan).astype(np.float64)
    if depth_map.space in (Space.METRIC, Space.SCALE):
        level = np.log(level)
    elif known.any():
        level /= float(np.ptp(values[known])) or 1.0
    for axis in (0, 1):
        rows, columns = np.nonzero(np.abs(np.diff(level, axis=axis)) > _JUMP)
        shown[rows, columns] = _RED
    return shown


def laid_on(image: Pixels, depth_map: DepthMap) -> Pixels:
    """Return the picture in gray with depth in its colours wherever it is known."""
    colours = coloured(depth_map, limits(depth_map))
    return np.where(depth_map.valid[..., None], colours, _gray(image))


def _gray(image: Pixels) -> Pixels:
    gray = np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), np.uint8)
    return np.repeat(gray[..., None], 3, axis=2)


def _thickened(values: NDArray[np.float32], side: int) -> NDArray[np.float32]:
    """Return a map in which each known point fills a square, the nearest in front."""
    largest = np.float32(np.finfo(np.float32).max)
    filled = np.where(np.isfinite(values), values, largest)
    nearest = np.asarray(cv2.erode(filled, np.ones((side, side), np.uint8)), np.float32)
    return np.where(nearest < largest, nearest, np.float32(np.nan))
