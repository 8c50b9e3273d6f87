"""Motion blur, made from depth and flow."""

import numpy as np
from numpy.typing import NDArray

Light = NDArray[np.float32]

_MOST = 9
"""Moments of the exposure that are averaged at most."""


def streaked(
    light: Light, depth: NDArray[np.float64], flow: NDArray[np.float64], shutter: float
) -> Light:
    """Return the light that arrives while the shutter is open.

    Every point goes along its flow at an even speed, from half the exposure before the frame's time
    to half after; what is nearer covers what is farther. Behind a thing that moves the frame
    itself stands in for what only other frames see. Points whose flow is unknown stay.

    Args:
        light: Linear light of a sharp frame: height by width by 3.
        depth: z in metres; +inf is the sky.
        flow: Pixels right and down until the next frame; NaN where unknown.
        shutter: Share of the time between two frames that the shutter is open.
    """
    path = np.nan_to_num(flow, nan=0.0) * shutter
    longest = float(np.abs(path).max())
    if longest < 1:
        return light
    # An odd number, so that one of the moments is the frame itself.
    count = int(min(_MOST, 2 * np.ceil(longest / 2) + 1))
    order = np.argsort(-depth, axis=None, kind="stable")
    total = np.zeros_like(light)
    for moment in np.linspace(-0.5, 0.5, count):
        total += _moved(light, path * moment, order)
    return np.asarray(total / count, np.float32)


def _moved(light: Light, shift: NDArray[np.float64], order: NDArray[np.intp]) -> Light:
    """Return the frame with its pixels shifted, drawn in the given order."""
    height, width = light.shape[:2]
    row, column = np.mgrid[:height, :width]
    to_column = (column + shift[..., 0].round()).astype(int).reshape(-1)[order]
    to_row = (row + shift[..., 1].round()).astype(int).reshape(-1)[order]
    inside = (to_column >= 0) & (to_column < width) & (to_row >= 0) & (to_row < height)
    out = light.copy()
    # Of pixels that go to one place the last stays: the nearest.
    out[to_row[inside], to_column[inside]] = light.reshape(-1, 3)[order[inside]]
    return out
