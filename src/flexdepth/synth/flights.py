"""Flights of stairs: treads, risers, what carries them, and where their nosings are."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Material, Part, material
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.shapes import Array, Mesh, box, joined, quad, surface, turn

WAIST = 0.16
"""Thickness of landings, and of flights below the inner corners of their steps, metres."""

_INTO = 3e-3
"""Metres by which parts reach into what they meet: a ray could slip through where edges touch."""


@dataclass(frozen=True, eq=False)
class Flight:
    """A straight flight that begins on one floor or landing and ends on another.

    Attributes:
        foot: Middle of the lower edge of the first riser, metres.
        yaw: The way up, from z towards x.
        width: Metres.
        risers: How many; the last one leads onto the landing, so there is one tread fewer.
        rise: Height of a riser, metres.
        going: Depth of a tread from nosing to nosing, metres.
    """

    foot: Array
    yaw: float
    width: float
    risers: int
    rise: float
    going: float

    @property
    def length(self) -> float:
        """How far it goes, metres."""
        return (self.risers - 1) * self.going

    @property
    def top(self) -> Array:
        """Middle of the upper edge of the last riser."""
        return self.point(0, self.length, self.risers * self.rise)

    def point(self, across: float, ahead: float, up: float) -> Array:
        """Return the place so far to the right of the foot as one goes up, ahead and above."""
        return np.asarray(turn(self.yaw) @ (-across, up, ahead) + self.foot)

    def tread(self, number: int) -> Array:
        """Return the middle of a tread; the lowest is 0."""
        return self.point(0, (number + 0.5) * self.going, (number + 1) * self.rise)

    def slope(self, across: float) -> Array:
        """Return two points: the first nosing and the last, so far to the right of the middle."""
        first = self.point(across, 0, self.rise)
        return np.stack([first, self.point(across, self.length, self.risers * self.rise)])


@dataclass(frozen=True, eq=False)
class Build:
    """What the flights of one staircase have in common.

    Attributes:
        tread: Material of what one steps on.
        riser: Of the risers; None leaves them open.
        string: Of what carries the treads.
        under: Of the underside.
        board: Thickness of a tread, metres.
        nose: How far a tread stands out over its riser, metres.
        runner: A carpet along the middle of the treads, or None.
        strip: Of a strip along each nosing, or None.
    """

    tread: Material
    riser: Material | None
    string: Material
    under: Material
    board: float
    nose: float
    runner: Material | None = None
    strip: Material | None = None


def bar(start: Array, end: Array, wide: float, tall: float) -> Mesh:
    """Return a bar between two points, its upright ends `tall` high and around them, `wide` thick.

    A bar that slopes is sheared, as a handrail is cut where it meets a post.
    """
    along = end - start
    side = np.array([along[2], 0.0, -along[0]])
    side *= wide / max(float(np.linalg.norm(side)), 1e-9)
    up = np.array([0.0, tall, 0.0])
    corner = start - (side + up) / 2
    return joined(
        [
            quad(corner, along, up),
            quad(corner + side, along, up),
            quad(corner, along, side),
            quad(corner + up, along, side),
            quad(corner, side, up),
            quad(corner + along, side, up),
        ]
    )


def closed(rng: Generator, step: str) -> Build:
    """Return boards on risers between two strings, as in homes; `step` is a material's kind."""
    tread, paint = material(rng, step), material(rng, "paint")
    riser = paint if rng.random() < 0.45 else tread
    runner = material(rng, "rug") if rng.random() < 0.3 else None
    string = paint if rng.random() < 0.5 else material(rng, "wood")
    nose = float(rng.uniform(0.01, 0.04))
    return Build(tread, riser, string, material(rng, "ceiling"), 0.035, nose, runner)


def open_risers(rng: Generator, step: str) -> Build:
    """Return treads between two strings with nothing between them."""
    tread = material(rng, step)
    string = tread if rng.random() < 0.4 else material(rng, str(rng.choice(["metal", "plastic"])))
    thick = float(rng.uniform(0.025, 0.08))
    return Build(tread, None, string, string, thick, float(rng.uniform(0.02, 0.05)))


def cast(rng: Generator, step: str) -> Build:
    """Return steps of stone or concrete, at times with a strip along each nosing."""
    tread, under = material(rng, step), material(rng, "ceiling")
    riser = tread if rng.random() < 0.7 else material(rng, step)
    strip = material(rng, str(rng.choice(["metal", "tyre", "paint"])))
    marked = rng.random() < 0.45
    return Build(
        tread, riser, under, under, 0.03, 0.0 if marked else 0.015, strip=strip if marked else None
    )


def flight_parts(flight: Flight, build: Build) -> Parts:
    """Return a flight as it is built."""
    wide = flight.width + 2 * _INTO
    boards = _treads(flight, wide, build.board, build.nose)
    parts = [Part(boards, build.tread)]
    if build.riser is None:
        sides = [s * (flight.width / 2 - 0.02) for s in (-1, 1)]
        parts.append(Part(joined([_string(flight, x) for x in sides]), build.string))
    else:
        parts.append(Part(_risers(flight, wide, build.board), build.riser))
        parts.append(Part(_soffit(flight), build.under))
        cheeks = [_cheek(flight, s * (wide / 2 + 0.002)) for s in (-1, 1)]
        parts.append(Part(joined(cheeks), build.string))
    if build.runner is not None:
        parts.append(Part(_carpet(flight, 0.62 * flight.width, build.nose), build.runner))
    if build.strip is not None:
        parts.append(Part(_strips(flight, build.nose), build.strip))
    return placed(parts, tuple(flight.foot), flight.yaw)


def _treads(flight: Flight, wide: float, thick: float, nose: float) -> Mesh:
    """Return the treads of a flight that starts at the origin along z."""
    deep = flight.going + nose
    return joined(
        [
            box(
                (0, (k + 1) * flight.rise - thick / 2, k * flight.going - nose + deep / 2),
                (wide, thick, deep),
            )
            for k in range(flight.risers - 1)
        ]
    )


def _risers(flight: Flight, wide: float, thick: float) -> Mesh:
    tall = flight.rise - thick
    return joined(
        [
            box(
                (0, k * flight.rise + tall / 2 - _INTO, k * flight.going + 0.01),
                (wide, tall + 2 * _INTO, 0.02),
            )
            for k in range(flight.risers)
        ]
    )


def _string(flight: Flight, aside: float) -> Mesh:
    """Return a beam that carries treads from the side."""
    high = flight.rise - 0.12
    last = np.array([aside, high + (flight.risers - 1) * flight.rise, flight.length])
    return bar(np.array([aside, high, 0.0]), last, 0.05, 0.24)


def _soffit(flight: Flight) -> Mesh:
    """Return the sloping underside, and the end of it below the last riser."""
    climb, wide = (flight.risers - 1) * flight.rise, (flight.width, 0, 0)
    left = -flight.width / 2
    slope = quad((left, -WAIST, 0), wide, (0, climb, flight.length))
    end = quad((left, climb - WAIST, flight.length), wide, (0, WAIST, 0))
    return joined([slope, end])


def _cheek(flight: Flight, aside: float) -> Mesh:
    """Return what closes the side of a flight, from the underside to the steps."""
    k = np.arange(flight.risers - 1)
    z = np.stack([k, k + 1], 1).reshape(-1) * flight.going
    steps = np.repeat((k + 1) * flight.rise, 2) - 0.002
    under = z * flight.rise / flight.going - WAIST
    return surface(np.stack([np.stack([0 * z + aside, y, z], 1) for y in (under, steps)]))


def _carpet(flight: Flight, wide: float, nose: float) -> Mesh:
    """Return a runner that follows treads and risers."""
    k = np.arange(flight.risers)
    front = k * flight.going - nose - 0.006
    y = np.stack([k * flight.rise + 0.006, (k + 1) * flight.rise + 0.006], 1).reshape(-1)[:-1]
    z = np.repeat(front, 2)[:-1]
    rim = [np.stack([0 * y + s * wide / 2, y, z], 1) for s in (-1, 1)]
    return surface(np.stack(rim, 1))


def _strips(flight: Flight, nose: float) -> Mesh:
    return joined(
        [
            box(
                (0, (k + 1) * flight.rise - 0.004, k * flight.going - nose + 0.022),
                (flight.width - 0.04, 0.014, 0.05),
            )
            for k in range(flight.risers - 1)
        ]
    )


def cupboard(flight: Flight, look: Material) -> Parts:
    """Return what closes the space below a flight that begins on a floor."""
    climb = (flight.risers - 1) * flight.rise - WAIST
    start = flight.length * WAIST / (climb + WAIST)
    z = np.array([start, flight.length])
    sides = [
        surface(np.stack([np.stack([0 * z + x, y, z], 1) for y in (0 * z, np.array([0, climb]))]))
        for x in (-flight.width / 2, flight.width / 2)
    ]
    back = quad((-flight.width / 2, 0, flight.length), (flight.width, 0, 0), (0, climb + WAIST, 0))
    return placed([Part(joined([*sides, back]), look)], tuple(flight.foot), flight.yaw)
