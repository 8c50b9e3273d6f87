"""Whether the pictures themselves say that something moves.

Where there is no texture, as in the sky, estimated flow is what its surroundings have smoothed into
it, and may look like a motion of its own. Then the place on the epipolar line that is nearest to
where the flow leads looks as much alike as that, and nothing is known of the pixels.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.ego_motion import CameraMotion
from flexdepth.solvers.least_squares import deviation
from flexdepth.solvers.pieces import Labels
from flexdepth.solvers.sight import Sight
from flexdepth.solvers.two_view import seen_along

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

_WORSE = 0.5
"""By how much standing still must explain a region worse than its flow does: squared differences
in gray, in their variance where nothing moves."""

_CUT = 3.0
"""Standard deviations at which differences in gray count no further."""

_LEAST = 0.5
"""Shades of gray: differences deviate at least so far."""


def told_by_pictures(
    labels: Labels, sight: Sight, still: Array, frames: tuple[Image, Image]
) -> Labels:
    """Return the labels of what the pictures, too, say moves by itself; 0 elsewhere.

    Args:
        labels: Of the regions that move by themselves as far as flow tells.
        sight: What is seen.
        still: The flow if all stood still, pixels; NaN where it is not known.
        frames: Key and target, RGB.
    """
    off = [_difference(*frames, flow) for flow in (sight.flow, still)]
    known = sight.trusted & np.isfinite(off[0]) & np.isfinite(off[1])
    if not known.any():
        return labels
    typical = max(_LEAST, deviation(off[0][known]))
    moved, stood = (np.minimum(each[known] / typical, _CUT) ** 2 for each in off)
    pixels = np.bincount(labels[known], minlength=int(labels.max()) + 1)
    worse = np.bincount(labels[known], stood - moved, minlength=len(pixels))
    told = worse > _WORSE * np.maximum(pixels, 1)
    return np.asarray(np.where(told[labels], labels, 0), np.int32)


def standing(sight: Sight, camera: CameraMotion) -> Array:
    """Return the flow of what stands still that is nearest to the flow that is seen."""
    place = sight.key @ camera.pose.rotation.T
    infinity = (place[..., :2] / place[..., 2:] - sight.key[..., :2]) * sight.focal
    if not camera.translates:
        return np.asarray(infinity)
    along = seen_along(sight.key, sight.target, camera.pose, sight.focal)
    translation = camera.pose.translation
    way = sight.focal * (translation[:2] - place[..., :2] / place[..., 2:] * translation[2])
    unit = way / np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-12)
    return np.asarray(infinity + np.maximum(along.parallax, 0.0)[..., None] * unit)


def _difference(key: Image, target: Image, flow: Array) -> Array:
    """Return by how many shades of gray the frames differ where the flow leads; NaN outside."""
    one, other = (
        cv2.cvtColor(each, cv2.COLOR_RGB2GRAY).astype(np.float32) for each in (key, target)
    )
    row, column = np.mgrid[: key.shape[0], : key.shape[1]]
    across, down = (
        (column + flow[..., 0]).astype(np.float32),
        (row + flow[..., 1]).astype(np.float32),
    )
    there = cv2.remap(
        other, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=np.nan
    )
    return np.asarray(np.abs(there - one), np.float64)
