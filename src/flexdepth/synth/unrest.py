"""How a camera moves while it takes a still, and the blur that this leaves."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.correspondence import Camera, other_from_this
from flexdepth.synth.render import Rendering
from flexdepth.synth.scene import Scene
from flexdepth.synth.shapes import Array
from flexdepth.synth.shutter import smeared
from flexdepth.synth.viewpoints import Viewpoint

Light = NDArray[np.float32]

MOVED = 0.2
"""Share of the stills during which the camera moves."""

_TIMES = 13
"""Of an exposure at which the camera's place is drawn; between them it goes straight on."""

_SECONDS = 1 / 60, 1 / 12
"""Shortest and longest exposure of a picture whose camera moves, by daylight."""

_DAYLIGHT = 0.15
"""Geometric mean of the light of a picture that is taken by day."""

_PATIENCE = 1 / 6
"""Seconds beyond which nobody holds a camera."""

_NEAREST = 0.05
"""Share of its depth that a point keeps; one that comes closer is lost from sight."""


@dataclass(frozen=True)
class Gait:
    """How somebody or something moves the camera that it carries.

    Attributes:
        turning: Spread of the steady turning about each axis, radians a second.
        tremor: Of what comes to that at random, likewise.
        ahead: Least and most speed forward, metres a second.
        sway: Spread of the speed any other way.
    """

    turning: float
    tremor: float
    ahead: tuple[float, float]
    sway: float


STANDING = Gait(0.12, 0.4, (0.0, 0.0), 0.03)
"""Somebody who stands still and presses the button."""

WALKING = Gait(0.12, 0.4, (0.4, 1.5), 0.12)
"""Somebody who walks on."""

ROLLING = Gait(0.12, 0.2, (0.1, 1.0), 0.02)
"""A robot on wheels."""

DRIVING = Gait(0.02, 0.15, (2.0, 14.0), 0.05)
"""A car."""


@dataclass(frozen=True, eq=False)
class Unrest:
    """Where a camera is while its shutter is open, as seen from its mean place.

    Attributes:
        turned: Evenly spaced times by axis times radians, in the camera's axes.
        gone: Times by metres right, down and forward.
    """

    turned: Array
    gone: Array

    @classmethod
    def drawn(cls, rng: Generator, gait: Gait, forward: Array, seconds: float) -> "Unrest":
        """Return a random way of so many seconds; `forward` is in the camera's axes."""
        turning = rng.normal(0, gait.turning, 3) + rng.normal(0, gait.tremor, (_TIMES, 3))
        speed = rng.uniform(*gait.ahead) * forward + rng.normal(0, gait.sway, 3)
        sway = rng.normal(0, gait.sway, (_TIMES, 3))
        ways = (seconds / _TIMES * np.cumsum(of, 0) for of in (turning, speed + sway))
        turned, gone = (way - way.mean(0) for way in ways)
        return cls(turned, gone)

    def at(self, view: Viewpoint, time: float) -> Viewpoint:
        """Return the camera at a time from -1, where the shutter opens, to 1."""
        times = np.linspace(-1, 1, len(self.turned))
        turned, gone = (
            np.array([np.interp(time, times, axis) for axis in way.T])
            for way in (self.turned, self.gone)
        )
        rotation = view.world_from_camera @ np.asarray(cv2.Rodrigues(turned)[0])
        return replace(
            view, eye=view.eye + view.world_from_camera @ gone, world_from_camera=rotation
        )


def unsteady(rng: Generator, scene: Scene, view: Viewpoint, seen: Rendering) -> Light:
    """Return the light of a still; in a share `MOVED` of them the camera moves.

    The shutter is open for longer where there is less light.
    """
    if rng.random() >= MOVED:
        return seen.light
    middle = float(np.exp(np.log(seen.light.mean(-1) + 1e-4).mean()))
    seconds = np.exp(rng.uniform(*np.log(_SECONDS))) * np.sqrt(_DAYLIGHT / middle)
    level = view.world_from_camera[:, 2] * (1, 0, 1)
    forward = view.world_from_camera.T @ (level / max(float(np.linalg.norm(level)), 1e-6))
    gait = gait_of(rng, scene, view)
    return blurred(seen, view, Unrest.drawn(rng, gait, forward, min(float(seconds), _PATIENCE)))


def gait_of(rng: Generator, scene: Scene, view: Viewpoint) -> Gait:
    """Return how the camera of a still moves, from where it is and where it looks."""
    forward = view.world_from_camera[:, 2]
    along = scene.road > abs(view.eye[0]) and abs(forward[2]) > 0.95
    if along and rng.random() < 0.6:
        return DRIVING
    if view.eye[1] < 0.7 and abs(forward[1]) < 0.2 and rng.random() < 0.6:
        return ROLLING
    return WALKING if not scene.subjects and rng.random() < 0.3 else STANDING


def blurred(seen: Rendering, view: Viewpoint, unrest: Unrest) -> Light:
    """Return what a camera takes that is at `view` in the mean and moves; nothing else does."""
    height, width = seen.depth.shape
    camera = Camera(view, seen.focal, width, height)
    rays = camera.rays(camera.pixels()).T.astype(np.float32)
    # In units of its depth a point is on its ray at z = 1, and nothing moves the sky.
    nearness = 1 / seen.depth.ravel()
    centred = (seen.focal * rays[:2]).astype(np.float32)

    def ways(time: float) -> NDArray[np.floating]:
        rotation, translation = other_from_this(view, unrest.at(view, time))
        x, y, z = rotation.astype(np.float32) @ rays + np.outer(
            translation.astype(np.float32), nearness
        )
        safe = np.where(z > _NEAREST, z, np.nan)
        way = np.float32(seen.focal) * np.stack([x, y]) / safe - centred
        return way.T.reshape(height, width, 2)

    return smeared(seen.light, seen.depth, ways)
