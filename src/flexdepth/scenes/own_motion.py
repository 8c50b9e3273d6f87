"""By what points have moved themselves, apart from the camera's motion."""

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.surface import rays
from flexdepth.scenes.pair import Solution
from flexdepth.scenes.words import camera_translation

Array = NDArray[np.float64]


def own_ways(solution: Solution, chosen: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return chosen points and by what each has moved, along the key camera's axes.

    Args:
        solution: In whose unit of depth both are.
        chosen: Height x width; pixels with depth.
    """
    found = solution.found
    row, column = np.nonzero(chosen)
    here = rays(row, column, solution.camera).astype(np.float64) * found.depth[chosen][:, None]
    still = found.camera_motion.pose.rotation, camera_translation(found)
    motion = found.rotation[chosen], found.translation[chosen]
    return here, own_motion(here, motion, still)


def own_motion(points: Array, motion: tuple[Array, Array], camera: tuple[Array, Array]) -> Array:
    """Return by what points have moved beside the static world, along the key camera's axes.

    Args:
        points: Points by 3, in the key camera.
        motion: n (axis times angle) and t of X' = R(n) X + t, each points by 3.
        camera: R0 (3 x 3) and t0 (3) of the static world, of the same.
    """
    twists, translations = motion
    still, way = camera
    moved = turned(points, twists) + translations
    return np.asarray((moved - way) @ still - points)


def turned(points: Array, twists: Array) -> Array:
    """Return the points turned about each its own axis, by Rodrigues' formula (5.7).

    Args:
        points: Points by 3.
        twists: Axis times angle, radians.
    """
    angle = np.linalg.norm(twists, axis=1, keepdims=True)
    axis = twists / np.where(angle > 0, angle, 1.0)
    along = (axis * points).sum(1, keepdims=True) * axis
    across = np.cross(axis, points)
    return np.asarray(along + np.cos(angle) * (points - along) + np.sin(angle) * across)
