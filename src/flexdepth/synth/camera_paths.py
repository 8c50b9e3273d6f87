"""How cameras move: held in a hand, on a robot, on a car."""

from dataclasses import dataclass, replace
from math import pi

import cv2
import numpy as np
from numpy.random import Generator

from flexdepth.synth.shapes import Array, turn
from flexdepth.synth.viewpoints import Viewpoint

_TREMOR = 3
"""Sines in the unrest of a camera."""


@dataclass(frozen=True, eq=False)
class CameraPath:
    """A camera that travels an arc and trembles.

    Attributes:
        name: Who carries it: hand, robot or car.
        start: Where it is at time 0.
        velocity: Metres a second at the beginning; it turns with the camera.
        turning: Yaw, radians a second, from z towards x.
        shake: Metres of unrest: sines by x, y and z.
        wobble: Radians of unrest about the camera's axes: sines by x, y and z.
        rate: Radians a second of each sine.
        phase: Of each sine by six: three of `shake`, three of `wobble`.
        tips: Radians by which it may be tipped to see what moves.
    """

    name: str
    start: Viewpoint
    velocity: Array
    turning: float
    shake: Array
    wobble: Array
    rate: Array
    phase: Array
    tips: float

    def at(self, time: float) -> Viewpoint:
        """Return the camera after `time` seconds."""
        angle = self.rate[:, None] * time + self.phase
        unrest = np.sin(angle) - np.sin(self.phase)
        half = self.turning * time / 2
        travelled = turn(half) @ self.velocity * (time * float(np.sinc(half / pi)))
        eye = self.start.eye + travelled + (self.shake * unrest[:, :3]).sum(0)
        tremble = np.asarray(cv2.Rodrigues((self.wobble * unrest[:, 3:]).sum(0))[0])
        rotation = turn(self.turning * time) @ self.start.world_from_camera @ tremble
        return Viewpoint(eye, rotation, self.start.focal)

    def striding(self, factor: float) -> "CameraPath":
        """Return the path with all its translation `factor` times as long; it turns as before."""
        return replace(self, velocity=factor * self.velocity, shake=factor * self.shake)

    def begun_at(self, start: Viewpoint) -> "CameraPath":
        """Return the same movement from another beginning."""
        return replace(self, start=start)


def hand_held(rng: Generator, start: Viewpoint) -> CameraPath:
    """Return a camera in the hand of somebody who stands, pans or strolls."""
    way = rng.uniform(0, 2 * pi)
    speed = rng.uniform(0.05, 1.0) * np.array([np.sin(way), rng.normal(0, 0.1), np.cos(way)])
    return _carried(rng, ("hand", start), speed, (rng.normal(0, 0.12), 1.2), (0.012, 0.008))


def on_robot(rng: Generator, start: Viewpoint) -> CameraPath:
    """Return a camera low on a robot that drives over the floor where it looks."""
    eye = start.eye * (1, 0, 1) + (0, rng.uniform(0.2, 1.1), 0)
    level = replace(start, eye=eye)
    ahead = _level(start.world_from_camera[:, 2]) * rng.uniform(0.1, 1.0)
    return _carried(rng, ("robot", level), ahead, (rng.normal(0, 0.25), 0.5), (0.001, 0.001))


def on_car(rng: Generator, start: Viewpoint) -> CameraPath:
    """Return a camera behind the windscreen of a car that follows the road along z."""
    side = np.sign(start.world_from_camera[2, 2])
    ahead = np.array([0, 0, side]) * rng.uniform(2, 14)
    return _carried(rng, ("car", start), ahead, (rng.normal(0, 0.03), 0.12), (0.006, 0.002))


def _carried(
    rng: Generator,
    whose: tuple[str, Viewpoint],
    velocity: Array,
    turns: tuple[float, float],
    unrest: tuple[float, float],
) -> CameraPath:
    rate = 2 * pi * np.array([0.6, 1.7, 3.1]) * rng.uniform(0.7, 1.3, _TREMOR)
    fading = np.array([1.0, 0.6, 0.25])[:, None]
    return CameraPath(
        *whose,
        velocity=velocity,
        turning=float(turns[0]),
        shake=unrest[0] * fading * rng.normal(size=(_TREMOR, 3)),
        wobble=unrest[1] * fading * rng.normal(size=(_TREMOR, 3)),
        rate=rate,
        phase=rng.uniform(0, 2 * pi, (_TREMOR, 6)),
        tips=turns[1],
    )


def _level(direction: Array) -> Array:
    flat = direction * (1, 0, 1)
    return np.asarray(flat / max(float(np.linalg.norm(flat)), 1e-9))
