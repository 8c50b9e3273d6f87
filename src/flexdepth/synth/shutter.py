"""What moves while the shutter is open: blur from the way of every pixel and depth."""

from collections.abc import Callable
from math import ceil

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]

Ways = Callable[[float], NDArray[np.floating]]
"""From a time of the exposure, -1 where the shutter opens to 1 where it closes, to where each
pixel's point is then, pixels right and down of the pixel; not finite where that is unknown."""

_LEAST = 0.25
"""Pixels of the longest way below which nothing is blurred."""

_FARTHEST = 40.0
"""Pixels at the ends of a way beyond which nothing is smeared."""

_APART = 1.0
"""Pixels of the longest way from one time that is looked at to the next."""

_FEWEST, _MOST = 9, 31
"""Times that are looked at, each in the middle of its part of the exposure."""

_STEPS = 2
"""How often the point that is seen at a pixel is looked for again, from where it seemed to be."""

_MISSED = 0.5
"""Pixels that a point which is said to be seen at a pixel may be beside it."""


def smeared(light: Array, depth: Array, ways: Ways) -> Array:
    """Return the light that arrives while the shutter is open: the mean over its times.

    At each time a pixel sees the nearest of the points that are there then. What is near and
    moves spreads over what is behind it, and where it has gone from, the farthest thing nearby
    stands for what was hidden.

    Args:
        light: Linear light at the exposure's middle.
        depth: z in metres then, +inf for sky.
        ways: Where the points are at other times.

    References:
        McGuire et al., A reconstruction filter for plausible motion blur, I3D 2012, section 4,
        for the longest way nearby as the second place to look from. The point itself is found
        as in Bowles et al., Iterative image warping, Eurographics 2012.
    """
    reach = np.maximum(*(np.linalg.norm(_known(ways(end)), axis=-1) for end in (-1.0, 1.0)))
    longest = min(float(reach.max()), _FARTHEST)
    if longest < _LEAST:
        return light
    shrunk = np.minimum(1, _FARTHEST / np.maximum(reach, 1e-6))[..., None].astype(np.float32)
    count = min(max(round(2 * longest / _APART), _FEWEST), _MOST)
    leader = _longest(np.minimum(reach, _FARTHEST))
    total = np.zeros_like(light)
    for time in (2 * np.arange(count) + 1) / count - 1:
        x, y = _seen(_known(ways(float(time))) * shrunk, depth, leader)
        total += _at(light, x, y)
    return np.asarray(total / np.float32(count), np.float32)


def _known(way: NDArray[np.floating]) -> Array:
    return np.where(np.isfinite(way), way, 0).astype(np.float32)


def _seen(way: Array, depth: Array, leader: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return where in the picture the points are that are seen at each pixel at one time."""
    places = np.indices(depth.shape, np.float32)
    row, column = places[0], places[1]
    points = np.dstack([way, depth])
    chosen, farthest = (column, row), depth
    best, found = np.full_like(depth, np.inf), np.zeros(depth.shape, bool)
    for first in (way, way.reshape(-1, 2)[leader]):
        x, y = column - first[..., 0], row - first[..., 1]
        there = _at(points, x, y)
        instead = ~found & (there[..., 2] > farthest)
        chosen = np.where(instead, x, chosen[0]), np.where(instead, y, chosen[1])
        farthest = np.where(instead, there[..., 2], farthest)
        for _ in range(_STEPS):
            before = there
            x, y = column - before[..., 0], row - before[..., 1]
            there = _at(points, x, y)
        missed = np.maximum(*(np.abs(there[..., k] - before[..., k]) for k in (0, 1)))
        taken = (missed < _MISSED) & ((there[..., 2] < best) | ~found)
        chosen = np.where(taken, x, chosen[0]), np.where(taken, y, chosen[1])
        best, found = np.where(taken, there[..., 2], best), found | taken
    return chosen


def _at(of: Array, x: Array, y: Array) -> Array:
    """Return the nearest pixels: a mean of two would mix what is near with what is behind it."""
    nearest = cv2.remap(of, x, y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(nearest, np.float32)


def _longest(reach: Array) -> NDArray[np.intp]:
    """Return the number of the pixel with the longest way, within such a way of each pixel."""
    height, width = reach.shape
    side = max(1, ceil(float(reach.max())))
    rows, columns = -(-height // side), -(-width // side)
    outside = (0, rows * side - height), (0, columns * side - width)
    length = np.pad(reach, outside, constant_values=-1)
    number = np.pad(np.arange(height * width).reshape(height, width), outside)
    tiles = [
        of.reshape(rows, side, columns, side).swapaxes(1, 2).reshape(rows, columns, side * side)
        for of in (length, number)
    ]
    best = tiles[0].argmax(2)[..., None]
    length, number = (
        np.pad(np.take_along_axis(of, best, 2)[..., 0], 1, constant_values=-1) for of in tiles
    )
    near = [
        np.stack([of[i : i + rows, j : j + columns] for i in range(3) for j in range(3)], 2)
        for of in (length, number)
    ]
    chosen = np.take_along_axis(near[1], near[0].argmax(2)[..., None], 2)[..., 0]
    return np.asarray(chosen.repeat(side, 0).repeat(side, 1)[:height, :width], np.intp)
