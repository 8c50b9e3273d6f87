"""What moves while the shutter is open: blur from flow and depth."""

from math import ceil

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]

_SAMPLES = 15
"""Places along a path, evenly spaced; an odd number has one in the pixel itself."""

_FARTHEST = 40.0
"""Pixels to either side beyond which nothing is smeared."""

_SAME = 0.02
"""Relative difference of depths up to which two points count as one surface."""


def smeared(light: Array, depth: Array, flow: Array, share: float) -> Array:
    """Return the light that arrives while the shutter is open.

    What is near and moves spreads over what is behind it; where a pixel itself moves, what is
    behind shows through. Paths are straight and centred on the frame's own time.

    Args:
        light: Linear light at the frame's own time.
        depth: z in metres, +inf for sky.
        flow: Pixels right and down to the next frame; unknown where it is not finite.
        share: Of the time to the next frame, how long the shutter is open.

    References:
        McGuire et al., A reconstruction filter for plausible motion blur, I3D 2012, section 4,
        with hard steps for its soft comparisons of depth.
    """
    reach = np.where(np.isfinite(flow), flow, 0).astype(np.float32) * np.float32(share / 2)
    length = np.linalg.norm(reach, axis=-1)
    reach *= np.minimum(1, _FARTHEST / np.maximum(length, 1e-6))[..., None]
    length = np.minimum(length, _FARTHEST)
    if length.max() < 0.25:
        return light
    finite = np.minimum(depth, np.float32(1e6))
    way = _strongest(reach, length)
    row, column = np.indices(depth.shape, np.float32)
    total, weight = np.zeros_like(light), np.zeros_like(depth)
    for step in np.linspace(-1, 1, _SAMPLES, dtype=np.float32):
        x, y = column + step * way[..., 0], row + step * way[..., 1]
        # Nearest pixels: a mean of two would mix what is near with what is behind it.
        seen, other, others = (
            cv2.remap(of, x, y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_REPLICATE)
            for of in (light, finite, length)
        )
        gone = np.abs(step) * np.linalg.norm(way, axis=-1)
        nearer = other < finite * (1 - _SAME)
        behind = other > finite * (1 + _SAME)
        reaches = np.where(nearer, others, np.where(behind, length, np.maximum(length, others)))
        here = (gone <= np.maximum(reaches, 0.5)).astype(np.float32)
        total += here[..., None] * seen
        weight += here
    return np.asarray(total / weight[..., None], np.float32)


def _strongest(reach: Array, length: Array) -> Array:
    """Return the longest path within a path's length of each pixel."""
    height, width = length.shape
    side = max(1, ceil(float(length.max())))
    rows, columns = -(-height // side), -(-width // side)
    padded = np.zeros((rows * side, columns * side, 3), np.float32)
    padded[:height, :width, :2], padded[:height, :width, 2] = reach, length
    tiles = padded.reshape(rows, side, columns, side, 3).swapaxes(1, 2)
    tiles = tiles.reshape(rows, columns, side * side, 3)
    best = np.take_along_axis(tiles, tiles[..., 2:].argmax(2, keepdims=True), 2)[:, :, 0]
    around = np.pad(best, ((1, 1), (1, 1), (0, 0)))
    near = np.stack([around[i : i + rows, j : j + columns] for i in range(3) for j in range(3)], 2)
    chosen = np.take_along_axis(near, near[..., 2:].argmax(2, keepdims=True), 2)[:, :, 0, :2]
    return np.asarray(chosen.repeat(side, 0).repeat(side, 1)[:height, :width], np.float32)
