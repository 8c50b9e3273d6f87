"""Where a camera stands, where it looks and how much it sees."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.scene import Aim, Carrier, Scene

Array = NDArray[np.float64]

_STOREY = 2.6
"""Metres by which what is looked at is higher or lower at most, on stairs."""


@dataclass(frozen=True, eq=False)
class Viewpoint:
    """A pinhole camera in the world.

    Attributes:
        eye: The optical centre, metres.
        world_from_camera: Rotation; its columns are the camera's x (right), y (down), z (forward).
        focal: Focal length in image diagonals.
    """

    eye: Array
    world_from_camera: Array
    focal: float


def looking(yaw: float, pitch: float, roll: float) -> Array:
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

STANDING = Carrier((1.2, 1.8), Aim.ACROSS, 0.1, (-0.17, 0.19), 0.06, (35.0, 90.0))
"""Somebody who stands in a room and looks across it."""

SEATED = Carrier((0.7, 1.2), Aim.ACROSS, 0.1, (-0.1, 0.15), 0.06, (35.0, 90.0))
"""Somebody who sits there."""

BENT = Carrier((0.05, 1.9), Aim.NEAR, 0.05, (0.0, 0.06), 0.08, (35.0, 75.0))
"""Somebody who holds the camera close to a thing."""

VACUUM = Carrier((0.15, 0.6), Aim.ACROSS, 0.8, (0.03, 0.06), 0.012, (50.0, 100.0))
"""A robot that cleans or carries, low over the floor."""

TALL_ROBOT = Carrier((0.6, 1.2), Aim.ACROSS, 0.5, (-0.06, 0.07), 0.015, (50.0, 95.0))
"""A robot that delivers or shows a face on a stick."""

FIXED = Carrier((2.2, 3.6), Aim.EDGE, 0.15, (-0.45, 0.13), 0.03, (60.0, 105.0))
"""A camera under the ceiling that watches a room."""


def _at_things(carrier: Carrier) -> Carrier:
    """Return somebody who turns the camera to one thing of a room."""
    return replace(carrier, aim=Aim.THING, pitch=(0.0, 0.06))


def _anywhere(carrier: Carrier) -> Carrier:
    """Return somebody who turns the camera anywhere in a room."""
    return replace(carrier, aim=Aim.AROUND, pitch=(-0.15, 0.25))


ON_ROADS = ((0.4, CAR), (0.27, HAND), (0.13, TURNED), (0.12, ROBOT), (0.08, HIGH))
"""Who holds cameras in streets."""

ON_FOOT = ((0.65, replace(HAND, aim=Aim.AROUND)), (0.12, TURNED), (0.14, ROBOT), (0.09, HIGH))
"""Who holds cameras away from roads."""

IN_ROOMS = (
    (0.29, BENT),
    (0.18, STANDING), (0.15, _at_things(STANDING)), (0.06, _anywhere(STANDING)),
    (0.07, SEATED), (0.06, _at_things(SEATED)), (0.02, _anywhere(SEATED)),
    (0.07, VACUUM), (0.05, TALL_ROBOT), (0.05, FIXED),
)  # fmt: skip
"""Who holds cameras in rooms."""

_ON_STEPS = replace(STANDING, pitch=(-0.22, 0.2), view=(45.0, 100.0))

ON_STAIRS = (
    (0.56, _ON_STEPS), (0.08, _at_things(_ON_STEPS)), (0.04, _anywhere(_ON_STEPS)),
    (0.08, replace(_ON_STEPS, aim=Aim.AROUND, pitch=(-0.7, 0.2))),
    (0.05, replace(_ON_STEPS, aim=Aim.AROUND, pitch=(0.5, 0.25))),
    (0.07, replace(SEATED, view=(45.0, 100.0))), (0.07, replace(VACUUM, height=(0.3, 0.7))),
    (0.05, replace(FIXED, height=(1.8, 2.0), aim=Aim.ACROSS)),
)  # fmt: skip
"""Who holds cameras on stairs: they look along the flights, down into the well and up; robots have
legs."""


def viewpoint(rng: Generator, scene: Scene, aspect: float) -> Viewpoint:
    """Return a random viewpoint of one of the scene's carriers."""
    carrier = _drawn(rng, scene.carriers)
    height = rng.uniform(*np.minimum(carrier.height, scene.ceiling))
    if carrier.aim is Aim.NEAR and scene.subjects:
        eye, sight = _near(rng, scene, carrier)
    else:
        eye = _floor(rng, scene, carrier.aim) + np.array([0, height, 0])
        sight = _sight(rng, scene, carrier.aim, eye, height)
    yaw = np.arctan2(sight[0], sight[2]) + rng.normal(0, carrier.yaw)
    pitch = np.arctan2(sight[1], np.hypot(sight[0], sight[2])) + rng.normal(*carrier.pitch)
    rotation = looking(float(yaw), float(np.clip(pitch, -1.3, 1.0)), rng.normal(0, carrier.roll))
    across = 0.5 / np.tan(np.radians(rng.uniform(*carrier.view)) / 2)
    return Viewpoint(eye, rotation, float(across * aspect / np.hypot(aspect, 1)))


def _drawn(rng: Generator, carriers: tuple[tuple[float, Carrier], ...]) -> Carrier:
    shares = np.array([share for share, _ in carriers])
    return carriers[int(rng.choice(len(shares), p=shares / shares.sum()))][1]


def _floor(rng: Generator, scene: Scene, aim: Aim) -> Array:
    """Return the point of the floor above which a camera is held."""
    if len(scene.places):
        return np.asarray(scene.places[rng.integers(len(scene.places))])
    spot = rng.uniform(*scene.eyes)
    if aim is Aim.EDGE:
        axis = int(rng.choice((0, 2)))
        spot[axis] = scene.eyes[int(rng.integers(2))][axis]
    return np.asarray(spot * (1, 0, 1))


def _near(rng: Generator, scene: Scene, carrier: Carrier) -> tuple[Array, Array]:
    """Return an eye 0.35 to 1.5 m from a point of a thing, mostly from above, and the way there."""
    low, high = scene.subjects[int(rng.integers(len(scene.subjects)))]
    point = rng.uniform(low, high)
    point[1] = high[1] if rng.random() < 0.6 else point[1]
    away, up = rng.uniform(0, 2 * np.pi), rng.uniform(0.05, 0.9)
    distance = np.exp(rng.uniform(np.log(0.35), np.log(1.5)))
    path = np.array([np.cos(away) * np.cos(up), np.sin(up), np.sin(away) * np.cos(up)])
    wanted = point + distance * path
    eye = np.clip(wanted, *scene.eyes)
    eye[1] = np.clip(wanted[1], *np.minimum(carrier.height, scene.ceiling))
    return eye, point + rng.normal(0, 0.08, 3) - eye


def _sight(rng: Generator, scene: Scene, aim: Aim, eye: Array, height: float) -> Array:
    """Return the way from a camera to what it is turned to."""
    if aim is Aim.SUBJECT and scene.subject is not None:
        return np.asarray(scene.subject - eye)
    if aim is Aim.ROAD:
        return np.array([0.0, 0.0, rng.choice([-1.0, 1.0])])
    if aim in (Aim.THING, Aim.NEAR):
        thing = scene.parts[int(rng.integers(len(scene.parts)))].mesh.corners
        return np.asarray(thing.mean((0, 1)) - eye + rng.normal(0, 0.25, 3))
    if aim in (Aim.ACROSS, Aim.EDGE):
        here = eye - np.array([0, height, 0])
        return np.asarray(_other_place(rng, scene, here) - here)
    yaw = rng.uniform(0, 2 * np.pi)
    return np.array([np.sin(yaw), 0.0, np.cos(yaw)])


def _other_place(rng: Generator, scene: Scene, here: Array) -> Array:
    """Return a point of the floor to look at: around the middle, or at most a storey away."""
    if not len(scene.places):
        middle = (scene.eyes[0] + scene.eyes[1]) / 2
        return np.asarray((middle + rng.normal(0, 0.7, 3)) * (1, 0, 1))
    way = np.abs(scene.places - here)
    others = scene.places[(way[:, 1] < _STOREY) & (way.max(1) > 0.8)]
    return np.asarray(others[rng.integers(len(others))])
