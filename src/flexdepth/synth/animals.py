"""Animals that walk on four legs, and birds that fly."""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from numpy.random import Generator

from flexdepth.synth.courses import Course, Gait, bent
from flexdepth.synth.materials import Material, material
from flexdepth.synth.shapes import Array, Mesh, joined, surface, tilt, turn
from flexdepth.synth.skins import limb, skin

_PHASES = ((1, 0.0, 0.0), (1, 1.0, 0.25), (-1, 0.0, 0.5), (-1, 1.0, 0.75))
"""Side, end (0 behind, 1 in front) and phase of each leg, in a walk's order of steps."""


@dataclass(frozen=True)
class Build:
    """The proportions of a kind of animal, in heights of its shoulder.

    Attributes:
        shoulder: Least and most height, metres.
        length: From hip to shoulder.
        girth: Half the height of the chest.
        neck: Length of the neck.
        carriage: Radians by which the neck rises.
        head: Length of the head.
        tail: Length of the tail.
        ears: Height of the ears.
    """

    shoulder: tuple[float, float]
    length: float
    girth: float
    neck: float
    carriage: float
    head: float
    tail: float
    ears: float


DOG = Build((0.28, 0.7), 1.0, 0.22, 0.36, 0.8, 0.4, 0.5, 0.13)
CAT = Build((0.22, 0.3), 1.15, 0.2, 0.22, 0.6, 0.34, 0.9, 0.12)
HORSE = Build((1.15, 1.6), 1.0, 0.2, 0.46, 0.85, 0.38, 0.42, 0.1)
COW = Build((1.1, 1.4), 1.2, 0.28, 0.4, 0.25, 0.36, 0.55, 0.1)


@dataclass(frozen=True, eq=False)
class Beast:
    """An animal on four legs, on a course.

    Attributes:
        build: Its proportions.
        height: Of its shoulder, metres.
        coat: Of the body.
        hoof: Of paws, muzzle and tail's end.
        course: Where the body goes.
        gait: How the feet follow.
    """

    build: Build
    height: float
    coat: Material
    hoof: Material
    course: Course
    gait: Gait

    @classmethod
    def drawn(cls, rng: Generator, build: Build, course: Course) -> "Beast":
        """Return a random animal of the build that walks the course."""
        height = float(rng.uniform(*build.shoulder))
        step = height * (0.45 + 0.25 * course.speed)
        period = min(2 * step / max(course.speed, 0.1), 2.0)
        coat = material(rng, str(rng.choice(["bark", "fabric", "bark"])))
        gait = Gait(period, 0.62, 0.12 * height)
        return cls(build, height, coat, material(rng, "tyre"), course, gait)

    @property
    def looks(self) -> tuple[Material, ...]:
        """The materials of the meshes: coat and hooves."""
        return self.coat, self.hoof

    def meshes(self, time: float) -> list[Mesh]:
        """Return coat and hooves at a time."""
        phase = 2 * pi * time / self.gait.period
        bend = turn(0.1 * sin(phase))
        bob = 0.015 * sin(2 * phase)
        coat, hoof = self._trunk(bend, bob), []
        for side, end, offset in _PHASES:
            leg, paw = self._leg(time, side, end, offset)
            coat.append(leg)
            hoof.append(paw)
        coat += self._head(bend, bob, phase)
        hoof.append(self._tail(phase))
        axes, place = self.course.axes(time), self.course.place(time)
        groups = (joined(coat), joined(hoof))
        return [mesh.scaled(self.height).turned(axes).placed(place) for mesh in groups]

    def _trunk(self, bend: Array, bob: float) -> list[Mesh]:
        """Return the body; it bends to the side of the legs that are ahead."""
        half, girth = self.build.length / 2, self.build.girth
        rings = np.array(
            [(-1.12, 0.35, 0.93), (-1.05, 0.7, 0.9), (-0.8, 0.92, 0.86), (-0.3, 0.88, 0.83),
             (0.3, 1.0, 0.8), (0.75, 1.05, 0.81), (1.02, 0.8, 0.84), (1.15, 0.4, 0.87)]
        )  # fmt: skip
        along, thick, high = rings.T
        line = np.stack([0 * along, high - 0.3 * girth + bob, along * half], 1)
        line[along > 0] = line[along > 0] @ bend.T
        radii = girth * thick[:, None] * (0.72, 1.0)
        return [skin(line, np.array([1.0, 0, 0]), radii, 14)]

    def _leg(self, time: float, side: int, end: float, offset: float) -> tuple[Mesh, Mesh]:
        """Return a leg and its paw. Hind knees point ahead, front elbows behind."""
        ahead = (end - 0.5) * self.build.length
        aside = 0.55 * self.build.girth * side
        own, raised = self.gait.step(time, offset)
        spot = self.course.beside(own, aside * self.height, ahead * self.height)
        paw = self.course.axes(time).T @ (spot - self.course.place(time)) / self.height
        paw = paw + np.array([0, raised / self.height, 0])
        root = np.array([aside, 0.74, ahead])
        heel = paw + np.array([0, 0.24, -0.07] if end == 0 else [0, 0.2, -0.01])
        knee = bent(root, heel, (0.3, 0.27), np.array([0, 0, 1.0 if end == 0 else -1.0]))
        toe = paw + np.array([0, 0.02, 0])
        girth = self.build.girth
        thick = girth * np.array([0.55, 0.52, 0.4, 0.28, 0.24, 0.2, 0.19])
        across = np.array([1.0, 0, 0])
        planted = turn(self.course.turning * (own - time))
        foot = np.array([[0, 0.025, -0.04], [0, 0.035, 0.0], [0, 0.025, 0.05]]) @ planted.T
        sole = skin(
            paw + foot, planted[:, 0], girth * np.array([(0.12, 0.1), (0.22, 0.14), (0.16, 0.1)]), 8
        )
        flat = Mesh(np.maximum(sole.corners, (-9.0, paw[1], -9.0)), sole.uv)
        return limb([root, knee, heel, toe], across, thick, 3), flat

    def _head(self, bend: Array, bob: float, phase: float) -> list[Mesh]:
        """Return neck, head and ears."""
        build, across = self.build, np.array([1.0, 0, 0])
        rise = build.carriage + 0.06 * sin(2 * phase)
        root = np.array([0, 0.86 + bob, 0.95 * build.length / 2]) @ bend.T
        poll = root + build.neck * np.array([0, sin(rise), cos(rise)])
        thick = build.girth * np.array([0.75, 0.6, 0.5, 0.45])
        down = np.array([0, -sin(0.45), cos(0.45)])
        share = np.array([-0.15, 0.0, 0.2, 0.4, 0.6, 0.85, 1.0])[:, None]
        skull = poll + share * build.head * down
        radii = build.head * np.array(
            [(0.12, 0.14), (0.24, 0.26), (0.27, 0.27), (0.22, 0.23), (0.15, 0.16), (0.13, 0.14),
             (0.07, 0.08)]
        )  # fmt: skip
        ears = []
        for side in (-1, 1):
            base = poll + build.head * np.array([0.17 * side, 0.15, 0])
            tip = base + np.array([0.1 * side * build.head, build.ears, 0])
            ears.append(limb([base, tip], across, 0.1 * build.head * np.array([1, 0.9, 0.3]), 3))
        return [limb([root, poll], across, thick, 4), skin(skull, across, radii, 12), *ears]

    def _tail(self, phase: float) -> Mesh:
        share = np.linspace(0, 1, 7)
        wag = 0.35 * np.sin(2 * phase - 2 * share) * share
        root = np.array([0, 0.9, -0.55 * self.build.length])
        droop = np.stack([wag, -0.75 * share, -0.65 * np.sqrt(share)], 1)
        thick = self.build.girth * (0.22 - 0.12 * share)
        return skin(root + self.build.tail * droop, (1.0, 0, 0), np.stack([thick, thick], 1), 8)


@dataclass(frozen=True, eq=False)
class Bird:
    """A bird that flies above a course.

    Attributes:
        height: Above the ground, metres.
        span: From wing tip to wing tip, metres.
        feathers: Of the wings.
        plumage: Of the body.
        course: Where it goes.
        beat: Beats a second.
    """

    height: float
    span: float
    feathers: Material
    plumage: Material
    course: Course
    beat: float

    @classmethod
    def drawn(cls, rng: Generator, course: Course) -> "Bird":
        """Return a random bird on the course."""
        looks = material(rng, "thing"), material(rng, "fabric")
        height, span, beat = rng.uniform((0.7, 0.5, 1.0), (1.9, 1.6, 3.0))
        return cls(float(height), float(span), *looks, course, float(beat))

    @property
    def looks(self) -> tuple[Material, ...]:
        """The materials of the meshes: wings and body."""
        return self.feathers, self.plumage

    def meshes(self, time: float) -> list[Mesh]:
        """Return wings and body at a time."""
        phase = 2 * pi * self.beat * time
        wings = joined([_wing(side, phase) for side in (-1, 1)])
        along = np.linspace(-0.34, 0.3, 9)
        thick = 0.1 * np.array([0.25, 0.3, 0.45, 0.8, 1.0, 0.9, 0.55, 0.6, 0.2])
        line = np.stack([0 * along, 0.03 * np.sin(phase + 2 * along), along], 1)
        flat = np.where(along < -0.15, 0.25, 0.85)
        body = skin(line, (1.0, 0, 0), np.stack([thick, flat * thick], 1), 12)
        place = self.course.place(time) + np.array([0, self.height, 0])
        axes = self.course.axes(time)
        return [mesh.scaled(self.span).turned(axes).placed(place) for mesh in (wings, body)]


def _wing(side: int, phase: float) -> Mesh:
    """Return a wing that beats: the tip follows the root, and the trailing edge the leading one."""
    out = np.linspace(0.0, 0.5, 9)[None]
    back = np.linspace(0, 1, 4)[:, None]
    lag = 3.0 * out + 0.5 * back
    angle = 0.75 * np.sin(phase - lag) + 0.1
    lead = 0.12 - 0.35 * np.maximum(out - 0.25, 0)
    chord = 0.26 * np.sqrt(np.maximum(1 - (2 * out) ** 3, 0.02))
    grid = np.stack(
        [side * (0.04 + out * np.cos(angle)), out * np.sin(angle) + 0 * back, lead - back * chord],
        -1,
    )
    return surface(grid).turned(tilt(-0.1))
