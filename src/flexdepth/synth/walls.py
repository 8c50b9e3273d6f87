"""Floor, ceiling and walls, with doors, windows, views from them, and pictures."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Material, Part, fitted, glowing, material, shown
from flexdepth.synth.parts import Parts, bounds, placed
from flexdepth.synth.scene import Beam
from flexdepth.synth.shapes import Array, Mesh, box, curtain, joined, quad, tube, turn

_VIEWS = ("landscape", "landscape", "facade", "petals", "photograph")


def shell(
    rng: Generator, surfaces: tuple[str, str, str], width: float, length: float, height: float
) -> Parts:
    """Return floor, ceiling and at times rugs."""
    corner = np.array([-width / 2, 0, -length / 2])
    floor = quad(corner, (width, 0, 0), (0, 0, length))
    ceiling = quad((-width / 2, height, -length / 2), (width, 0, 0), (0, 0, length))
    parts = [Part(floor, material(rng, surfaces[2])), Part(ceiling, material(rng, surfaces[1]))]
    for k in range(int(rng.poisson(0.6))):
        wide, long = rng.uniform(0.25, 0.7, 2) * (width, length)
        rug = box((0, 0.005 + 0.004 * k, 0), (wide, 0.01, long))
        at = (*(rng.uniform(-0.2, 0.2, 1) * width), 0.0, rng.uniform(-0.2, 0.2) * length)
        look = fitted(rng, "rug", wide, long) if rng.random() < 0.5 else material(rng, "rug")
        parts += placed([Part(rug, look)], at, float(rng.normal(0, 0.15)))
    return parts


@dataclass(frozen=True, eq=False)
class Walls:
    """What the walls of a room have in common.

    Attributes:
        surface: Material kind of what differs.
        shared: The material of most walls.
        trim: Of skirting and frames.
        pictures: How many doors, windows and pictures a wall has, on average.
        sun: Sunlight that comes through the windows: unit vector to the sun and power, or None.
        bright: How much brighter than a white wall the windows are.
    """

    surface: str
    shared: Material
    trim: Material
    pictures: float
    sun: tuple[Array, Array] | None
    bright: float

    @classmethod
    def drawn(cls, rng: Generator, surface: str, pictures: float, daylight: bool) -> "Walls":
        """Return the walls of a random room."""
        around, up = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 1.0)
        towards = np.array([np.cos(around) * np.cos(up), np.sin(up), np.sin(around) * np.cos(up)])
        power = rng.uniform(1, 5) * np.array([1, rng.uniform(0.8, 1), rng.uniform(0.6, 0.95)])
        return cls(
            surface,
            material(rng, surface),
            material(rng, str(rng.choice(["wood", "paint"]))),
            pictures,
            (towards, power) if daylight and rng.random() < 0.7 else None,
            float(rng.uniform(0.6, 4) if daylight else rng.uniform(0.01, 0.1)),
        )

    def built(
        self,
        rng: Generator,
        size: tuple[float, float],
        place: tuple[Array, float],
        gap: "Gap | None" = None,
    ) -> tuple[Parts, list[Beam]]:
        """Return a wall of a width and height at a place and yaw, and the sun through it."""
        across, height = size
        at, yaw = place
        look = self.shared if rng.random() < 0.75 else material(rng, self.surface)
        if gap is None:
            wall = quad((-across / 2, 0, 0), (across, 0, 0), (0, height, 0))
            parts = [Part(wall, look), Part(_skirting(-across / 2, across / 2), self.trim)]
        else:
            parts = gap.wall(rng, look, self.trim, size)
        beams: list[Beam] = []
        taken = [] if gap is None else [(gap.left - 0.1, gap.right + 0.1)]
        for _ in range(int(rng.poisson(self.pictures))):
            opening = _Opening.drawn(rng, across, height)
            if opening is None or any(a < opening.right and opening.left < b for a, b in taken):
                continue
            taken.append((opening.left, opening.right))
            parts += opening.parts(rng, self.trim, self.bright)
            if opening.kind == "window" and self.sun is not None:
                beams += opening.beam(rng, self.sun, place)
        return placed(parts, tuple(at), yaw), beams


@dataclass(frozen=True)
class Gap:
    """A way through a wall at z = 0: an open door, or a wide opening that may be glazed, metres."""

    left: float
    right: float
    top: float

    @classmethod
    def drawn(cls, rng: Generator, across: float, height: float) -> "Gap":
        """Return one that fits."""
        wide = rng.uniform(0.75, 1.0) if rng.random() < 0.45 else rng.uniform(1.0, 4.0)
        wide = min(wide, across - 0.3)
        left = rng.uniform(-across / 2 + 0.1, across / 2 - wide - 0.1)
        top = height - 0.02 if rng.random() < 0.3 else min(2.1, height - 0.05)
        return cls(float(left), float(left + wide), float(top))

    def misses(self, thing: Parts) -> bool:
        """Return whether something that stands before the wall leaves the way free."""
        low, high = bounds(thing)
        return bool(high[0] < self.left or low[0] > self.right)

    def wall(
        self, rng: Generator, look: Material, trim: Material, size: tuple[float, float]
    ) -> Parts:
        """Return the wall around it, thick as walls are, at times with an open door or glazed."""
        across, height = size
        half, thick = across / 2, 0.12
        spans = [
            (-half, self.left, 0.0),
            (self.right, half, 0.0),
            (self.left, self.right, self.top),
        ]
        blocks = [
            box(((a + b) / 2, (base + height) / 2, thick / 2), (b - a, height - base, thick))
            for a, b, base in spans
        ]
        boards = [_skirting(-half, self.left), _skirting(self.right, half)]
        # Where two floors meet a ray could slip through.
        boards.append(
            box(((self.left + self.right) / 2, 0, thick / 2), (self.right - self.left, 0.012, 0.16))
        )
        parts = [Part(joined(blocks), look), Part(joined(boards), trim)]
        wide = self.right - self.left
        if wide < 1.05 and rng.random() < 0.5:
            hinge = (self.left, 0.0, thick / 2 if rng.random() < 0.5 else 0.0)
            turned = float(rng.uniform(0.6, 2.4)) * (1 if hinge[2] == 0 else -1)
            parts += placed(_leaf(rng, wide, self.top), hinge, turned)
        elif rng.random() < 0.45:
            panes = max(1, round(wide / rng.uniform(0.7, 1.4)))
            glazing = _glazing(rng, (wide, self.top), panes, float(rng.choice([0.02, 0.05, 0.09])))
            parts += placed(glazing, (self.left, 0.0, thick / 2))
        return parts


def _leaf(rng: Generator, wide: float, tall: float) -> Parts:
    """Return a door from x = 0 on: of one piece, or a frame with a pane or two."""
    handle = tube((wide - 0.07, 1.0, -0.06), (wide - 0.2, 1.0, -0.06), (0.011, 0.011), 6)
    knob = Part(joined([handle, handle.scaled((1, 1, -1))]), material(rng, "metal"))
    if rng.random() < 0.5:
        board = box((wide / 2, tall / 2, 0), (wide, tall, 0.04))
        return [Part(board, fitted(rng, "cabinet", wide, tall)), knob]
    return [*_glazing(rng, (wide, tall), 1, float(rng.uniform(0.06, 0.14))), knob]


def _glazing(rng: Generator, size: tuple[float, float], panes: int, bar: float) -> Parts:
    """Return panes side by side in a frame, from x = 0 on; its foot is at times a solid board."""
    wide, tall = size
    foot = bar if rng.random() < 0.6 else float(rng.uniform(0.3, 0.45)) * tall
    x = np.linspace(bar / 2, wide - bar / 2, panes + 1)
    frame = [box((at, tall / 2, 0), (bar, tall, 0.04)) for at in x]
    frame += [
        box((wide / 2, foot / 2, 0), (wide, foot, 0.036)),
        box((wide / 2, tall - bar / 2, 0), (wide, bar, 0.04)),
    ]
    if rng.random() < 0.3:
        frame.append(box((wide / 2, (foot + tall) / 2, 0), (wide, bar, 0.03)))
    pane = quad((0.01, foot, 0), (wide - 0.02, 0, 0), (0, tall - foot - 0.01, 0))
    look = material(rng, str(rng.choice(["wood", "paint", "metal"])))
    return [Part(joined(frame), look), Part(pane, material(rng, "pane"))]


def _skirting(left: float, right: float) -> Mesh:
    return box(((left + right) / 2, 0.04, -0.01), (right - left, 0.08, 0.015))


@dataclass(frozen=True)
class _Opening:
    """A rectangle on a wall at z = 0: a door, a window or a picture, in metres."""

    kind: str
    left: float
    base: float
    wide: float
    tall: float

    @property
    def right(self) -> float:
        return self.left + self.wide

    @classmethod
    def drawn(cls, rng: Generator, across: float, height: float) -> "_Opening | None":
        """Return one that fits, or None."""
        kind = str(rng.choice(["door", "window", "picture"], p=[0.2, 0.25, 0.55]))
        span = {
            "door": ((0.75, 1.95, 0.0), (1.0, 2.1, 0.0)),
            "window": ((0.6, 0.8, 0.3), (2.4, 1.6, 1.0)),
            "picture": ((0.2, 0.2, 0.9), (1.4, 1.1, 1.5)),
        }[kind]
        wide, tall, base = rng.uniform(*span)
        tall = min(tall, height - base - 0.05)
        if wide > across - 0.3 or tall < 0.15:
            return None
        left = rng.uniform(-across / 2 + 0.1, across / 2 - wide - 0.1)
        return cls(kind, float(left), float(base), float(wide), float(tall))

    def parts(self, rng: Generator, trim: Material, bright: float) -> Parts:
        """Return its pane and frame, and what hangs before a window."""
        deep = -0.02 if self.kind == "door" else -0.004 - 0.02 * rng.random()
        pane = quad((self.left, self.base, deep), (self.wide, 0, 0), (0, self.tall, 0))
        size = (self.wide, self.tall)
        if self.kind == "door":
            return [Part(pane, fitted(rng, "cabinet", *size)), Part(self._frame(0.06), trim)]
        if self.kind == "picture":
            bare = rng.random() < 0.4
            hung = Part(pane, fitted(rng, "picture" if rng.random() < 0.7 else "poster", *size))
            return [hung] if bare else [hung, Part(self._frame(rng.uniform(0.01, 0.06)), trim)]
        if rng.random() < 0.75:
            view = shown(str(rng.choice(_VIEWS)), size, bright * 1.5)
        else:
            view = glowing(rng, str(rng.choice(["plain", "mottled", "windows"])), bright)
        parts = [Part(pane, view), Part(self._frame(0.06), trim), Part(self._bars(rng), trim)]
        if rng.random() < 0.4:
            cloth = material(rng, "fabric")
            for side in (self.left - 0.25, self.right - 0.3):
                hanging = curtain(rng, rng.uniform(0.3, 0.6), self.tall + 0.3, 0.04)
                parts.append(Part(hanging.placed((side, self.base - 0.2, -0.1)), cloth))
        elif rng.random() < 0.25:
            levels = np.arange(self.base, self.base + self.tall, 0.045)
            slats = [
                box((self.left + self.wide / 2, y, -0.06), (self.wide, 0.004, 0.03)) for y in levels
            ]
            parts.append(Part(joined(slats), material(rng, "paint")))
        return parts

    def _frame(self, bar: float) -> Mesh:
        x, base, wide, tall = self.left, self.base, self.wide, self.tall
        upright = [
            box((x + s * wide, base + tall / 2, -0.02), (bar, tall + bar, 0.05)) for s in (0, 1)
        ]
        lying = [box((x + wide / 2, base + s * tall, -0.02), (wide, bar, 0.05)) for s in (0, 1)]
        return joined(upright + lying)

    def _bars(self, rng: Generator) -> Mesh:
        middle = self.base + self.tall / 2
        count = int(rng.integers(1, 4))
        places = self.left + self.wide * np.arange(1, count + 1) / (count + 1)
        return joined([box((x, middle, -0.03), (0.035, self.tall, 0.03)) for x in places])

    def beam(
        self, rng: Generator, sun: tuple[Array, Array], place: tuple[Array, float]
    ) -> list[Beam]:
        """Return the sunlight that comes through, none where the sun is behind the wall."""
        at, yaw = place
        towards, power = sun
        rotation = turn(yaw)
        if towards @ (rotation @ (0, 0, 1)) < 0.15:
            return []
        corner = rotation @ (self.left, self.base, -0.15) + at
        along, up = rotation @ (self.wide, 0, 0), np.array([0, self.tall, 0.0])
        return [Beam(corner, along, up, int(rng.integers(1, 5)), towards, power)]
