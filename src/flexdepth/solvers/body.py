"""What a rigid thing's shape and turning tell of its place: whether it is a ball, lies or flies."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.ground import Ground
from flexdepth.solvers.pose import Pose, own_motion

Array = NDArray[np.float64]

_ROUND = 0.02
"""What a ball's points are off its sphere, in radii."""

_SHOWN = 0.75
"""The radius of a ball, in square roots of the area that it shows, is no more than this."""

_FEWEST = 30

_OFF = 0.03
"""What a ball's middle is off, in radii."""


@dataclass(frozen=True, eq=False)
class Ball:
    """A ball at scale 1.

    Attributes:
        middle: C, which is not seen.
        radius: r.
    """

    middle: Array
    radius: float

    def at_rest(self, floor: Ground) -> float | None:
        """Return ln s at which it lies on the ground; None if at no scale.

        Where a ball touches the ground is hidden by the ball: what is seen below its outline lies
        farther than that. But its middle is its radius above the ground: s = |g| (n·C + r).

        Args:
            floor: The ground, g = |g| n.
        """
        deep = float(floor.normal @ self.middle) + self.radius
        return float(np.log(deep * np.linalg.norm(floor.plane))) if deep > 0 else None

    def wobble(self, turn: float) -> float:
        """Return how far its middle's motion is uncertain, if it turns by so many radians."""
        return _OFF * turn * self.radius

    def moved(self, motion: Pose, camera: Pose) -> Array:
        """Return how its middle moves, the camera's turning undone."""
        return own_motion(self.middle, motion, camera)


def ball(points: Array, size: float) -> Ball | None:
    """Return the ball whose front is seen; None for what is no ball.

    Args:
        points: Of a rigid thing at scale 1, n x 3.
        size: The square root of the area that it shows, at scale 1.
    """
    if len(points) < _FEWEST:
        return None
    rows = np.column_stack([2 * points, np.ones(len(points))])
    solved = np.linalg.lstsq(rows, (points**2).sum(axis=1), rcond=None)[0]
    middle, square = solved[:3], float(solved[3] + solved[:3] @ solved[:3])
    if not 0 < square < (_SHOWN * size) ** 2:
        return None
    radius = float(np.sqrt(square))
    off = np.linalg.norm(points - middle, axis=1) - radius
    return Ball(middle, radius) if float(np.sqrt(np.mean(off**2))) < _ROUND * radius else None


def tipping(motion: Pose, camera: Pose, floor: Ground) -> float:
    """Return the radians by which a thing turns about neither an upright nor a level axis.

    What is pushed or driven on the ground turns about an upright axis alone, and what rolls, about
    a level one. In the air things turn about any.

    Args:
        motion: The thing's.
        camera: The camera's.
        floor: The ground.
    """
    turn = cv2.Rodrigues(camera.rotation.T @ motion.rotation)[0].ravel()
    upright = float(turn @ floor.normal)
    return min(abs(upright), float(np.linalg.norm(turn - upright * floor.normal)))
