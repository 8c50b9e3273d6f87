"""The camera's own motion between two frames, from what moves as the static world does.

Each kind of motion is fitted robustly, and Torr's criterion chooses: an essential matrix alone
always fits something, even where the camera has only turned, or not moved at all.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers import ransac
from flexdepth.solvers.correspondences import Correspondences
from flexdepth.solvers.criterion import COMPLEXITY, MotionKind, gric
from flexdepth.solvers.epipolar import Epipolar, poses
from flexdepth.solvers.least_squares import MEDIAN_OF_NORMAL, cost, refined, squares
from flexdepth.solvers.pose import Pose, angle
from flexdepth.solvers.transfer import Planar, Transfer, Turning, first_rotation, plane_motions
from flexdepth.solvers.two_view import seen_along

Array = NDArray[np.float64]

_SCALE = 3.0
"""Standard deviations at which a match stops pulling at the motion."""

_INLIER = 3.0
"""Standard deviations within which a match counts as explained."""

_STEPS = 10
"""Enough where turning or a plane fits, and no more is spent where they do not."""

_CLEAR = 2.0
"""Standard deviations of parallax that tell before from behind."""

_TELLING = 0.01
"""The share of all matches that overrules the smaller turn before a plane."""


@dataclass(frozen=True, eq=False)
class CameraMotion:
    """How the camera has moved from the key frame to the target.

    Attributes:
        kind: The simplest motion that explains what is seen.
        pose: `target_from_key`; the translation has length 1 where the kind is PLANE or GENERAL,
            and is 0 else.
        alternative: Another motion that explains the same plane; None where there is none.
        normal: Of the plane, in the key camera, unit length; None for other kinds.
        scores: GRIC of each kind, per match; smaller is better.
        inliers: The share of matches within 3 standard deviations of this motion. Where it is
            small, most of what is seen moves by itself, or the matches are wrong.
        noise_factor: How many times noisier the matches are than they were said to be, judged
            by what the most general motion leaves; at least 1. Scores and inliers count it in.
    """

    kind: MotionKind
    pose: Pose
    alternative: Pose | None
    normal: Array | None
    scores: Mapping[MotionKind, float]
    inliers: float
    noise_factor: float

    @property
    def translates(self) -> bool:
        """Whether the camera has moved so far that parallax shows it."""
        return self.kind in (MotionKind.PLANE, MotionKind.GENERAL)


@dataclass(frozen=True, eq=False)
class _Fits:
    """The best motion of each kind, and how far the matches are from it in standard deviations."""

    general: Pose
    rotation: Array
    homography: Array
    square: Mapping[MotionKind, Array]


def camera_motion(seen: Correspondences) -> CameraMotion:
    """Return how the camera has moved.

    Points that move by themselves count as outliers: Geman and McClure's weights leave them out.
    What they are in the end is judged by the noise as it was said, though most matches be worse:
    those that are as good as that tell the motion.
    """
    said = Epipolar(*seen.rays(), seen.focal, seen.noise)
    general = _general_motion(said)
    factor = _noise_factor(squares(said, general))
    epipolar = replace(said, noise=said.noise * factor)
    fits = _fits(epipolar, general)
    scores = {kind: gric(fits.square[kind], COMPLEXITY[kind]) for kind in MotionKind}
    kind = min(MotionKind, key=lambda each: scores[each])
    fits = replace(fits, general=refined(said, fits.general, _SCALE))
    pose, alternative, normal = _chosen(kind, fits, epipolar)
    return CameraMotion(
        kind,
        pose,
        alternative,
        normal,
        MappingProxyType({each: score / len(seen) for each, score in scores.items()}),
        float((fits.square[kind] < _INLIER**2).mean()),
        factor,
    )


def _noise_factor(square: Array) -> float:
    """Return the residuals' standard deviation, from their median, where it is above 1."""
    return max(1.0, float(np.sqrt(np.median(square))) / MEDIAN_OF_NORMAL)


def _fits(epipolar: Epipolar, general: Pose) -> _Fits:
    transfer = Transfer(epipolar.key, epipolar.target, epipolar.focal, epipolar.noise)
    turning, planar = Turning(transfer), Planar(transfer)
    general = refined(epipolar, general, _SCALE)
    rotation = refined(turning, first_rotation(transfer), _SCALE, _STEPS)
    first = ransac.homography(transfer.key, transfer.target, transfer.focal, transfer.noise)
    if first is None:
        first = rotation / np.linalg.norm(rotation)
    homography = refined(planar, first, _SCALE, _STEPS)
    return _Fits(
        general,
        rotation,
        homography,
        {
            MotionKind.STILL: squares(turning, np.eye(3)),
            MotionKind.ROTATION: squares(turning, rotation),
            MotionKind.PLANE: squares(planar, homography),
            MotionKind.GENERAL: squares(epipolar, general),
        },
    )


def _chosen(
    kind: MotionKind, fits: _Fits, epipolar: Epipolar
) -> tuple[Pose, Pose | None, Array | None]:
    """Return the pose of the chosen kind; a plane's other pose and its normal."""
    if kind is MotionKind.GENERAL:
        return forward(fits.general, epipolar), None, None
    if kind is MotionKind.PLANE:
        ranked = _plane_motions(fits, epipolar)
        return ranked[0][0], ranked[1][0] if len(ranked) > 1 else None, ranked[0][1]
    rotation = np.eye(3) if kind is MotionKind.STILL else fits.rotation
    return Pose(rotation, np.zeros(3)), None, None


def _plane_motions(fits: _Fits, epipolar: Epipolar) -> list[tuple[Pose, Array]]:
    """Return the plane's motions, the likelier first.

    What lies in the plane fits all of them alike. So the one that turns less comes first, unless
    another explains more of what lies outside it, by a hundredth of all matches.
    """
    near = fits.square[MotionKind.PLANE] < _INLIER**2

    def support(motion: tuple[Pose, Array]) -> float:
        return float((~near & (squares(epipolar, motion[0]) < _INLIER**2)).mean())

    motions = plane_motions(fits.homography, epipolar.key[near])
    ranked = sorted(motions, key=lambda motion: angle(motion[0].rotation))
    if len(ranked) > 1 and support(ranked[1]) > support(ranked[0]) + _TELLING:
        ranked[:2] = ranked[1::-1]
    return ranked


def _general_motion(epipolar: Epipolar) -> Pose:
    """Return the best of the motions that are found from several beginnings.

    They are one of the four of RANSAC's essential matrix and those of its homography: where a
    plane fills most of the picture, the former may begin in the wrong valley.
    """
    sides = epipolar.key, epipolar.target, epipolar.focal, epipolar.noise
    matrix, homography = ransac.essential_matrix(*sides), ransac.homography(*sides)
    begun = [Pose(np.eye(3), np.array([0.0, 0.0, 1.0]))]
    if matrix is not None:
        begun = [max(poses(matrix), key=lambda pose: _in_front(pose, epipolar))]
    if homography is not None:
        begun += [pose for pose, _ in plane_motions(homography, epipolar.key)]
    scale = 2 * _SCALE
    found = [refined(epipolar, pose, scale, _STEPS) for pose in begun]
    best = min(found, key=lambda pose: cost(squares(epipolar, pose), scale))
    return refined(epipolar, best, scale)


def _in_front(pose: Pose, epipolar: Epipolar) -> int:
    """Return how many more points the motion puts before the camera than behind it.

    Points whose parallax does not clear their noise have no say.
    """
    along = seen_along(epipolar.key, epipolar.target, pose, epipolar.focal)
    clear = np.abs(along.parallax) > _CLEAR * epipolar.noise
    return int(np.where(along.inverse_depth > 0, 1, -1)[clear].sum())


def forward(pose: Pose, epipolar: Epipolar) -> Pose:
    """Return the pose with the sign of its translation that puts most points ahead."""
    back = Pose(pose.rotation, -pose.translation)
    return max(pose, back, key=lambda each: _in_front(each, epipolar))
