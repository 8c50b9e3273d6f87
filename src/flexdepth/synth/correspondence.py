"""Where each visible point is at another time, seen by another camera: exact flow and occlusion."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.synth.moments import Moment, Sight
from flexdepth.synth.shapes import Array
from flexdepth.synth.viewpoints import Viewpoint

STIRS = 1e-6
"""Metres of own motion above which a point counts as moving."""

_NEAREST = 1e-3
"""z in metres below which a point cannot be projected."""

_HIDDEN = 1e-4
"""A point is hidden where a surface is nearer by more than this share of its depth (and metres)."""


@dataclass(frozen=True, eq=False)
class Camera:
    """A viewpoint with its picture: pixel centres at half integers, the middle looked through.

    Attributes:
        view: Where it is; its focal length in diagonals is not used.
        focal: In pixels.
        width: Pixels.
        height: Pixels.
    """

    view: Viewpoint
    focal: float
    width: int
    height: int

    @property
    def middle(self) -> Array:
        """The principal point, x and y."""
        return np.array([self.width / 2, self.height / 2])

    def pixels(self) -> Array:
        """Return the centre of every pixel, row by row."""
        row, column = np.mgrid[: self.height, : self.width].reshape(2, -1)
        return np.stack([column + 0.5, row + 0.5], 1)

    def rays(self, pixels: Array) -> Array:
        """Return the directions (x, y, 1) through points of the picture."""
        return np.concatenate([(pixels - self.middle) / self.focal, np.ones((len(pixels), 1))], 1)

    def project(self, points: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Return where points of the camera are in the picture, and whether they are ahead of it.

        Args:
            points: Points by (x, y, z), metres.
        """
        ahead = points[:, 2] > _NEAREST
        safe = np.where(ahead[:, None], points, 1.0)
        return self.focal * safe[:, :2] / safe[:, 2:] + self.middle, ahead

    def shows(self, points: Array) -> NDArray[np.bool_]:
        """Return whether points of the camera are inside the picture."""
        place, ahead = self.project(points)
        return ahead & (place >= 0).all(1) & (place <= (self.width, self.height)).all(1)


@dataclass(frozen=True, eq=False)
class Correspondence:
    """What becomes of each pixel's point between two frames.

    Attributes:
        flow: Height by width by (x, y): pixels to the point's place in the other frame. NaN where
            it is then behind the camera. Of the sky it is what the camera's rotation gives.
        occluded: Where the point is not seen in the other frame: it is behind something, beside
            the picture or behind the camera.
        motion: Height by width by 3: the point's own motion in metres, in the axes of this
            frame's camera. A point X is at other_from_this (X + motion).
        moving: Where the own motion is more than a millionth of a metre.
    """

    flow: Array
    occluded: NDArray[np.bool_]
    motion: Array
    moving: NDArray[np.bool_]


def other_from_this(this: Viewpoint, other: Viewpoint) -> tuple[Array, Array]:
    """Return the rotation and the translation that take one camera's coordinates to another's."""
    rotation = other.world_from_camera.T @ this.world_from_camera
    return rotation, other.world_from_camera.T @ (this.eye - other.eye)


def correspondence(
    here: tuple[Camera, Moment, Sight], there: tuple[Camera, Moment]
) -> Correspondence:
    """Return where the points that one frame sees are in another."""
    camera, moment, sight = here
    other, later = there
    motion = own_motion(moment, later, sight) @ camera.view.world_from_camera
    place = moved(sight, motion, other_from_this(camera.view, other.view))
    seen_at, ahead = other.project(place)
    depth = np.where(np.isinf(sight.depth), np.inf, place[:, 2])
    inside = other.shows(place)
    hidden = np.ones(len(depth), bool)
    front = later.sight(other.view, other.rays(seen_at[inside]))
    hidden[inside] = front.depth < depth[inside] * (1 - _HIDDEN) - _HIDDEN
    hidden[inside] &= front.triangle != sight.triangle[inside]
    flow = np.where(ahead[:, None], seen_at - camera.pixels(), np.nan)
    shape = camera.height, camera.width
    return Correspondence(
        flow.reshape(*shape, 2),
        hidden.reshape(shape),
        motion.reshape(*shape, 3),
        (np.linalg.norm(motion, axis=1) > STIRS).reshape(shape),
    )


def own_motion(moment: Moment, later: Moment, sight: Sight) -> Array:
    """Return how far each seen point moves itself, metres, in the world's axes.

    The point keeps its place in its triangle, whose corners are elsewhere at the other time.
    """
    motion = np.zeros((len(sight.depth), 3))
    count = len(moment.still)
    own = np.flatnonzero(sight.triangle >= count)
    triangle = sight.triangle[own] - count
    shift = later.moving[triangle] - moment.moving[triangle]
    motion[own] = (sight.weights[own, :, None] * shift).sum(1)
    return motion


def moved(sight: Sight, motion: Array, pose: tuple[Array, Array]) -> Array:
    """Return the seen points in another camera; of the sky, the direction.

    Args:
        sight: What one camera sees.
        motion: Own motion of each point, in that camera's axes.
        pose: Rotation and translation from that camera to the other.
    """
    rotation, translation = pose
    sky = np.isinf(sight.depth)[:, None]
    depth = np.where(sky, 1.0, sight.depth[:, None])
    turned = (sight.rays * depth + motion) @ rotation.T
    return np.asarray(np.where(sky, turned, turned + translation))


def parallax(sight: Sight, camera: Camera, pose: tuple[Array, Array]) -> Array:
    """Return the pixels by which the camera's translation moves each still point; sky by 0.

    A point that it brings beside or behind the camera moves by +inf.
    """
    still, ahead = camera.project(moved(sight, np.zeros_like(sight.rays), pose))
    turned, also = camera.project(sight.rays @ pose[0].T)
    return np.where(ahead & also, np.linalg.norm(still - turned, axis=1), np.inf)
