"""The kinds of things that move, and where each is at home."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

import numpy as np
from numpy.random import Generator

from flexdepth.synth.animals import CAT, COW, DOG, HORSE, Beast, Bird
from flexdepth.synth.courses import Course
from flexdepth.synth.fixtures import plant
from flexdepth.synth.materials import Material, Part
from flexdepth.synth.people import Person
from flexdepth.synth.shapes import Mesh
from flexdepth.synth.solids import bouncing, car, hovering, pushed, rolling
from flexdepth.synth.swaying import Swaying, flag, flying_sheet, washing_line
from flexdepth.synth.trees import shrub, tree


class Body(Protocol):
    """Something whose shape is known at any time."""

    @property
    def looks(self) -> tuple[Material, ...]:
        """The material of each mesh."""
        ...

    def meshes(self, time: float) -> list[Mesh]:
        """Return the meshes after `time` seconds, the same triangles at every time."""
        ...


class Ground(Enum):
    """What a mover moves on."""

    FLOOR = "floor"
    OPEN = "open"
    ROAD = "road"


@dataclass(frozen=True)
class Kind:
    """A kind of mover.

    Attributes:
        name: What it is.
        flexible: Whether its shape changes; else one rotation and translation moves all of it.
        stands: Whether it touches the ground; else it is in the air at time 0.
        grounds: Where it is found.
        speed: Least and most, metres a second.
        often: How often it is drawn, against others that are as suitable.
        area: What it typically covers, seen from the side, square metres.
        make: One of its kind on a course.
    """

    name: str
    flexible: bool
    stands: bool
    grounds: tuple[Ground, ...]
    speed: tuple[float, float]
    often: int
    area: float
    make: Callable[[Generator, Course], Body]


@dataclass(frozen=True, eq=False)
class Mover:
    """A thing that moves in a scene."""

    kind: Kind
    body: Body


_IN, _OUT, _ROAD = (Ground.FLOOR,), (Ground.OPEN,), (Ground.ROAD,)
_ANYWHERE = (Ground.FLOOR, Ground.OPEN)


def _walks(rng: Generator, course: Course) -> Body:
    return Person.drawn(rng, course, 0.0)


def _hops(rng: Generator, course: Course) -> Body:
    return Person.drawn(rng, course, float(rng.uniform(0.25, 0.5)))


def _pet(rng: Generator, course: Course) -> Body:
    return Beast.drawn(rng, DOG if rng.random() < 0.7 else CAT, course)


def _cattle(rng: Generator, course: Course) -> Body:
    return Beast.drawn(rng, HORSE if rng.random() < 0.5 else COW, course)


def _potted(rng: Generator, course: Course) -> Body:
    return Swaying.drawn(rng, course, plant(rng))


def _planted(rng: Generator, course: Course) -> Body:
    grown = (shrub if rng.random() < 0.6 else tree)(rng)
    # Level ground shows no roots, and a mover must not run into the ground.
    flat = [np.maximum(part.mesh.corners, (-np.inf, 0, -np.inf)) for part in grown]
    above = [Part(Mesh(c, p.mesh.uv), p.material) for c, p in zip(flat, grown, strict=True)]
    return Swaying.drawn(rng, course, above)


KINDS: tuple[Kind, ...] = (
    Kind("person walking", True, True, (*_ANYWHERE, Ground.ROAD), (0.5, 1.7), 3, 0.5, _walks),
    Kind("person standing", True, True, _ANYWHERE, (0.0, 0.0), 1, 0.5, _walks),
    Kind("cat or dog", True, True, _ANYWHERE, (0.4, 1.4), 2, 0.2, _pet),
    Kind("horse or cow", True, True, _OUT, (0.5, 1.5), 1, 1.6, _cattle),
    Kind("potted plant", True, True, _IN, (0.0, 0.0), 1, 0.4, _potted),
    Kind("tree or bush", True, True, _OUT, (0.0, 0.0), 1, 6.0, _planted),
    Kind("cloth on a line", True, True, _ANYWHERE, (0.0, 0.0), 1, 1.4, washing_line),
    Kind("person hopping", True, False, _ANYWHERE, (0.0, 0.0), 1, 0.5, _hops),
    Kind("bird", True, False, _ANYWHERE, (0.5, 2.5), 1, 0.3, Bird.drawn),
    Kind("sheet in the wind", True, False, _ANYWHERE, (0.2, 1.5), 1, 0.6, flying_sheet),
    Kind("flag", True, False, _OUT, (0.0, 0.0), 1, 0.8, flag),
    Kind("car", False, True, _ROAD, (2.0, 14.0), 4, 4.0, car),
    Kind("rolling ball", False, True, _ANYWHERE, (0.4, 2.0), 1, 0.25, rolling),
    Kind("pushed thing", False, True, _ANYWHERE, (0.3, 1.3), 1, 0.4, pushed),
    Kind("bouncing ball", False, False, _ANYWHERE, (0.3, 2.0), 1, 0.15, bouncing),
    Kind("hovering thing", False, False, _ANYWHERE, (0.2, 1.5), 1, 0.15, hovering),
)
"""Every kind of mover."""


def kinds(flexible: bool, stands: bool, grounds: tuple[Ground, ...]) -> list[tuple[Kind, Ground]]:
    """Return the kinds that are asked for, each as often as it is to be drawn.

    Each comes with a ground of its own among `grounds`.
    """
    return [
        (kind, ground)
        for kind in KINDS
        for ground in kind.grounds * kind.often
        if (kind.flexible, kind.stands) == (flexible, stands) and ground in grounds
    ]
