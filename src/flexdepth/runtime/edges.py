"""Edges of depth, brought to where the picture has its own, and made as sharp.

A network smaller than the picture gives ramps of a few pixels between near and far: soft edges in
a map, and points between things in a cloud. Near a bend of the depth, every pixel takes the depth
of the pixels around it whose colour is like its own (joint bilateral filter), and then, a few
times, that end of what is around it which is nearer to its own (toggle mapping). What is level or
slanted stays as it is.

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

_WINDOW, _COLOUR, _SPACE = 11, 0.15, 5.0
"""Of the joint bilateral filter: diameter, spread of colours from 0 to 1, spread in pixels."""

_TOGGLES = 4
_STEP = 0.03
"""Log of the depths' ratio around a pixel, at least, where it takes one end of them."""

_BEND = 0.02
"""How far log depth is from its mean around a pixel, at least, where there may be an edge."""
_AROUND, _NEAR = 13, 9
"""Sides of the squares over which that mean is taken, and that mean's largest value again."""


def with_sharp_edges(log_depth: _Reals, picture: NDArray[np.uint8]) -> _Reals:
    """Return log depth with the edges of a picture.

    Every value lies between the smallest and the largest that were around it.

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
    mean = cv2.blur(log_depth, (_AROUND, _AROUND), borderType=cv2.BORDER_REPLICATE)
    bend = np.abs(log_depth - mean)
    edge = cv2.dilate(bend, np.ones((_NEAR, _NEAR), np.uint8)) > _BEND
    if not edge.any():
        return log_depth
    colours = picture.astype(np.float32) / np.float32(255)
    guided = cv2.ximgproc.jointBilateralFilter(colours, log_depth, _WINDOW, _COLOUR, _SPACE)
    placed = np.asarray(guided, np.float32)
    for _ in range(_TOGGLES):
        placed = _toggled(placed)
    return np.where(edge, placed, log_depth)


def _toggled(values: _Reals) -> _Reals:
    """Return the smallest or the largest of the values around each, whichever is nearer to it."""
    square = np.ones((3, 3), np.uint8)
    low, high = cv2.erode(values, square), cv2.dilate(values, square)
    end = np.where(values - low < high - values, low, high)
    return np.where(high - low > _STEP, end, values)
