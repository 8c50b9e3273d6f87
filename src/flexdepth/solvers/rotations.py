"""Rotations of many pixels at once."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def axis_angles(rotation: Array) -> Array:
    """Return the axis times the angle, radians, of rotations ... x 3 x 3 of less than half a turn.

    Near none the sine loses nothing, while the dissertation's n / |n| (5.7-5.18) is undefined.
    """
    skew = (rotation - np.swapaxes(rotation, -1, -2)) / 2
    axis = np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=-1)
    sine = np.linalg.norm(axis, axis=-1)
    angle = np.arctan2(sine, (np.trace(rotation, axis1=-2, axis2=-1) - 1) / 2)
    return np.asarray(
        axis * (np.where(sine > 1e-9, angle / np.maximum(sine, 1e-9), 1.0))[..., None]
    )
