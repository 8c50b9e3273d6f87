"""The ways to depth that the table compares: each takes what is seen of a pair, gives a depth."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray
from pairs import Pair, flow_of

import flexdepth
from flexdepth.flow.along_lines import AlongLines
from flexdepth.flow.frames import gray_pair
from flexdepth.flow.matches import Akaze
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.lens import FocalLength
from flexdepth.scenes.prior import as_prior
from flexdepth.solvers.correspondences import from_flow, pixel_centres, rays
from flexdepth.solvers.dissertation import TABLE_5_1, Form
from flexdepth.solvers.ego_motion import camera_motion
from flexdepth.solvers.first_order import Clues, FirstOrder, first_order
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.two_frame import Dense, TwoFrameSettings, two_frame

Array = NDArray[np.float64]
Flow = NDArray[np.float32]

_NEAREST_PIXELS = 0.3
"""Of RANSAC's threshold, or three times the noise where that is more."""


@dataclass(frozen=True, eq=False)
class Case:
    """A pair and the flow that the methods are given."""

    truth: Pair
    flow: Flow
    noise: Flow
    estimated: bool = False

    @property
    def seen(self) -> Seen:
        """What a solver is told, without a prior: the target frame where flow comes from it."""
        truth = self.truth
        seen = Seen(self.flow, self.noise, truth.camera, truth.key)
        if not self.estimated:
            return seen
        search = AlongLines(truth.key, truth.target, truth.camera)
        return replace(seen, target=truth.target, search=search)

    @property
    def pose(self) -> Pose:
        """The camera's true motion."""
        return Pose(self.truth.rotation, self.truth.translation)


def case(truth: Pair, seed: int, noise: float | None) -> Case:
    """Return a pair with flow: true, noisy, or (None) estimated by DIS."""
    return Case(truth, *flow_of(truth, seed, noise), estimated=noise is None)


Row = Callable[[Case], Array]


def constant(given: Case) -> Array:
    """Return one depth for all."""
    return np.ones_like(given.truth.depth)


def essential(given: Case) -> Array:
    """Return OpenCV's depth: RANSAC's essential matrix, `recoverPose`, `triangulatePoints`."""
    seen = given.seen
    key, target = (each[seen.trusted] for each in _rays(seen))
    focal = seen.camera.focal_x
    threshold = max(_NEAREST_PIXELS, 3 * float(np.median(seen.noise[seen.trusted]))) / focal
    one, other = (np.ascontiguousarray(each[:, :2]) for each in (key, target))
    cv2.setRNGSeed(0)
    found, near = cv2.findEssentialMat(
        one, other, np.eye(3), method=cv2.RANSAC, prob=0.9999, threshold=threshold
    )
    if found is None:
        return np.full(seen.noise.shape, np.nan)
    _, rotation, translation, _ = cv2.recoverPose(found[:3], one, other, np.eye(3), mask=near)
    return _triangulated(seen, Pose(np.asarray(rotation), np.asarray(translation).ravel()))


def refined(given: Case) -> Array:
    """Return the same with flexdepth's refined motion of the camera."""
    seen = given.seen
    motion = camera_motion(from_flow(seen.flow, seen.trusted, seen.noise, seen.camera))
    if not motion.translates:
        return np.full(seen.noise.shape, np.nan)
    return _triangulated(seen, motion.pose)


def _rays(seen: Seen) -> tuple[Array, Array]:
    centres = pixel_centres(*seen.noise.shape)
    shift = np.where(seen.trusted[..., None], seen.flow, 0.0)
    return rays(centres, seen.camera), rays(centres + shift, seen.camera)


def _triangulated(seen: Seen, pose: Pose) -> Array:
    """Return the depth of all trusted pixels by one motion; NaN behind the camera."""
    key, target = (each[seen.trusted][:, :2].T for each in _rays(seen))
    still, moved = np.eye(3, 4), np.column_stack([pose.rotation, pose.translation])
    points = cv2.triangulatePoints(still, moved, key, target)
    with np.errstate(divide="ignore", invalid="ignore"):
        z = points[2] / points[3]
    depth = np.full(seen.noise.shape, np.nan)
    depth[seen.trusted] = np.where(z > 0, z, np.nan)
    return depth


def dissertation(form: Form, *, told: bool = False, without: Sequence[str] = ()) -> Row:
    """Return chapter 5's objective, which may change flow that is estimated; other flow is given.

    Args:
        form: As written, or corrected.
        told: Whether all pixels begin with the camera's true motion.
        without: Terms that weigh nothing.
    """
    weights = replace(TABLE_5_1, **dict.fromkeys(without, 0.0))

    def row(given: Case) -> Array:
        pictures = given.truth.key, given.truth.target
        matches = Akaze().between(*pictures)
        frames = gray_pair(*pictures) if given.estimated else None
        start = given.pose if told else None
        settings = FirstOrder(form=form, weights=weights, start=start)
        return first_order(given.seen, settings, Clues(matches.key, matches.target, frames)).depth

    return row


def regions(given: Case) -> Array:
    """Return flexdepth's depth without refinement of every pixel."""
    return two_frame(given.seen, TwoFrameSettings(dense=None)).depth


def dense(given: Case) -> Array:
    """Return flexdepth's depth by geometry alone."""
    return two_frame(given.seen, TwoFrameSettings(dense=Dense())).depth


@cache
def _alone(given: Case) -> DepthMap:
    return flexdepth.predict(given.truth.key, FocalLength(given.truth.camera.focal_x))


def prior_alone(given: Case) -> Array:
    """Return what the bundled model says of the key frame."""
    return _alone(given).depth.astype(np.float64)


def with_prior(given: Case) -> Array:
    """Return flexdepth's depth with the bundled model's as a soft term."""
    prior = as_prior(_alone(given))
    return two_frame(replace(given.seen, prior=prior), TwoFrameSettings(dense=Dense())).depth


ROWS: Mapping[str, Row] = {
    "constant depth": constant,
    "essential matrix": essential,
    "essential, refined": refined,
    "dissertation, as written": dissertation(Form.AS_WRITTEN),
    "as written, true motion": dissertation(Form.AS_WRITTEN, told=True),
    "dissertation, corrected": dissertation(Form.CORRECTED),
    "corrected, true motion": dissertation(Form.CORRECTED, told=True),
    "regions": regions,
    "dense": dense,
    "prior alone": prior_alone,
    "dense with prior": with_prior,
}

BOTH = ("motion_boundaries", "synchrony")
ABLATION: Mapping[str, Row] = {
    f"{form}, {name}": dissertation(form, without=without)
    for form in Form
    for name, without in {
        "complete": (),
        "no borders": BOTH[:1],
        "no synchrony": BOTH[1:],
        "neither": BOTH,
    }.items()
}
"""Table 5.3 with a row that has both terms: the objective with and without its two innovations."""

FULL = "dense"
BASELINE = "essential matrix"
PRIOR = "prior alone"
WITH_PRIOR = "dense with prior"


@dataclass(frozen=True, eq=False)
class Timed:
    """A depth, with the seconds of wall clock and of CPU that it took."""

    depth: Array
    seconds: float
    cpu: float


def timed(row: Row, given: Case) -> Timed:
    """Return a row's depth of a case and what it took."""
    cpu, wall = time.process_time(), time.perf_counter()
    depth = row(given)
    return Timed(depth, time.perf_counter() - wall, time.process_time() - cpu)
