"""What the world is like where it shows nothing: the plane of what looks the same around it.

A blank wall has flow at its posters alone. Where the picture has one colour it is taken to be one
surface, and that to be flat. This is inferred, not seen, and said to be.
"""

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import TwoFrame, Unknown
from flexdepth.solvers.least_squares import deviation

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_SMOOTHING, _GRANULARITY, _SMALLEST = 0.8, 300.0, 1.3e-3
"""Of Felzenszwalb's segments: pixels, shades of gray times pixels of area, share of the frame."""

_KNOWN = 0.15
"""The share of a segment that must have depth for the rest to be inferred."""

_FEWEST = 50
"""Pixels: fewer tell no plane."""

_STEPS = 6
"""Of reweighting; more changes nothing."""

_EXTREMES = 0.02, 0.98
"""A plane is followed no farther than to these quantiles of what is seen of it."""

_SPREAD = 0.25
"""Relative standard deviation of what is inferred, beside how far the seen strays from its plane:
what looks the same need be neither one surface nor flat."""

_HOLES = (Unknown.NO_FLOW, Unknown.OCCLUDED, Unknown.LOW_PARALLAX, Unknown.BEHIND)


def with_planes(found: TwoFrame, image: NDArray[np.uint8]) -> TwoFrame:
    """Return the answer with depth inferred where flow tells none; what moves has its own.

    Args:
        found: What is seen of depth.
        image: The key frame, RGB.
    """
    seen, holes = found.valid, np.isin(found.unknown, _HOLES)
    smallest = round(_SMALLEST * holes.size)
    cut = cv2.ximgproc.segmentation.createGraphSegmentation(_SMOOTHING, _GRANULARITY, smallest)
    segments = np.asarray(cut.processImage(image), np.int32) * len(found.regions) + found.labels
    count = int(segments.max()) + 1
    pixels, known = np.bincount(segments.ravel()), np.bincount(segments[seen], minlength=count)
    usable = (known >= _FEWEST) & (known >= _KNOWN * pixels)
    nearness = np.where(seen, 1 / np.where(seen, found.depth, 1.0), 0.0)
    spread = found.spread.copy()
    inferred = holes & usable[segments]
    for number in np.unique(segments[inferred]):
        inside = segments == number
        hole = inside & inferred
        nearness[hole], strays = _plane(nearness, inside & seen, hole)
        scale = found.regions[number % len(found.regions)].scale_spread
        spread[hole] = np.hypot(np.hypot(_SPREAD, strays), scale)
    return replace(
        found,
        depth=np.where(inferred, 1 / np.where(inferred, nearness, 1.0), found.depth),
        spread=spread,
        unknown=np.where(inferred, np.uint8(Unknown.KNOWN), found.unknown),
        inferred=inferred,
    )


def _plane(nearness: Array, seen: Mask, hole: Mask) -> tuple[Array, float]:
    """Return the inverse depth of a hole in a plane, and how far what is seen strays from it.

    The plane has the least sum of distances but for those within twice the median one, whose
    squares count; it strays by the median, in units of the plane's median inverse depth.
    """
    values = nearness[seen]
    places = _places(seen)
    weights = np.ones(len(values))
    plane, off = np.zeros(3), np.abs(values)
    for _ in range(_STEPS):
        plane[:] = np.linalg.lstsq(places * weights[:, None], values * weights, rcond=None)[0]
        off[:] = np.abs(places @ plane - values)
        scale = max(2 * float(np.median(off)), 1e-9)
        weights = np.sqrt(scale / (scale + off))
    middle = float(np.median(values))
    least, most = np.quantile(values, _EXTREMES)
    return np.clip(_places(hole) @ plane, least, most), deviation(off) / middle


def _places(inside: Mask) -> Array:
    """Return 1, x and y of pixels, in widths of the frame."""
    row, column = np.nonzero(inside)
    return np.stack([np.ones(len(row)), column / inside.shape[1], row / inside.shape[1]], axis=1)
