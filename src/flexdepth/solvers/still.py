"""What stands still after all: a second look at the pictures, once the camera's motion is known.

Flow that is looked for without that knowledge is not to be trusted in much of a frame, and has its
own motion where it is wrong. A search along the camera's epipolar lines finds more of what stands
still, and where what it finds looks as much alike, nothing is said to move.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.correspondences import pixel_centres, rays
from flexdepth.solvers.ego_motion import CameraMotion
from flexdepth.solvers.pictures import told_by_pictures
from flexdepth.solvers.pieces import Labels
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.sight import Sight

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MOST = 0.5
"""The share of a region's pixels that may stand still as well, if it moves."""


def looked_again(
    seen: Seen, sight: Sight, labels: Labels, camera: CameraMotion
) -> tuple[Labels, Sight]:
    """Return the labels of what moves by itself, and what is seen, after a second look.

    Args:
        seen: The two frames; without `search` nothing changes.
        sight: What is seen of them so far.
        labels: Of the regions that move by themselves as far as flow tells.
        camera: Its motion.
    """
    if seen.search is None or not camera.translates:
        return labels, sight
    believed = np.where(seen.trusted[..., None], seen.flow, np.float32(np.nan))
    found = seen.search(camera.pose.rotation, camera.pose.translation, believed)
    stands = np.isfinite(found.noise)
    moves = _share(labels, sight.trusted, stands) <= _MOST
    if seen.image is not None and seen.target is not None:
        alone = np.where(stands[..., None], found.flow, np.nan)
        moves[told_by_pictures(labels, sight, alone, (seen.image, seen.target))] = True
    labels = np.where(moves[labels], labels, 0).astype(np.int32)
    still = stands & (labels == 0)
    flow = np.where(still[..., None], found.flow, sight.flow).astype(np.float64)
    again = replace(
        sight,
        flow=flow,
        target=rays(pixel_centres(*still.shape) + flow, seen.camera),
        noise=np.where(still, found.noise, sight.noise),
        trusted=sight.trusted | still,
    )
    return labels, again


def _share(labels: Labels, trusted: Mask, stands: Mask) -> Array:
    """Return which share of the trusted pixels of each region stands still as well."""
    count = int(labels.max()) + 1
    pixels = np.bincount(labels[trusted], minlength=count)
    return np.bincount(labels[trusted & stands], minlength=count) / np.maximum(pixels, 1)
