"""Small pieces of a frame within which flow, and colour if there is any, hardly change.

References:
    Felzenszwalb and Huttenlocher, Efficient graph-based image segmentation, IJCV 2004: two pieces
    grow together where what parts them is no larger than what varies within each.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Labels = NDArray[np.int32]

_GRANULARITY = 3.0
"""Pixels of flow times pixels of area: what a piece of one pixel may differ from its neighbour."""

_ACROSS = 3.0
"""How much more a motion of its own counts than flow that depth explains."""

_COLOUR = 0.02
"""Pixels of flow that one step of CIE L*a*b* counts."""

_SMALLEST = 1.3e-3
"""The share of the frame that a piece has at least."""

_ALIKE, _NEAR, _WINDOW = 3.0, 3.0, 7
"""Noise is averaged away before flow is cut, among pixels whose flow is alike to within about so
many of its standard deviations: of those within so many pixels, in a window of this width."""


def pieces(
    flow: Array, across: Array, noise: float, image: NDArray[np.uint8] | None = None
) -> Labels:
    """Return a number for each pixel's piece, from 0.

    Args:
        flow: Height x width x 2, pixels, finite.
        across: Height x width: pixels off the camera's epipolar lines, finite.
        noise: The flow's typical standard deviation, pixels.
        image: RGB.
    """
    moves = np.dstack([flow, _ACROSS * across]).astype(np.float32)
    maps = [cv2.bilateralFilter(moves, _WINDOW, _ALIKE * noise, _NEAR)]
    if image is not None:
        colour = cv2.cvtColor(image.astype(np.float32) / 255, cv2.COLOR_RGB2LAB)
        maps.append(cv2.GaussianBlur(colour, (5, 5), 0) * np.float32(_COLOUR))
    smallest = max(8, round(_SMALLEST * across.size))
    cut = cv2.ximgproc.segmentation.createGraphSegmentation(0.01, _GRANULARITY, smallest)
    return np.asarray(cut.processImage(np.dstack(maps)), np.int32)


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Which pieces touch, each pair once.

    Attributes:
        first: Number of one piece.
        second: Of the other, larger.
        length: Pixel edges between them.
        jump: Median length of the flow's change over these, pixels.
        joined: How many of the edges the flow crosses without a jump.
    """

    first: NDArray[np.intp]
    second: NDArray[np.intp]
    length: Array
    jump: Array
    joined: Array


def neighbours(labels: Labels, flow: Array, smooth: float) -> Neighbours:
    """Return the pairs of pieces that touch.

    Args:
        labels: Numbers of the pieces.
        flow: Height x width x 2, pixels, finite.
        smooth: Pixels; a smaller change of flow is no jump.
    """
    ends, changes = [], []
    for axis in (0, 1):
        here, there = _beside(labels, axis), _beside(flow, axis)
        apart = here[0] != here[1]
        ends.append(np.stack([here[0][apart], here[1][apart]], axis=1))
        changes.append(np.linalg.norm(there[1][apart] - there[0][apart], axis=-1))
    pairs, change = np.sort(np.concatenate(ends), axis=1), np.concatenate(changes)
    count = int(labels.max()) + 1
    codes, which, length = np.unique(
        pairs[:, 0].astype(np.int64) * count + pairs[:, 1], return_inverse=True, return_counts=True
    )
    order = np.lexsort((change, which))
    begin = np.concatenate([[0], np.cumsum(length)[:-1]]).astype(np.intp)
    return Neighbours(
        (codes // count).astype(np.intp),
        (codes % count).astype(np.intp),
        length.astype(np.float64),
        change[order][begin + length // 2] if len(codes) else np.zeros(0),
        np.bincount(which, change < smooth, minlength=len(codes)).astype(np.float64),
    )


def _beside(values: NDArray[np.generic], axis: int) -> tuple[NDArray, NDArray]:  # type: ignore[type-arg]
    return (values[:-1], values[1:]) if axis == 0 else (values[:, :-1], values[:, 1:])
