"""Where a camera stands, where it looks and how much it sees."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.scene import Scene


@dataclass(frozen=True, eq=False)
class Viewpoint:
    """A pinhole camera in the world.

    Attributes:
        eye: The optical centre, metres.
        world_from_camera: Rotation; its columns are the camera's x (right), y (down), z (forward).
        focal: Focal length in image diagonals.
    """

    eye: NDArray[np.float64]
    world_from_camera: NDArray[np.float64]
    focal: float


def looking(yaw: float, pitch: float, roll: float) -> NDArray[np.float64]:
    """Return `world_from_camera` for a heading; pitch up and roll clockwise are positive."""
    forward = np.array([np.sin(yaw) * np.cos(pitch), np.sin(pitch), np.cos(yaw) * np.cos(pitch)])
    right = np.array([-np.cos(yaw), 0.0, np.sin(yaw)])
    down = np.cross(forward, right)
    turned = np.cos(roll) * right + np.sin(roll) * down
    return np.stack([turned, np.cross(forward, turned), forward], 1)


def viewpoint(rng: Generator, scene: Scene, aspect: float) -> Viewpoint:
    """Return a random viewpoint: hand-held indoors, from a car or the pavement outdoors."""
    if scene.subjects and rng.random() < 0.35:
        return _near(rng, scene, aspect)
    eye = rng.uniform(*scene.eyes)
    degrees = rng.uniform(45, 85) if scene.outdoors else rng.uniform(42, 82)
    across = 0.5 / np.tan(np.radians(degrees) / 2)
    yaw, pitch, roll = _along_street(rng) if scene.outdoors else _around_room(rng, scene, eye)
    focal = float(across * aspect / np.hypot(aspect, 1))
    return Viewpoint(eye, looking(yaw, pitch, roll), focal)


def _near(rng: Generator, scene: Scene, aspect: float) -> Viewpoint:
    """Return a viewpoint 0.3 to 1.5 m from a point of a thing, mostly from above."""
    low, high = scene.subjects[int(rng.integers(len(scene.subjects)))]
    point = rng.uniform(low, high)
    point[1] = high[1] if rng.random() < 0.6 else point[1]
    away, up = rng.uniform(0, 2 * np.pi), rng.uniform(0.05, 0.9)
    distance = np.exp(rng.uniform(np.log(0.35), np.log(1.5)))
    path = np.array([np.cos(away) * np.cos(up), np.sin(up), np.sin(away) * np.cos(up)])
    eye = np.clip(point + distance * path, scene.eyes[0] * (1, 0, 1), scene.eyes[1])
    sight = point + rng.normal(0, 0.1, 3) - eye
    yaw, pitch = np.arctan2(sight[0], sight[2]), np.arctan2(sight[1], np.hypot(sight[0], sight[2]))
    across = 0.5 / np.tan(np.radians(rng.uniform(35, 75)) / 2)
    roll = float(rng.normal(0, 0.08))
    focal = float(across * aspect / np.hypot(aspect, 1))
    return Viewpoint(eye, looking(float(yaw), float(pitch), roll), focal)


def _along_street(rng: Generator) -> tuple[float, float, float]:
    """Return yaw, pitch and roll of a camera that mostly follows the road."""
    spread = 0.12 if rng.random() < 0.6 else 0.6
    yaw = rng.choice([0.0, np.pi]) + rng.normal(0, spread)
    return float(yaw), float(rng.normal(-0.02, 0.07)), float(rng.normal(0, 0.03))


def _around_room(
    rng: Generator, scene: Scene, eye: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Return yaw, pitch and roll of a camera that looks at a thing, across the room or anywhere."""
    kind = rng.random()
    roll = float(rng.normal(0, 0.06))
    if kind < 0.15:
        return float(rng.uniform(0, 2 * np.pi)), float(rng.normal(-0.15, 0.25)), roll
    if kind < 0.55:
        thing = scene.parts[int(rng.integers(len(scene.parts)))].mesh.corners
        sight = thing.mean((0, 1)) - eye + rng.normal(0, 0.25, 3)
    else:
        sight = (scene.eyes[0] + scene.eyes[1]) / 2 - eye + rng.normal(0, 0.7, 3) * (1, 0, 1)
        sight[1] = np.hypot(sight[0], sight[2]) * rng.normal(-0.18, 0.2)
    pitch = np.arctan2(sight[1], np.hypot(sight[0], sight[2]))
    return float(np.arctan2(sight[0], sight[2])), float(np.clip(pitch, -1.1, 0.6)), roll
