"""Rigid things that move: cars on a road, things that are pushed or thrown, balls."""

from dataclasses import dataclass, replace
from math import pi, sqrt

import cv2
import numpy as np
from numpy.random import Generator

from flexdepth.synth.courses import Course
from flexdepth.synth.fixtures import ball, toy_house
from flexdepth.synth.materials import Material, Part, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.seating import chair
from flexdepth.synth.shapes import Array, Mesh, blob, box, turn
from flexdepth.synth.storage import cabinet, stack
from flexdepth.synth.vehicles import vehicle

_GRAVITY = 9.81


@dataclass(frozen=True, eq=False)
class Solid:
    """A rigid thing.

    Attributes:
        parts: It at rest around its own origin, about which it turns.
        course: Where the origin goes over the ground.
        height: Of the origin above the course, metres.
        spin: Rotation a second, as axis times radians, in the world's axes.
        bounce: Height of its bounces, metres, and seconds since the last; height 0 is none.
    """

    parts: Parts
    course: Course
    height: float
    spin: Array
    bounce: tuple[float, float] = (0.0, 0.0)

    @property
    def looks(self) -> tuple[Material, ...]:
        """The materials of the meshes."""
        return tuple(part.material for part in self.parts)

    def meshes(self, time: float) -> list[Mesh]:
        """Return the parts at a time."""
        turned = np.asarray(cv2.Rodrigues(time * self.spin)[0]) @ turn(self.course.heading)
        raised = np.array([0, self.height + _bounced(*self.bounce, time), 0])
        place = self.course.place(time) + raised
        return [part.mesh.turned(turned).placed(place) for part in self.parts]


def _bounced(peak: float, since: float, time: float) -> float:
    """Return the height of something that bounces for ever."""
    if peak == 0:
        return 0.0
    leap = sqrt(2 * _GRAVITY * peak)
    passed = (since + time) % (2 * leap / _GRAVITY)
    return leap * passed - _GRAVITY * passed**2 / 2


def car(rng: Generator, course: Course) -> Solid:
    """Return a vehicle that drives its course with its lamps on; its wheels do not turn."""
    driven = vehicle(rng, lit=True)
    facing = [Part(part.mesh.placed((0, 0, 0), pi), part.material) for part in driven]
    return Solid(facing, course, 0.0, np.array([0, course.turning, 0]))


def unlit(solid: Solid) -> Solid:
    """Return the same with its lamps off: glossy, and half as light as the colour they had."""
    off = [
        replace(look, glow=0.0, colours=look.colours / 2, gloss=0.05) if look.glow > 0 else look
        for look in solid.looks
    ]
    parts = [Part(part.mesh, look) for part, look in zip(solid.parts, off, strict=True)]
    return replace(solid, parts=parts)


def pushed(rng: Generator, course: Course) -> Solid:
    """Return furniture or a parcel that slides over the floor, and turns as it does."""
    make = (chair, cabinet, stack, toy_house, _parcel, _parcel)[int(rng.integers(6))]
    return Solid(make(rng), course, 0.0, np.array([0, rng.normal(0, 0.6), 0]))


def rolling(rng: Generator, course: Course) -> Solid:
    """Return a ball that rolls straight on without sliding."""
    radius = float(rng.uniform(0.1, 0.45))
    axis = turn(course.heading)[:, 0]
    straight = replace(course, turning=0.0)
    return Solid(_round(rng, radius), straight, radius, axis * course.speed / radius)


def bouncing(rng: Generator, course: Course) -> Solid:
    """Return a ball that bounces and is in the air at time 0."""
    radius = float(rng.uniform(0.1, 0.35))
    peak = float(rng.uniform(0.4, 1.0))
    since = float(rng.uniform(0.25, 0.6)) * 2 * sqrt(2 * peak / _GRAVITY)
    return Solid(_round(rng, radius), course, radius, rng.normal(0, 2.0, 3), (peak, since))


def hovering(rng: Generator, course: Course) -> Solid:
    """Return a balloon, a toy or a parcel that hovers and turns slowly."""
    make = (ball, toy_house, _parcel)[int(rng.integers(3))]
    things = _centred(make(rng))
    lowest = min(part.mesh.corners[..., 1].min() for part in things)
    height = rng.uniform(0.2, 1.0) - 1.3 * lowest
    return Solid(things, course, float(height), rng.normal(0, 0.4, 3))


def _round(rng: Generator, radius: float) -> Parts:
    looks = material(rng, str(rng.choice(["thing", "fabric", "poster"])))
    return [Part(blob(rng, (2 * radius,) * 3, 0.0, 18), looks)]


def _parcel(rng: Generator) -> Parts:
    size = rng.uniform((0.25, 0.2, 0.25), (0.8, 0.9, 0.8))
    body = box((0, size[1] / 2, 0), size)
    return [Part(body, material(rng, str(rng.choice(["thing", "poster", "wood"]))))]


def _centred(parts: Parts) -> Parts:
    """Return the parts moved so that they turn about the middle of their box."""
    corners = np.concatenate([part.mesh.corners.reshape(-1, 3) for part in parts])
    middle = (corners.min(0) + corners.max(0)) / 2
    return [Part(part.mesh.placed(-middle), part.material) for part in parts]
