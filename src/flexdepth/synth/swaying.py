"""What wind moves: cloth on a line, flags, sheets that fly, and plants."""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.random import Generator

from flexdepth.synth.courses import Course
from flexdepth.synth.materials import Material, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import Array, Mesh, joined, surface, tube, turn

_ROWS, _COLUMNS = 17, 21


@dataclass(frozen=True, eq=False)
class Waves:
    """Waves that run over a cloth, each a sine of place and time.

    Attributes:
        number: Waves by two, radians a metre along and down the cloth.
        rate: Of each, radians a second.
        phase: Of each, radians.
        height: Of each, metres.
    """

    number: Array
    rate: Array
    phase: Array
    height: Array

    @classmethod
    def drawn(cls, rng: Generator, height: float, speed: float) -> "Waves":
        """Return three waves of a height in metres that run at about a speed in metres a second."""
        length = rng.uniform(0.35, 1.8, 3)
        number = 2 * pi / length[:, None] * rng.normal((0.8, 0.4), 0.35, (3, 2))
        rate = np.linalg.norm(number, axis=1) * speed * rng.uniform(0.6, 1.4, 3)
        return cls(
            number, rate, rng.uniform(0, 2 * pi, 3), height * length * rng.dirichlet((2,) * 3)
        )

    def at(self, along: Array, down: Array, time: float) -> Array:
        """Return the height of the waves at points of the cloth."""
        place = self.number[:, 0, None, None] * along + self.number[:, 1, None, None] * down
        angle = place - (self.rate * time + self.phase)[:, None, None]
        return np.asarray((self.height[:, None, None] * np.sin(angle)).sum(0))


@dataclass(frozen=True, eq=False)
class Cloth:
    """A cloth that is held along its upper or its left edge, or not at all.

    Attributes:
        at: A point on the ground below its middle, metres.
        yaw: How the cloth is turned about the vertical axis.
        size: Width and height, metres.
        below: Height of its lower edge above `at`, metres.
        held: How fast the waves grow from the upper and from the left edge; 0 is not held there.
        waves: What runs over it.
        drift: Metres a second by which the whole moves.
        fabric: Its material.
        post: The material of poles and line.
    """

    at: Array
    yaw: float
    size: tuple[float, float]
    below: float
    held: tuple[float, float]
    waves: Waves
    drift: Array
    fabric: Material
    post: Material

    @property
    def looks(self) -> tuple[Material, ...]:
        """The materials of the meshes: the cloth, and what holds it where something does."""
        return (self.fabric, self.post) if any(self.held) else (self.fabric,)

    def meshes(self, time: float) -> list[Mesh]:
        """Return the cloth, and what holds it, at a time."""
        width, height = self.size
        along = np.linspace(0, width, _COLUMNS)[None] + np.zeros((_ROWS, 1))
        down = np.linspace(0, height, _ROWS)[:, None] + np.zeros((1, _COLUMNS))
        free = np.ones_like(along)
        for rate, way in zip(self.held, (down / height, along / width), strict=True):
            free = free * (way**rate if rate else 1.0)
        wave = free * self.waves.at(along, down, time)
        slack = 0.25 * free * self.waves.at(along + 1.0, down, 0.7 * time)
        lower = self.below + height
        grid = np.stack([along - width / 2 + slack, lower - down - 0.5 * np.abs(slack), wave], -1)
        place = self.at + time * self.drift
        meshes = [surface(grid), *self._holding()]
        return [mesh.turned(turn(self.yaw)).placed(place) for mesh in meshes]

    def _holding(self) -> list[Mesh]:
        """Return two poles with a line for what hangs, one pole for a flag."""
        if not any(self.held):
            return []
        width, top = self.size[0] / 2 + 0.05, self.below + self.size[1]
        pole = tube((-width, 0, 0), (-width, top + 0.05, 0), (0.03, 0.02))
        if not self.held[0]:
            return [pole]
        line = tube((-width, top, 0), (width, top, 0), (0.008, 0.008), 5)
        return [joined([pole, pole.placed((2 * width, 0, 0)), line])]


def washing_line(rng: Generator, course: Course) -> Cloth:
    """Return a cloth that hangs between two poles."""
    size = rng.uniform((0.7, 0.8), (1.8, 1.6))
    waves = Waves.drawn(rng, rng.uniform(0.1, 0.4), rng.uniform(0.4, 1.2))
    return _cloth(rng, course, (size, rng.uniform(0.15, 0.5)), (rng.uniform(0.6, 1.2), 0.0), waves)


def flag(rng: Generator, course: Course) -> Cloth:
    """Return a flag on a pole."""
    width = rng.uniform(0.8, 1.8)
    size = np.array([width, width * rng.uniform(0.5, 0.8)])
    waves = Waves.drawn(rng, rng.uniform(0.2, 0.4), rng.uniform(0.8, 2.5))
    return _cloth(rng, course, (size, rng.uniform(0.6, 1.6)), (0.0, rng.uniform(0.6, 1.0)), waves)


def flying_sheet(rng: Generator, course: Course) -> Cloth:
    """Return a sheet that the wind carries."""
    waves = Waves.drawn(rng, rng.uniform(0.2, 0.5), rng.uniform(0.5, 2.0))
    return _cloth(rng, course, (rng.uniform(0.4, 1.3, 2), rng.uniform(0.2, 1.0)), (0, 0), waves)


def _cloth(
    rng: Generator,
    course: Course,
    hung: tuple[Array, float],
    held: tuple[float, float],
    waves: Waves,
) -> Cloth:
    size, below = hung
    drift = np.zeros(3) if any(held) else course.speed * course.axes(0)[:, 2]
    look = material(rng, str(rng.choice(["fabric", "poster"])))
    extent = float(size[0]), float(size[1])
    return Cloth(
        course.start, course.heading, extent, float(below), held, waves, drift, look,
        material(rng, "metal"),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Swaying:
    """Something rooted that sways in the wind, more the higher.

    Attributes:
        parts: It at rest, on y = 0 around the origin.
        at: Where it stands.
        reach: Metres by which a point one metre high sways.
        flutter: Metres by which leaves move on their own.
        rate: Radians a second.
        towards: Where the wind goes.
    """

    parts: Parts
    at: Array
    reach: float
    flutter: float
    rate: float
    towards: Array

    @classmethod
    def drawn(cls, rng: Generator, course: Course, parts: Parts) -> "Swaying":
        """Return the parts swaying in a random wind, where the course begins."""
        angle = rng.uniform(0, 2 * pi)
        return cls(
            parts,
            course.start,
            float(rng.uniform(0.04, 0.14)),
            float(rng.uniform(0.005, 0.025)),
            float(rng.uniform(2.5, 7.0)),
            np.array([np.cos(angle), 0, np.sin(angle)]),
        )

    @property
    def looks(self) -> tuple[Material, ...]:
        """The materials of the meshes."""
        return tuple(part.material for part in self.parts)

    def meshes(self, time: float) -> list[Mesh]:
        """Return the parts at a time."""
        return [
            Mesh(self._swayed(part.mesh.corners, time) + self.at, part.mesh.uv)
            for part in self.parts
        ]

    def _swayed(self, corners: Array, time: float) -> Array:
        high = np.maximum(corners[..., 1:2], 0)
        ahead = corners @ self.towards
        wind = np.sin(self.rate * time - 1.3 * ahead) + 0.5 * np.sin(1.7 * self.rate * time + 2)
        bend = self.reach * high**1.5 * (0.4 + wind[..., None])
        own = np.sin(3.1 * self.rate * time + 9 * corners[..., [2, 0, 1]])
        return np.asarray(corners + bend * self.towards + self.flutter * np.minimum(high, 1) * own)
