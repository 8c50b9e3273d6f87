"""A take: a scene, its movers and a camera path that together show what was asked for."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.camera_paths import CameraPath, hand_held, on_car, on_robot
from flexdepth.synth.correspondence import (
    STIRS,
    Camera,
    moved,
    other_from_this,
    own_motion,
    parallax,
)
from flexdepth.synth.moments import Play, Sight
from flexdepth.synth.motion import Footing, Motion
from flexdepth.synth.placing import Placed, Surroundings, apart, placed
from flexdepth.synth.render import worth_taking
from flexdepth.synth.shapes import Array
from flexdepth.synth.viewpoints import viewpoint

_TIMES = 5
"""Frames at which collisions and parallax are looked at."""

_NEAREST = 0.3
"""Metres that a camera keeps from what it sees."""

_KEPT = 0.7
"""Share of a mover's pixels that stay in the picture until the next frame."""

_COARSE = 1500
"""Pixels of the first look at a composition."""


@dataclass(frozen=True, eq=False)
class Take:
    """A sequence before it is rendered.

    Attributes:
        play: The scene and its movers.
        path: The camera's.
        focal: In pixels.
        width: Pixels.
        height: Pixels.
        motion: What was asked for.
        footings: What the first frame shows of each mover's feet.
    """

    play: Play
    path: CameraPath
    focal: float
    width: int
    height: int
    motion: Motion
    footings: tuple[Footing, ...]

    def camera(self, frame: int) -> Camera:
        """Return the camera of a frame."""
        return Camera(self.path.at(self.motion.time(frame)), self.focal, self.width, self.height)


@dataclass(frozen=True, eq=False)
class Shares:
    """What a frame shows of the movers.

    Attributes:
        mover: Share of the picture that each fills.
        moving: Share of the picture that moves by itself until the next frame.
        feet: Of each, whether it touches the ground where the camera sees it.
        kept: Share of each one's pixels that are inside the next frame too.
    """

    mover: Array
    moving: float
    feet: tuple[bool, ...]
    kept: Array


def composed(
    rng: Generator, around: Surroundings, number: int, asked: tuple[Motion, int, int]
) -> Take | None:
    """Return a take in a scene; None where this attempt shows not what was asked for.

    Args:
        rng: Draws it.
        around: The scene.
        number: Of the sequence (`Motion.cast`).
        asked: What is to move, width and height in pixels.
    """
    motion, width, height = asked
    path = _path(rng, around, width / height)
    focal = motion.focal or path.start.focal * float(np.hypot(width, height))
    path = path.begun_at(replace(path.start, focal=focal / float(np.hypot(width, height))))
    if not worth_taking(around.stage, path.start, width / height):
        return None
    times = np.array([motion.time(k) for k in _sampled(motion.frames)])
    cast = _placed_cast(
        rng, around, Camera(path.start, focal, width, height), (motion, number, times)
    )
    if cast is None:
        return None
    aimed = _aimed(path, cast, np.arctan(height / 2 / focal))
    play = Play.of(rng, around.stage, around.still, tuple(one.mover for one in cast))
    footings = tuple(one.footing for one in cast)
    take = _strides(rng, Take(play, aimed, focal, width, height, motion, footings))
    if take is None or not shows_it(take, _COARSE, 0.7) or not _passes(take, around):
        return None
    return take if shows_it(take, width * height, 1.0) else None


def _sampled(frames: int) -> list[int]:
    """Return the numbers of some frames, the first two and the last among them."""
    return sorted({0, min(1, frames - 1), *np.linspace(0, frames - 1, _TIMES).astype(int).tolist()})


def _path(rng: Generator, around: Surroundings, aspect: float) -> CameraPath:
    """Return a random path; its beginning is not aimed at anything yet."""
    scene = around.stage.scene
    start = viewpoint(rng, scene, aspect)
    kind = rng.random()
    # Robots and cars do not climb.
    if kind < 0.5 or len(scene.places):
        return hand_held(rng, start)
    if kind < 0.7 or not scene.road:
        return on_robot(rng, start)
    eye = start.eye.copy()
    ahead = np.sign(start.world_from_camera[2, 2])
    eye[0] = -ahead * scene.road * rng.uniform(0.2, 0.5)
    return on_car(rng, replace(start, eye=eye))


def _placed_cast(
    rng: Generator, around: Surroundings, camera: Camera, asked: tuple[Motion, int, Array]
) -> list[Placed] | None:
    """Return all movers, each with room of its own; None where one finds none."""
    motion, number, times = asked
    roles = motion.cast(rng, number)
    low, high = max(motion.moving[0], 0.01), max(motion.moving[1], 0.02)
    total = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    parts = total * rng.dirichlet(np.full(len(roles), 6.0)) if roles else ()
    cast: list[Placed] = []
    for (bends, footing), share in zip(roles, parts, strict=True):
        one = placed(rng, around, camera, (bends, footing, float(share)), times)
        if one is None or not apart([*cast, one]):
            return None
        cast.append(one)
    return cast


def _aimed(path: CameraPath, cast: list[Placed], half_angle: float) -> CameraPath:
    """Return the path with the camera tipped, no more than needed, to see movers and their feet.

    Feet that are to be hidden are left below the picture where that hides no others.
    """
    start = path.start
    if not cast:
        return path
    forward = start.world_from_camera[:, 2]
    pitch = float(np.arcsin(forward[1]))
    boxes = np.array([one.boxes[0] for one in cast])
    distance = np.hypot(*(boxes.mean(1) - start.eye)[:, [0, 2]].T)
    low, high = (np.arctan2(boxes[:, k, 1] - start.eye[1], distance) for k in (0, 1))
    middle = (low + high) / 2
    seen, hidden = (
        [one.footing is each for one in cast] for each in (Footing.SEEN, Footing.HIDDEN)
    )
    lowest = np.where(seen, low - 0.04, middle)
    least = np.where(hidden, low + 0.06 + half_angle, middle - 0.9 * half_angle)
    tipped = min(max(pitch, float(least.max())), lowest.min() + 0.92 * half_angle)
    level = np.cross(forward, (0, 1, 0))
    axis = level / np.linalg.norm(level) * np.clip(tipped - pitch, -path.tips, path.tips)
    rotation = np.asarray(cv2.Rodrigues(axis)[0]) @ start.world_from_camera
    return path.begun_at(replace(start, world_from_camera=rotation))


def _strides(rng: Generator, take: Take) -> Take | None:
    """Return the take with the camera's travel scaled to the parallax that was asked for."""
    motion = take.motion
    if motion.parallax is None or motion.frames < 2:
        return take
    low, high = motion.parallax
    wanted = float(rng.uniform(low + 0.1 * (high - low), high - 0.1 * (high - low)))
    for _ in range(2):
        now = float(np.median(parallaxes(take, _COARSE)))
        if not 0 < now < np.inf:
            return None
        take = replace(take, path=take.path.striding(wanted / now))
    return take


def look(take: Take, frame: int, pixels: int) -> tuple[Camera, Sight]:
    """Return what a frame sees at about so many pixels, and the camera that sees as many."""
    full = take.camera(frame)
    shrunk = min(1.0, float(np.sqrt(pixels / (take.width * take.height))))
    width, height = round(shrunk * take.width), round(shrunk * take.height)
    camera = Camera(full.view, full.focal * width / full.width, width, height)
    rays = camera.rays(camera.pixels())
    return camera, take.play.at(take.motion.time(frame)).sight(full.view, rays)


def parallaxes(take: Take, pixels: int) -> list[float]:
    """Return `pair_parallax` of some of the frames, the first among them."""
    pairs = [k for k in _sampled(take.motion.frames) if k + 1 < take.motion.frames]
    return [pair_parallax(take, k, pixels) for k in pairs]


def pair_parallax(take: Take, frame: int, pixels: int) -> float:
    """Return the median parallax in pixels of what is still, from one frame to the next.

    Args:
        take: What is filmed.
        frame: The first of the two.
        pixels: About how many are looked at; those of the answer are the take's own.
    """
    camera, sight = look(take, frame, pixels)
    pose = other_from_this(camera.view, take.camera(frame + 1).view)
    still = (sight.triangle >= 0) & (sight.triangle < len(take.play.still))
    if not still.any():
        return 0.0
    return float(np.median(parallax(sight, take.camera(frame), pose)[still]))


def shares(take: Take, frame: int, pixels: int) -> Shares:
    """Return what a frame shows of the movers, at about so many pixels."""
    camera, sight = look(take, frame, pixels)
    now = take.play.at(take.motion.time(frame))
    later = take.play.at(take.motion.time(frame + 1))
    owner = owners(take.play, sight)
    motion = own_motion(now, later, sight)
    high = sight.depth * (sight.rays @ camera.view.world_from_camera[1]) + camera.view.eye[1]
    feet = []
    for number, mover in enumerate(take.play.movers):
        own = now.moving[take.play.owner == number, :, 1]
        ankle = own.min() + max(0.06, 0.1 * float(np.ptp(own)))
        feet.append(mover.kind.stands and bool((high[owner == number] < ankle).any()))
    next_view = take.camera(frame + 1).view
    pose = other_from_this(camera.view, next_view)
    inside = camera.shows(moved(sight, motion @ camera.view.world_from_camera, pose))
    kept = _by_owner(owner, inside, len(feet)) / np.maximum(
        _by_owner(owner, owner >= 0, len(feet)), 1
    )
    moving = float((np.linalg.norm(motion, axis=1) > STIRS).mean())
    return Shares(_by_owner(owner, owner >= 0, len(feet)) / len(owner), moving, tuple(feet), kept)


def _by_owner(owner: NDArray[np.intp], counted: NDArray[np.bool_], count: int) -> Array:
    return np.bincount(owner[(owner >= 0) & counted], minlength=count).astype(float)


def owners(play: Play, sight: Sight) -> NDArray[np.intp]:
    """Return the number of the mover that each ray meets; -1 for what is still and the sky."""
    own = sight.triangle - len(play.still)
    return np.where(own >= 0, play.owner[np.maximum(own, 0)] if len(play.owner) else -1, -1)


def shows_it(take: Take, pixels: int, tolerance: float) -> bool:
    """Return whether a take is what was asked for: its first frame, and all its parallax.

    Args:
        take: It.
        pixels: About how many are looked at.
        tolerance: Factor by which the shares of movers may be off, 1 or less; below 1 parallax
            is not looked at.
    """
    motion, shown = take.motion, shares(take, 0, pixels)
    low, high = motion.moving[0] * tolerance, motion.moving[1] / tolerance
    least = 0.2 * low / max(len(shown.mover), 1)
    feet = [footing is Footing.SEEN for footing in take.footings]
    within = low <= shown.moving <= high and bool((shown.mover > least).all())
    within &= bool((shown.kept > _KEPT * tolerance).all())
    if not within or list(shown.feet) != feet:
        return False
    asked = motion.parallax
    if asked is None or tolerance < 1 or motion.frames < 2:
        return True
    return all(asked[0] <= one <= asked[1] for one in parallaxes(take, pixels))


def _passes(take: Take, around: Surroundings) -> bool:
    """Return whether the camera runs into nothing on its way."""
    frames = _sampled(take.motion.frames)
    for frame in frames:
        if look(take, frame, 300)[1].depth.min() < _NEAREST:
            return False
    eyes = np.array([take.camera(k).view.eye for k in frames])
    steps = np.diff(eyes, axis=0)
    length = np.linalg.norm(steps, axis=1)
    gone = length > 1e-6
    if not gone.any():
        return True
    start, step = eyes[:-1][gone].astype(np.float32), steps[gone].astype(np.float32)
    blocked_after = around.stage.tracer.run(start, step, query="DISTANCE")
    return bool((blocked_after > 1 + _NEAREST / length[gone]).all())
