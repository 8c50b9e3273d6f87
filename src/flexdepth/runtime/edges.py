"""Edges of depth, brought to where the picture has its own, and made as high and as sharp.

A network smaller than the picture gives ramps of a few pixels between near and far, and where it
is not sure of an edge, low ones: soft edges in a map, and points between things in a cloud. So
how far the depth of a pixel is from the mean around it is exaggerated, up to a little more than
the nearest and the farthest around. Near a bend of the depth, every pixel then takes the depth of
the pixels around it whose colour is like its own (joint bilateral filter, a few times), and that
end of what is around it which is nearer to its own (toggle mapping). What is level or slanted
stays as it is.

References:
    Kopf et al., Joint bilateral upsampling, SIGGRAPH 2007. Kramer and Bruckner, Iterations of a
    non-linear transformation for enhancement of digital images, Pattern Recognition 1975.
"""

from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.sizes import resized

_Reals: TypeAlias = NDArray[np.float32]

LARGEST = 640 * 512
"""Pixels; in a larger picture edges are brought into place at this size."""

_AROUND = 17
"""Side in pixels of the square around a pixel in which its depth is exaggerated."""

_TIMES = 5.0
"""How many times the difference from the mean is added."""

_BEYOND, _HIGH = 0.12, 0.3
"""How far at most, as a log, beyond the nearest and the farthest around, where all is alike; half
of it where the log of their depths' ratio is `_HIGH`, and ever less at higher edges: the network
saw those clearly, and there would be a seam along them."""

_PASSES, _WINDOW, _COLOUR, _SPACE = 4, 9, 0.15, 4.0
"""Of the joint bilateral filter: how often, diameter, spread of colours from 0 to 1, in pixels."""

_TOGGLES = 2
_STEP = 0.09
"""Log of the depths' ratio around a pixel, at least, where it takes one end of them."""

_BEND = 0.02
"""How far log depth is from its mean around a pixel, at least, where there may be an edge."""

_BENT, _NEAR = 13, 9
"""Sides of the squares over which that mean is taken, and that difference's largest value again."""


def with_sharp_edges(log_depth: _Reals, picture: NDArray[np.uint8]) -> _Reals:
    """Return log depth with the edges of a picture.

    No value is farther than `_BEYOND` outside of what was around it.

    Args:
        log_depth: Height x width, finite.
        picture: The same height x width, x 3.
    """
    height, width = log_depth.shape
    share = (LARGEST / (height * width)) ** 0.5
    if share >= 1:
        return _sharpened(log_depth, picture)
    size = max(1, round(width * share)), max(1, round(height * share))
    small = resized(log_depth, size)
    change = _sharpened(small, resized(picture, size)) - small
    return log_depth + resized(change, (width, height))


def _sharpened(log_depth: _Reals, picture: NDArray[np.uint8]) -> _Reals:
    placed = _exaggerated(log_depth)
    bend = np.abs(placed - _level(placed, _BENT))
    edge = cv2.dilate(bend, np.ones((_NEAR, _NEAR), np.uint8)) > _BEND
    if not edge.any():
        return log_depth
    colours = picture.astype(np.float32) / np.float32(255)
    for _ in range(_PASSES):
        filtered = cv2.ximgproc.jointBilateralFilter(colours, placed, _WINDOW, _COLOUR, _SPACE)
        placed = np.asarray(filtered, np.float32)
    for _ in range(_TOGGLES):
        placed = _toggled(placed)
    return np.where(edge, placed, log_depth)


def _exaggerated(log_depth: _Reals) -> _Reals:
    least, most = _ends(log_depth, _AROUND)
    low, high = _ends(log_depth, 2 * _AROUND - 1)
    beyond = np.float32(_BEYOND) / (1 + ((high - low) / np.float32(_HIGH)) ** 2)
    relief = log_depth - _level(log_depth, _AROUND)
    return np.clip(log_depth + np.float32(_TIMES) * relief, least - beyond, most + beyond)


def _ends(values: _Reals, side: int) -> tuple[_Reals, _Reals]:
    """Return the smallest and the largest of the values around each."""
    square = np.ones((side, side), np.uint8)
    return np.asarray(cv2.erode(values, square)), np.asarray(cv2.dilate(values, square))


def _level(values: _Reals, side: int) -> _Reals:
    """Return the mean around each pixel, which a slope has itself, at the border as well."""
    reach = side // 2
    ring = np.pad(values, reach, mode="reflect", reflect_type="odd")
    mean = cv2.blur(ring, (side, side))
    return np.asarray(mean[reach:-reach, reach:-reach], np.float32)


def _toggled(values: _Reals) -> _Reals:
    """Return the smallest or the largest of the values around each, whichever is nearer to it."""
    low, high = _ends(values, 3)
    end = np.where(values - low < high - values, low, high)
    return np.where(high - low > _STEP, end, values)
