"""The epipolar constraint yᵀ E x = 0 with E = [t]x R, for X_target = R X_key + t.

References:
    Hartley and Zisserman, Multiple view geometry, 2nd edition, 9.6 and 11.4.3 (Sampson). Equation
    (5.3) of the dissertation has this E, its (5.6) the motion X_target = R (X_key - t), to which
    it does not belong: the latter's is -R [t]x.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.least_squares import dot
from flexdepth.solvers.pose import Pose, cross, tangents, turned

Array = NDArray[np.float64]

_NEVER = 1e-300
"""Added to squared lengths, so that a vanishing essential matrix divides by no zero."""


@dataclass(frozen=True, eq=False)
class Epipolar:
    """How far matched points are from their epipolar lines, for rotation and direction of t.

    The residual is √2 times the Sampson distance over the noise. Sampson's splits an error evenly
    between the two frames; the noise is that of target - key, which √2 gives back. A step has five
    numbers: a twist on the left of the rotation, and t's way over the unit sphere.

    Attributes:
        key: Rays n x 3, z = 1.
        target: Likewise.
        focal: Across and down, pixels.
        noise: n standard deviations, pixels.
    """

    key: Array
    target: Array
    focal: Array
    noise: Array

    def residuals(self, state: Pose) -> Array:
        """Return n x 1."""
        product, *lines = self._parts(essential(state))
        length = _length(*lines)
        return np.asarray(product / length / self.noise * np.sqrt(2))[:, None]

    def jacobian(self, state: Pose) -> Array:
        """Return n x 1 x 5.

        With r = p / l and q = p / l², dr = (dp - q l dl) / l, and both dp and l dl are linear in
        dE: each residual has one 3 x 3 gradient by E, whatever E may change by.
        """
        product, in_target, in_key = self._parts(essential(state))
        length = _length(in_target, in_key)
        share = (product / length**2)[:, None] / self.focal
        left, right = self.target.T.copy(), (share * in_key).T
        left[:2] -= (share * in_target).T
        by_matrix = left[:, None] * self.key.T
        by_matrix[:, :2] -= self.target.T[:, None] * right
        by_step = np.reshape(_changes(state), (-1, 9)) @ by_matrix.reshape(9, -1)
        return np.asarray(by_step * (np.sqrt(2) / (length * self.noise))).T[:, None, :]

    def moved(self, state: Pose, step: Array) -> Pose:
        """Return the pose after a step."""
        direction = state.translation + step[3:] @ tangents(state.translation)
        return Pose(turned(state.rotation, step[:3]), direction / np.linalg.norm(direction))

    def _parts(self, matrix: Array) -> tuple[Array, Array, Array]:
        """Return yᵀ E x and its gradient by the pixels in the target and in the key frame."""
        line = self.target_lines(matrix)
        in_target = line[:, :2] / self.focal
        in_key = (self.target @ matrix)[:, :2] / self.focal
        return dot(self.target, line), in_target, in_key

    def target_lines(self, matrix: Array) -> Array:
        """Return the epipolar lines E x in the target frame."""
        return np.asarray(self.key @ matrix.T)


def _length(in_target: Array, in_key: Array) -> Array:
    """Return the length of the gradient by all four pixels."""
    return np.asarray(np.sqrt(dot(in_target, in_target) + dot(in_key, in_key) + _NEVER))


def essential(pose: Pose) -> Array:
    """Return E = [t]x R."""
    return np.asarray(cross(pose.translation) @ pose.rotation)


def poses(matrix: Array) -> tuple[Pose, ...]:
    """Return the four motions, with |t| = 1, that have an essential matrix up to its sign."""
    left, _, right = np.linalg.svd(matrix)
    left, right = left * np.sign(np.linalg.det(left)), right * np.sign(np.linalg.det(right))
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    rotations = (left @ quarter @ right, left @ quarter.T @ right)
    return tuple(Pose(each, sign * left[:, 2]) for each in rotations for sign in (1.0, -1.0))


def _changes(state: Pose) -> list[Array]:
    """Return the derivative of E by each of the five numbers of a step."""
    matrix = cross(state.translation)
    turns = [matrix @ cross(axis) @ state.rotation for axis in np.eye(3)]
    return turns + [cross(way) @ state.rotation for way in tangents(state.translation)]
