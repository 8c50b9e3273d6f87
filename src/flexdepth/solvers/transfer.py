"""Motions that give each pixel of the key frame one place in the target: rotation and plane.

The residual is the place that is seen minus the place that is said, in the target frame, over the
noise: two components.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.least_squares import weights
from flexdepth.solvers.pose import Pose, cross, tangents, turned

Array = NDArray[np.float64]

_NEAREST = 1e-9
"""A point is said to be nowhere nearer than this to the plane of the target camera's centre."""

_AHEAD = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Transfer:
    """Matched points; the attributes are those of `Epipolar`."""

    key: Array
    target: Array
    focal: Array
    noise: Array

    def residuals(self, state: Array) -> Array:
        """Return n x 2 for a 3 x 3 matrix that takes rays to rays."""
        said = self.key @ state.T
        depth = _away_from_zero(said[:, 2:])
        return (said[:, :2] / depth - self.target[:, :2]) * self.focal / self.noise[:, None]

    def projection(self, state: Array) -> Array:
        """Return the residuals' derivative by the place H x: n x 2 x 3."""
        said = self.key @ state.T
        depth = _away_from_zero(said[:, 2])
        slope = np.zeros((len(said), 2, 3))
        slope[:, 0, 0] = slope[:, 1, 1] = 1 / depth
        slope[:, :, 2] = -said[:, :2] / depth[:, None] ** 2
        return slope * (self.focal / self.noise[:, None])[:, :, None]


@dataclass(frozen=True, eq=False)
class Turning:
    """A camera that turns and stays: y ~ R x. A step is a twist on the left of the rotation."""

    transfer: Transfer

    def residuals(self, state: Array) -> Array:
        """Return n x 2."""
        return self.transfer.residuals(state)

    def jacobian(self, state: Array) -> Array:
        """Return n x 2 x 3: d(ω x q) = -[q]x dω."""
        places = self.transfer.key @ state.T
        columns = np.stack([places @ cross(axis).T for axis in np.eye(3)], axis=2)
        return np.asarray(self.transfer.projection(state) @ columns)

    def moved(self, state: Array, step: Array) -> Array:
        """Return the rotation after a step."""
        return turned(state, step)


@dataclass(frozen=True, eq=False)
class Planar:
    """A camera before a plane: y ~ H x, with |H| = 1. A step is H's way over the unit sphere."""

    transfer: Transfer

    def residuals(self, state: Array) -> Array:
        """Return n x 2."""
        return self.transfer.residuals(state)

    def jacobian(self, state: Array) -> Array:
        """Return n x 2 x 8."""
        ways = tangents(state.ravel()).reshape(8, 3, 3)
        columns = np.einsum("pab,nb->nap", ways, self.transfer.key, optimize=True)
        return np.asarray(self.transfer.projection(state) @ columns)

    def moved(self, state: Array, step: Array) -> Array:
        """Return the homography after a step."""
        way = (step @ tangents(state.ravel())).reshape(3, 3)
        return np.asarray((state + way) / np.linalg.norm(state + way))


def first_rotation(seen: Transfer, rounds: int = 20) -> Array:
    """Return a rotation to begin with, that half of the points or more agree on.

    Wahba's problem by SVD, reweighted: the scale begins at the median residual and follows it down
    to three standard deviations.
    """
    key, target = (each / np.linalg.norm(each, axis=1)[:, None] for each in (seen.key, seen.target))
    trust = np.ones(len(key))
    rotation = np.eye(3)
    for _ in range(rounds):
        left, _, right = np.linalg.svd((target * trust[:, None]).T @ key)
        rotation = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        square = (seen.residuals(rotation) ** 2).sum(1)
        trust = weights(square, max(3.0, float(np.sqrt(np.median(square))))) / seen.noise**2
    return np.asarray(rotation)


def plane_motions(homography: Array, key: Array) -> tuple[tuple[Pose, Array], ...]:
    """Return the motions, with |t| = 1, and unit normals of the plane that a homography stands for.

    H ~ R + t nᵀ, and nᵀ x > 0 where the plane is seen. The algebra has two solutions up to signs;
    one with which a tenth of the given points or more would be behind the camera is left out where
    the other does better. (OpenCV's decomposition takes singular values within 1e-3 of each other
    for a pure rotation, which at a focal length of 1000 pixels is a pixel of parallax.)

    Args:
        homography: Of rays, from key to target, up to a factor.
        key: Rays to the points of the plane, n x 3, z = 1.

    References:
        Ma, Soatto, Košecká and Sastry, An invitation to 3-D vision, 2004, theorem 5.19.
    """
    _, values, axes = np.linalg.svd(homography)
    matrix = homography / values[1] * np.sign(np.median(key @ homography[2]))
    longest, _, shortest = values / values[1]
    first, second, third = axes
    parts = np.sqrt(max(1 - shortest**2, 0.0)), np.sqrt(max(longest**2 - 1, 0.0))
    length = float(np.hypot(*parts))
    if length < _NEAREST:  # A turn alone: every plane and every direction does.
        return ((Pose(matrix, _AHEAD), _AHEAD),)
    found = []
    for sign in (1.0, -1.0):
        along = (parts[0] * first + sign * parts[1] * third) / length
        kept, carried = (
            np.stack([a, b, np.cross(a, b)], axis=1)
            for a, b in ((second, along), (matrix @ second, matrix @ along))
        )
        rotation = carried @ kept.T
        ahead = float(np.mean(key @ kept[:, 2] > 0))
        normal = kept[:, 2] if ahead > 0.5 else -kept[:, 2]
        shift = (matrix - rotation) @ normal
        way = float(np.linalg.norm(shift))
        pose = Pose(rotation, shift / way if way > 0 else _AHEAD)
        found.append((max(ahead, 1 - ahead), pose, normal))
    best = max(share for share, _, _ in found)
    return tuple((pose, normal) for share, pose, normal in found if share > 0.9 or share == best)


def _away_from_zero(depth: Array) -> Array:
    return np.where(np.abs(depth) < _NEAREST, _NEAREST, depth)
