"""Where a camera stands, where it looks and how much it sees."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.scene import Aim, Carrier, Scene


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


CAR = Carrier((1.2, 2.1), Aim.ROAD, 0.1, (-0.02, 0.03), 0.012)
"""A camera behind a windscreen or on a car's roof: level and straight ahead."""

HAND = Carrier((1.2, 1.8), Aim.ROAD, 0.7, (-0.03, 0.12), 0.05)
"""A walker's camera."""

TURNED = Carrier((0.8, 1.9), Aim.AROUND, 0.0, (0.0, 0.3), 0.09)
"""A camera that is pointed anywhere: at the sky, the ground, to the side."""

ROBOT = Carrier((0.25, 1.0), Aim.AROUND, 0.0, (0.0, 0.06), 0.02)
"""A small machine on wheels or legs."""

HIGH = Carrier((2.5, 9.0), Aim.AROUND, 0.0, (-0.25, 0.15), 0.04)
"""A window upstairs, a balcony, a mast, a drone."""

ON_ROADS = ((0.4, CAR), (0.27, HAND), (0.13, TURNED), (0.12, ROBOT), (0.08, HIGH))
"""Who holds cameras in streets."""

ON_FOOT = ((0.65, replace(HAND, aim=Aim.AROUND)), (0.12, TURNED), (0.14, ROBOT), (0.09, HIGH))
"""Who holds cameras away from roads."""


_CLOSE = 0.35
"""Share of the pictures in a room that are taken of a thing from near."""


def viewpoint(rng: Generator, scene: Scene, aspect: float) -> Viewpoint:
    """Return a random viewpoint of one of the scene's carriers; hand-held where there are none."""
    if scene.subjects and rng.random() < _CLOSE:
        return _near(rng, scene, aspect)
    eye = rng.uniform(*scene.eyes)
    if scene.carriers:
        carrier = _drawn(rng, scene.carriers)
        eye[1] = rng.uniform(*carrier.height)
        degrees = rng.uniform(*carrier.view)
        yaw, pitch, roll = _aimed(rng, scene, carrier, eye)
    else:
        degrees = rng.uniform(35, 90)
        yaw, pitch, roll = _around_room(rng, scene, eye)
    across = 0.5 / np.tan(np.radians(degrees) / 2)
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


def _drawn(rng: Generator, carriers: tuple[tuple[float, Carrier], ...]) -> Carrier:
    shares = np.array([share for share, _ in carriers])
    return carriers[int(rng.choice(len(shares), p=shares / shares.sum()))][1]


def _aimed(
    rng: Generator, scene: Scene, carrier: Carrier, eye: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Return yaw, pitch and roll of a camera in a carrier's hands."""
    pitch, roll = rng.normal(*carrier.pitch), rng.normal(0, carrier.roll)
    if carrier.aim is Aim.SUBJECT and scene.subject is not None:
        sight = scene.subject - eye
        yaw = np.arctan2(sight[0], sight[2])
        pitch += np.arctan2(sight[1], np.hypot(sight[0], sight[2]))
    elif carrier.aim is Aim.ROAD:
        yaw = rng.choice([0.0, np.pi])
    else:
        yaw = rng.uniform(0, 2 * np.pi)
    yaw += rng.normal(0, carrier.yaw)
    return float(yaw), float(np.clip(pitch, -1.3, 1.0)), float(roll)


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
