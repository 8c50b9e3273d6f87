"""Which pixels move by themselves, and which of them together.

Each piece of the frame is tested by the median of what its pixels are off the camera's epipolar
lines, and by the median of the size of that, beside their noise: cloth in the wind is off to both
sides. How far such medians stray without any motion is not assumed: it is measured by how the
pieces of the frame stray, most of which are still.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.least_squares import MEDIAN_OF_NORMAL
from flexdepth.solvers.pieces import Labels, Neighbours, neighbours
from flexdepth.solvers.two_view import Along

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_LEAST = 0.003
"""Pixels: medians stray at least so far, even where the flow is said to be exact."""

_MIXED, _MISTOLD = 0.15, 0.5
"""And so far in the frame's typical noise: some of a still piece's pixels are of what moves beside
it. What is off to both sides is told by that noise alone, which may be told wrong by half."""

_MEDIAN = 1.25
"""The standard deviation of a median, in that of one value over the root of how many there are."""

_OFF = 0.012
"""Pixels: what is rigid may be off its motion at least so far."""

_STRONG, _WEAK = 6.0, 3.0
"""Standard deviations at which a piece moves, and at which it does beside one that moves."""

_BEHIND = 0.5
"""The share of a piece's pixels behind the camera that makes it move."""

_CLEAR = 2.0
"""Standard deviations of negative parallax that put a pixel behind the camera."""

_GOES_ON = 0.5
"""The share of the border of two moving pieces across which flow goes on, if they are one."""

_ALONE, _FEWEST = 3.0, 4.0
"""How much longer the border is across which flow goes on from moving pieces than from still ones,
and pixels of it, for a piece to be one with those."""

_MOST = 24
"""Moving regions are at most so many: the largest."""

_SMALLEST = 2e-3
"""The share of the frame that a moving region has at least."""


@dataclass(frozen=True, eq=False)
class Moving:
    """What moves by itself.

    Attributes:
        labels: Height x width: 0 is the static world, then the regions, the largest first.
        strays: Pixels: how far the median of a still piece is off its epipolar lines, and what is
            rigid may be off its motion.
    """

    labels: Labels
    strays: float


def moving_regions(
    labels: Labels, flow: Array, along: Along, noise: Array, trusted: Mask
) -> Moving:
    """Return the regions that move by themselves.

    Args:
        labels: Pieces of the frame.
        flow: Height x width x 2, pixels, finite.
        along: What the flow says of depth, were all still.
        noise: Height x width, pixels, finite.
        trusted: Where the flow counts.
    """
    count = int(labels.max()) + 1
    groups, off = labels[trusted], along.across[trusted]
    pixels = np.bincount(groups, minlength=count).astype(np.float64)
    said = medians(groups, noise[trusted], count)
    middle = np.abs(medians(groups, off, count))
    width = medians(groups, np.abs(off), count)
    wider = width - said * weighted_median(width / np.where(said > 0, said, 1.0), pixels)
    typical = float(np.median(noise[trusted]))
    surprise = np.maximum(
        _surprise(middle, pixels, said, _MIXED * typical),
        _surprise(wider, pixels, said, _MISTOLD * typical),
    )
    behind = along.parallax < -_CLEAR * noise
    share = np.bincount(groups, behind[trusted], minlength=count) / np.maximum(pixels, 1)
    surprise[share > _BEHIND] = 2 * _STRONG
    surprise[pixels < 3] = 0.0
    pairs = neighbours(labels, flow, max(0.7, 3 * typical))
    moves = _closed(_grown(surprise, pairs), pairs)
    area = np.bincount(labels.ravel(), minlength=count).astype(np.float64)
    number = _objects(moves, pairs, area)
    alone = np.zeros(labels.shape)
    alone[trusted] = _surprise(np.abs(off), np.ones(len(off)), noise[trusted], _MIXED * typical)
    found = _grown_over(number[labels], alone > _STRONG)
    return Moving(found, max(_OFF, weighted_deviation(middle, pixels)))


def _surprise(off: Array, pixels: Array, noise: Array, least: float) -> Array:
    """Return by how many standard deviations each piece is off; a pixel is a piece of one.

    Args:
        off: Pixels; a median of each piece, of which most have about 0.
        pixels: How many each has.
        noise: Their flow's typical standard deviation, pixels.
        least: Pixels by which such medians stray at least.
    """
    least = max(_LEAST, least, weighted_deviation(off, pixels))
    return np.asarray(off / np.hypot(least, _MEDIAN * noise / np.sqrt(np.maximum(pixels, 1))))


def medians(groups: NDArray[np.int32], values: Array, count: int) -> Array:
    """Return the median of the values of each group, 0 where it has none."""
    order = np.lexsort((values, groups))
    size = np.bincount(groups, minlength=count)
    begin = np.concatenate([[0], np.cumsum(size)[:-1]])
    at = np.minimum(begin + size // 2, max(len(values) - 1, 0))
    return np.where(size > 0, values[order][at], 0.0) if len(values) else np.zeros(count)


def weighted_median(values: Array, weights: Array) -> float:
    """Return the value that has half of the weight below it."""
    order = np.argsort(values)
    summed = np.cumsum(weights[order])
    at = int(np.searchsorted(summed, summed[-1] / 2))
    return float(values[order][min(at, len(values) - 1)])


def weighted_deviation(values: Array, weights: Array) -> float:
    """Return the standard deviation about 0 of a normal variable, from the median magnitude."""
    return weighted_median(np.abs(values), weights) / MEDIAN_OF_NORMAL


def _grown(surprise: Array, pairs: Neighbours) -> Mask:
    """Return the pieces that move: the strong ones, and weak ones that touch them."""
    moves = surprise > _STRONG
    weak = surprise > _WEAK
    for _ in range(len(surprise)):
        beside = np.zeros_like(moves)
        beside[pairs.first[moves[pairs.second]]] = True
        beside[pairs.second[moves[pairs.first]]] = True
        grown = moves | (beside & weak)
        if (grown == moves).all():
            break
        moves = grown
    return moves


def _closed(moves: Mask, pairs: Neighbours) -> Mask:
    """Return the pieces that move, with those into which flow goes on from them alone.

    Somewhere on a thing that turns its flow may cross the camera's epipolar lines by nothing: a
    strip of it seems still, but the world around does not go on from there.
    """
    for _ in range(len(moves)):
        moving, still = np.zeros(len(moves)), np.zeros(len(moves))
        for one, other in ((pairs.first, pairs.second), (pairs.second, pairs.first)):
            moving += np.bincount(one, pairs.joined * moves[other], minlength=len(moves))
            still += np.bincount(one, pairs.joined * ~moves[other], minlength=len(moves))
        closed = moves | (moving > _ALONE * still + _FEWEST)
        if (closed == moves).all():
            break
        moves = closed
    return moves


def _objects(moves: Mask, pairs: Neighbours, pixels: Array) -> Labels:
    """Return the number of each piece's object, from 1: moving pieces between which flow goes on.

    What is still, or too small, has 0.
    """
    together = moves[pairs.first] & moves[pairs.second]
    together &= pairs.joined >= np.maximum(2, _GOES_ON * pairs.length)
    parent = np.arange(len(moves))
    for one, other in zip(pairs.first[together], pairs.second[together], strict=True):
        low, high = sorted((_root(parent, one), _root(parent, other)))
        parent[high] = low
    roots = np.array([_root(parent, each) for each in range(len(moves))])
    size = np.bincount(roots, np.where(moves, pixels, 0), minlength=len(moves))
    order = np.argsort(-size)[:_MOST]
    order = order[size[order] >= max(20, _SMALLEST * pixels.sum())]
    number = np.zeros(len(moves), np.int32)
    number[order] = np.arange(1, len(order) + 1)
    return np.asarray(np.where(moves, number[roots], 0), np.int32)


def _grown_over(labels: Labels, moves: Mask) -> Labels:
    """Return labels, with the moving pixels that have none in the regions that they are joined to.

    Pieces are never smaller than some pixels: what is left of a thing at its rim may have been
    given to what is still. And a strip of a ball that spins fast is too small for a region.
    """
    grown = labels.astype(np.uint8)
    while True:
        beside = cv2.dilate(grown, np.ones((3, 3), np.uint8))
        joins = (grown == 0) & moves & (beside > 0)
        if not joins.any():
            return grown.astype(np.int32)
        grown[joins] = beside[joins]


def connected(labels: Labels, inside: Mask, flow: Array, smooth: float) -> Labels:
    """Return the larger connected parts of a mask of whole pieces, parted where the flow jumps.

    Args:
        labels: Pieces of the frame.
        inside: Which of them count.
        flow: Height x width x 2, pixels, finite.
        smooth: Pixels; a smaller change of flow is no jump.
    """
    count = int(labels.max()) + 1
    pixels = np.bincount(labels.ravel(), minlength=count).astype(np.float64)
    counts = np.bincount(labels[inside], minlength=count) > 0.5 * pixels
    return _objects(counts, neighbours(labels, flow, smooth), pixels)[labels]


def _root(parent: NDArray[np.intp], at: int) -> int:
    while parent[at] != at:
        parent[at] = parent[parent[at]]
        at = int(parent[at])
    return at


def filled(labels: Labels, trusted: Mask) -> Labels:
    """Return labels in which each pixel that does not count has the nearest one's that does."""
    if trusted.all() or not trusted.any():
        return labels
    _, nearest = cv2.distanceTransformWithLabels(
        (~trusted).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    of_pixel = np.zeros(int(nearest.max()) + 1, np.int32)
    of_pixel[nearest[trusted]] = labels[trusted]
    return np.asarray(of_pixel[nearest], np.int32)
