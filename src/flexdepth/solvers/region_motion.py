"""The motion and the shape of what moves by itself, up to one scale for each region.

A region is first taken to be flat and upright, as a picture that stands on the ground: its inverse
depth is a profile p, of which only the scale is open, and x goes to π(R x + p τ). Without a ground
p is 1. (A camera that looks down on a person has the feet farther in z than the head.) What is left
of the flow, in pixels, is split along and across the line on which a pixel goes when it comes
nearer. Across it, it is noise or bending. Along it, relief adds to that; a thing is about
as deep as it is wide, so relief has a standard deviation that is known beforehand. R and τ
maximise the posterior; relief is what the posterior mean makes of the part along the line. Where
the part across is no more than noise, the region is rigid, and its depth is triangulated.

Only that prior tells a bending thing's relief from its bending: along the epipolar line the two
look alike (which the dissertation's chapter 5 leaves out).
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers import ransac
from flexdepth.solvers.answer import Kind
from flexdepth.solvers.epipolar import poses
from flexdepth.solvers.least_squares import deviation, dot, weights
from flexdepth.solvers.pose import Pose, cross, turned
from flexdepth.solvers.two_view import seen_along

Array = NDArray[np.float64]

_RELIEF = 0.25
"""Relief's standard deviation, in widths of the region."""

_BUMPS = 10.0
"""How many independent depths a region's relief has: its neighbours are alike."""

_TURN = 0.06
"""Radians by which a thing typically turns beside the camera; balls roll much more."""

_STEPS = 15
_POINTS = 800
"""More pixels than these add no accuracy to six numbers."""

_RIGID = 1.6
"""What one rigid motion may leave across the lines, in what is left on what is still."""

_LIKELY = 3.0
"""Relief that is larger by this factor than a thing's length makes likely is none: it bends."""

_NEAREST = 0.3
"""The least inverse depth of a pixel, in that of its region."""


@dataclass(frozen=True, eq=False)
class RegionMotion:
    """How a region moves, and its shape.

    Attributes:
        kind: Rigid or flexible.
        pose: `target_from_key` at the region's own scale.
        inverse_depth: Of each pixel at that scale; about 1.
        spread: Relative standard deviation of each, without that of the common scale.
        across: Pixels: the root mean square of what is left across the epipolar lines.
    """

    kind: Kind
    pose: Pose
    inverse_depth: Array
    spread: Array
    across: float


@dataclass(frozen=True, eq=False)
class Pixels:
    """A region's pixels.

    Attributes:
        key: Rays in the key frame, n x 3.
        target: Rays in the target.
        noise: n, pixels.
        focal: Across and down, pixels.
        profile: Inverse depth of the region, were it flat and upright; about 1.
    """

    key: Array
    target: Array
    noise: Array
    focal: Array
    profile: Array

    def some(self) -> "Pixels":
        """Return a part of them, spread over all."""
        at = np.linspace(0, len(self.noise) - 1, min(len(self.noise), _POINTS)).astype(int)
        return Pixels(self.key[at], self.target[at], self.noise[at], self.focal, self.profile[at])

    def width(self) -> float:
        """Return the smaller extent as an angle."""
        return float(2 * np.sqrt(3) * self.key[:, :2].std(axis=0).min())

    def length(self) -> float:
        """Return the larger extent as an angle."""
        return float(2 * np.sqrt(3) * self.key[:, :2].std(axis=0).max())


@dataclass(frozen=True, eq=False)
class _Left:
    """What a motion leaves of the flow, pixels.

    Attributes:
        along: Along the lines of relief.
        across: Across them.
        slope: Pixels per relative change of inverse depth.
        way: The lines' unit directions.
        projection: The places' derivative by R x + p τ.
        shift: And by τ.
        place: R x.
    """

    along: Array
    across: Array
    slope: Array
    way: Array
    projection: Array
    shift: Array
    place: Array


def region_motion(pixels: Pixels, camera: Pose, floor: float) -> RegionMotion:
    """Return the likeliest motion and shape of a region.

    Args:
        pixels: Of the region; at least 6.
        camera: The camera's own motion, to which a thing's rotation is likely near.
        floor: Pixels that what is still is off its epipolar lines.
    """
    some = pixels.some()
    begun = [Pose(camera.rotation, _flat_shift(some, camera.rotation))]
    begun += _turned_much(some)
    found = [_refined(some, begin, camera, floor) for begin in begun]
    _, best = min(found, key=lambda each: each[0])
    left = _left(some, best)
    across = float(np.sqrt(np.mean(np.minimum(left.across**2, np.quantile(left.across**2, 0.9)))))
    noise = float(np.sqrt(np.mean(some.noise**2)))
    if across < _RIGID * max(noise, floor * 2):
        rigid = _rigid(pixels, best, across)
        if np.std(rigid.inverse_depth) < _LIKELY * _RELIEF * pixels.length():
            return rigid
    return flexible_motion(pixels, camera)


def flexible_motion(pixels: Pixels, camera: Pose) -> RegionMotion:
    """Return the motion of a region that bends: it turns as the world does beside the camera."""
    return _flexible(pixels, Pose(camera.rotation, _flat_shift(pixels.some(), camera.rotation)))


def explained(pixels: Pixels, pose: Pose, floor: float) -> bool:
    """Return whether a rigid motion that was found elsewhere moves this region too.

    It leaves no more than noise across its lines, and puts the region at about the same depth.
    """
    if len(pixels.noise) < 6:
        return False
    left = _left(pixels, pose)
    noise = float(np.sqrt(np.mean(pixels.noise**2)))
    inverse = seen_along(pixels.key, pixels.target, pose, pixels.focal).inverse_depth
    middle = float(np.median(np.where(np.isfinite(inverse), inverse, -1.0)))
    return deviation(left.across) < _RIGID * max(noise, 2 * floor) and 0.5 < middle < 2


def _flat_shift(pixels: Pixels, rotation: Array) -> Array:
    """Return τ of y ~ R x + p τ: three linear unknowns, twice reweighted."""
    place, y = pixels.key @ rotation.T, pixels.target
    rows = np.zeros((len(y), 2, 3))
    rows[:, 0, 0] = rows[:, 1, 1] = 1
    rows[:, :, 2] = -y[:, :2]
    rows *= pixels.profile[:, None, None]
    right = y[:, :2] * place[:, 2:] - place[:, :2]
    weight, shift = np.ones(len(y)), np.zeros(3)
    for _ in range(3):
        heavy = rows * weight[:, None, None]
        normal = np.einsum("nij,nik->jk", heavy, rows)
        ridge = 1e-12 * np.trace(normal) * np.eye(3)
        shift = np.linalg.solve(normal + ridge, np.einsum("nij,ni->j", heavy, right))
        square = ((right - rows @ shift) ** 2).sum(axis=1)
        weight = weights(square, 2 * float(np.sqrt(np.median(square))) + 1e-9)
    return np.asarray(shift)


def _turned_much(pixels: Pixels) -> list[Pose]:
    """Return where to begin with a thing that turns by itself, as a ball does that rolls."""
    if len(pixels.noise) < 60:
        return []
    sides = pixels.key, pixels.target, pixels.focal, pixels.noise
    matrix = ransac.essential_matrix(*sides)
    if matrix is None:
        return []

    def ahead(pose: Pose) -> float:
        return float(np.mean(seen_along(*sides[:2], pose, pixels.focal).inverse_depth > 0))

    best = max(poses(matrix), key=ahead)
    inverse = seen_along(*sides[:2], best, pixels.focal).inverse_depth
    middle = float(np.median(np.where(np.isfinite(inverse), inverse, -1.0)))
    if not middle > 0 or ahead(best) < 0.9:
        return []
    return [Pose(best.rotation, best.translation * middle)]


def _left(pixels: Pixels, pose: Pose) -> _Left:
    place = pixels.key @ pose.rotation.T
    there = place + pixels.profile[:, None] * pose.translation
    depth = np.maximum(there[:, 2], 1e-3)
    projection = np.zeros((len(depth), 2, 3))
    projection[:, 0, 0] = projection[:, 1, 1] = 1 / depth
    projection[:, :, 2] = -there[:, :2] / depth[:, None] ** 2
    projection *= pixels.focal[:, None]
    error = (pixels.target[:, :2] - there[:, :2] / depth[:, None]) * pixels.focal
    shift = projection * pixels.profile[:, None, None]
    line = shift @ pose.translation
    slope = np.sqrt(dot(line, line))
    way = line / np.maximum(slope, 1e-12)[:, None]
    along = dot(error, way)
    across = error[:, 1] * way[:, 0] - error[:, 0] * way[:, 1]
    return _Left(along, across, slope, way, projection, shift, place)


def _refined(pixels: Pixels, pose: Pose, camera: Pose, floor: float) -> tuple[float, Pose]:
    """Return the posterior's maximum from one beginning, and minus its logarithm."""
    relief = _RELIEF * pixels.width()
    thinned = min(1.0, _BUMPS / len(pixels.noise))
    sd = np.maximum(pixels.noise, 2 * floor)
    scale = 6.0
    cost, damping = np.inf, 1e-4
    best = pose
    for _ in range(_STEPS):
        left = _left(pixels, pose)
        turn = np.asarray(cv2.Rodrigues(pose.rotation @ camera.rotation.T)[0], np.float64).ravel()
        square = (left.across / sd) ** 2
        tight = 1 / (sd**2 + (relief * left.slope) ** 2 / thinned)
        now = float(
            np.minimum(square, scale**2).sum()
            + (np.minimum(tight * left.along**2, scale**2)).sum()
            + 3 * np.log1p((turn**2).sum() / _TURN**2)
        )
        if now < cost:
            if cost - now < 1e-6 * cost:
                return now, pose
            cost, best, damping = now, pose, max(damping / 10, 1e-9)
            weight = weights(square, scale) / sd**2
            step_from = left, weight, tight, turn
        else:
            damping *= 10
        pose = _step(best, *step_from, damping)
    return cost, best


def _step(
    pose: Pose, left: _Left, weight: Array, tight: Array, turn: Array, damping: float
) -> Pose:
    normal_way = np.stack([-left.way[:, 1], left.way[:, 0]], axis=1)
    turns = np.stack([-left.place @ cross(axis) for axis in np.eye(3)], axis=2)
    jacobian = np.concatenate([left.projection @ turns, left.shift], axis=2)
    along = np.einsum("ni,nij->nj", left.way, jacobian)
    across = np.einsum("ni,nij->nj", normal_way, jacobian)
    normal = (across * weight[:, None]).T @ across + (along * tight[:, None]).T @ along
    right = across.T @ (weight * left.across) + along.T @ (tight * left.along)
    prior = 3 / (_TURN**2 + float((turn**2).sum()))
    normal[:3, :3] += prior * np.eye(3)
    right[:3] -= prior * turn
    step = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), right)
    return Pose(turned(pose.rotation, step[:3]), pose.translation + step[3:])


def _rigid(pixels: Pixels, pose: Pose, across: float) -> RegionMotion:
    along = seen_along(pixels.key, pixels.target, pose, pixels.focal)
    slope = _left(pixels, pose).slope
    relief = _RELIEF * pixels.width() * slope
    share = relief**2 / (relief**2 + pixels.noise**2 + 1e-12)
    raw = np.where(np.isfinite(along.inverse_depth), along.inverse_depth / pixels.profile, 1.0)
    inverse = pixels.profile * np.clip(1 + share * (raw - 1), _NEAREST, 1 / _NEAREST)
    spread = np.sqrt(share) * pixels.noise / np.maximum(slope, 1e-9)
    return RegionMotion(Kind.RIGID, pose, inverse, np.minimum(spread, 1.0), across)


def _flexible(pixels: Pixels, pose: Pose) -> RegionMotion:
    left = _left(pixels, pose)
    bending = float(np.mean(np.minimum(left.across**2, np.quantile(left.across**2, 0.9))))
    relief = float(np.median(_RELIEF * pixels.width() * left.slope)) ** 2
    surplus = float(np.mean(left.along**2)) - relief
    share = relief / (relief + max(surplus, bending) + 1e-12)
    change = share * left.along / np.maximum(left.slope, 1e-9)
    spread = np.sqrt((1 - share) * relief) / np.maximum(left.slope, 1e-9)
    inverse = pixels.profile * np.clip(1 + change, _NEAREST, 1 / _NEAREST)
    return RegionMotion(
        Kind.FLEXIBLE, pose, inverse, np.minimum(spread, 1.0), float(np.sqrt(bending))
    )
