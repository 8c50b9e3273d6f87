"""Rotation and translation: X_target = R X_key + t."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pose:
    """The motion `target_from_key`.

    Attributes:
        rotation: 3 x 3.
        translation: 3 numbers; of length 1 where only its direction is known.
    """

    rotation: Array
    translation: Array


def cross(vector: Array) -> Array:
    """Return [v]x, the matrix with [v]x w = v x w."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def turned(rotation: Array, twist: Array) -> Array:
    """Return exp([ω]x) R: the rotation followed by one about ω by |ω| radians."""
    return np.asarray(cv2.Rodrigues(twist)[0]) @ rotation


def angle(rotation: Array) -> float:
    """Return by how many radians a rotation turns, 0 to π.

    From sine and cosine both: the cosine alone loses an angle below 1e-8, the sine one near π, and
    OpenCV's inverse of Rodrigues' formula says 0 below 1e-5.
    """
    skew = rotation - rotation.T
    sine = float(np.linalg.norm([skew[2, 1], skew[0, 2], skew[1, 0]])) / 2
    return float(np.arctan2(sine, (np.trace(rotation) - 1) / 2))


def own_motion(place: Array, motion: Pose, camera: Pose) -> Array:
    """Return how a point of a thing moves in the key camera, the camera's turning undone.

    Args:
        place: X, 3 numbers.
        motion: The thing's.
        camera: The camera's.
    """
    there = motion.rotation @ place + motion.translation
    return np.asarray(camera.rotation.T @ there - place)


def tangents(unit: Array) -> Array:
    """Return orthonormal rows that span what is orthogonal to a unit vector."""
    return np.linalg.svd(unit[None])[2][1:]
