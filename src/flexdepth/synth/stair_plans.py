"""Ground plans of stairs: straight, with turns, around a well, and winding."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from flexdepth.synth.flights import WAIST, Flight
from flexdepth.synth.landings import Landing, Plan
from flexdepth.synth.shapes import Array
from flexdepth.synth.spirals import Spiral


@dataclass(frozen=True)
class Measures:
    """What a plan is drawn with.

    Attributes:
        width: Of a flight, metres.
        rise: Height of a riser.
        going: Depth of a tread.
        risers: From one floor to the next; even.
        storeys: How many are climbed.
        lead: Length of the floor before the first flight, metres.
        headroom: Height above the uppermost floor.
    """

    width: float
    rise: float
    going: float
    risers: int
    storeys: int
    lead: float
    headroom: float

    @property
    def storey(self) -> float:
        """Height from floor to floor."""
        return self.risers * self.rise

    @property
    def beneath(self) -> int:
        """How many treads may have the next floor over them, as far as heads allow."""
        return int((self.storey - WAIST - 2.05) / self.rise)

    def flight(self, foot: tuple[float, float, float], yaw: float, risers: int) -> Flight:
        """Return a flight with these measures."""
        return Flight(np.array(foot), yaw, self.width, risers, self.rise, self.going)

    def size(self, wide: float, long: float, storeys: int) -> tuple[float, float, float]:
        """Return the size of the space around so many storeys and the uppermost floor."""
        return wide, long, storeys * self.storey + self.headroom


MakePlan = Callable[[Generator, Measures], Plan]


def straight(rng: Generator, asked: Measures) -> Plan:
    """Return one storey in one line, between two walls or along one side of a hall."""
    w, go, rise = asked.width, asked.going, asked.rise
    beside = 0.0 if rng.random() < 0.35 else float(rng.uniform(1.1, 3.2))
    rests = asked.risers >= 14 and rng.random() < 0.35
    first = asked.risers // 2 if rests else asked.risers
    rest = float(rng.uniform(0.9, 1.3)) if rests else 0.0
    run = (asked.risers - (2 if rests else 1)) * go + rest
    end = float(rng.uniform(1.0, 2.2))
    wide, long = w + beside, asked.lead + run + end
    right = w - wide / 2
    x, z = (right - wide / 2) / 2, asked.lead - long / 2
    flights = [asked.flight((x, 0, z), 0.0, first)]
    upper = asked.storey
    landings = [Landing((-wide / 2, long / 2 - end), (right, long / 2), upper)]
    if rests:
        top = flights[0].top[2]
        landings.append(Landing((-wide / 2, top), (right, top + rest), first * rise))
        flights.append(asked.flight((x, first * rise, top + rest), 0.0, asked.risers - first))
    if beside:
        landings.append(Landing((right, -long / 2), (wide / 2, long / 2), upper))
    landings += _above_foot(asked, -wide / 2, right, (-long / 2, z))
    ground = [Landing((-wide / 2, -long / 2), (right, z), 0.0)]
    if beside:
        ground.append(Landing((right, -long / 2), (wide / 2, long / 2), 0.0))
    return Plan(asked.size(wide, long, 1), tuple(flights), tuple(landings), tuple(ground))


def _above_foot(
    asked: Measures, left: float, right: float, span: tuple[float, float]
) -> list[Landing]:
    """Return the upper floor over the foot of a flight along z, if there is room for one."""
    near, foot = span
    far = foot + (asked.beneath - 1) * asked.going
    return [Landing((left, near), (right, far), asked.storey)] if far > near + 0.6 else []


def l_shaped(rng: Generator, asked: Measures) -> Plan:
    """Return one storey with a quarter turn, in the corner of a hall."""
    w, go = asked.width, asked.going
    first = int(rng.integers(3, asked.risers - 3))
    second = asked.risers - first
    beyond, beside = float(rng.uniform(0.9, 2.0)), (second - 1) * go
    wide, long = w + beside + beyond, asked.lead + (first - 1) * go + w
    inner, right = w - wide / 2, wide / 2 - beyond
    turn_at = long / 2 - w
    z, x = turn_at - (first - 1) * go, (inner - wide / 2) / 2
    flights = (
        asked.flight((x, 0, z), 0.0, first),
        asked.flight((inner, first * asked.rise, long / 2 - w / 2), np.pi / 2, second),
    )
    landings = [
        Landing((-wide / 2, turn_at), (inner, long / 2), first * asked.rise),
        Landing((right, turn_at), (wide / 2, long / 2), asked.storey),
        Landing((inner, -long / 2), (wide / 2, turn_at), asked.storey),
    ]
    landings += _above_foot(asked, -wide / 2, inner, (-long / 2, z))
    ground = (
        Landing((-wide / 2, -long / 2), (inner, z), 0.0),
        Landing((inner, -long / 2), (wide / 2, turn_at), 0.0),
    )
    return Plan(asked.size(wide, long, 1), flights, tuple(landings), ground)


def dog_leg(rng: Generator, asked: Measures) -> Plan:
    """Return storeys of two flights side by side with a half landing between them."""
    w, half = asked.width, asked.risers // 2
    gap = float(rng.uniform(0.05, 0.25) if rng.random() < 0.5 else rng.uniform(0.25, 1.3))
    rest = float(rng.uniform(1.0, 1.5)) * w
    wide, long = 2 * w + gap, asked.lead + (half - 1) * asked.going + rest
    near, far = asked.lead - long / 2, long / 2 - rest
    x = (w + gap) / 2
    flights, landings = [], []
    for storey in range(asked.storeys):
        base, middle = storey * asked.storey, (storey + 0.5) * asked.storey
        flights.append(asked.flight((-x, base, near), 0.0, half))
        flights.append(asked.flight((x, middle, far), np.pi, half))
        landings.append(Landing((-wide / 2, far), (wide / 2, long / 2), middle))
        top = base + asked.storey
        landings.append(Landing((-wide / 2, -long / 2), (wide / 2, near), top))
    ground = (Landing((-wide / 2, -long / 2), (wide / 2, near), 0.0),)
    size = asked.size(wide, long, asked.storeys)
    return Plan(size, tuple(flights), tuple(landings), ground)


def open_well(rng: Generator, asked: Measures) -> Plan:
    """Return storeys of three flights around an open well, with landings in two corners."""
    w, rise = asked.width, asked.rise
    across = int(rng.integers(3, asked.risers // 2 - 1))
    across += (asked.risers - across) % 2
    along = (asked.risers - across) // 2
    wide = 2 * w + (across - 1) * asked.going
    long = asked.lead + (along - 1) * asked.going + w
    near, far, x = asked.lead - long / 2, long / 2 - w, (wide - w) / 2
    flights, landings = [], []
    for storey in range(asked.storeys):
        base = storey * asked.storey
        first, second = base + along * rise, base + (along + across) * rise
        flights.append(asked.flight((-x, base, near), 0.0, along))
        flights.append(asked.flight((w - wide / 2, first, far + w / 2), np.pi / 2, across))
        flights.append(asked.flight((x, second, far), np.pi, along))
        landings.append(Landing((-wide / 2, far), (w - wide / 2, long / 2), first))
        landings.append(Landing((wide / 2 - w, far), (wide / 2, long / 2), second))
        top = base + asked.storey
        landings.append(Landing((-wide / 2, -long / 2), (wide / 2, near), top))
    ground = (Landing((-wide / 2, -long / 2), (wide / 2, near), 0.0),)
    size = asked.size(wide, long, asked.storeys)
    return Plan(size, tuple(flights), tuple(landings), ground)


def winding(rng: Generator, asked: Measures) -> Plan:
    """Return one storey that winds up in a hall: around a post, or in a wide curve."""
    if rng.random() < 0.5:
        inner, outer = 0.05, float(rng.uniform(0.75, 1.1))
        sector = float(rng.uniform(0.38, 0.45))
    else:
        inner = float(rng.uniform(0.5, 1.3))
        outer = inner + asked.width
        sector = 1.02 * asked.going / (inner + 0.55 * asked.width)
    # Three quarters of a turn are free; the landing is over what comes before them.
    sector = min(sector, 1.5 * np.pi / (asked.risers - 1 - asked.beneath))
    hole, beside = 2 * outer + 0.08, float(rng.uniform(1.2, 2.6))
    left, beyond = (float(rng.choice([0.0, rng.uniform(0.8, 1.5)])) for _ in range(2))
    wide, long = left + hole + beside, asked.lead + hole + beyond
    x, z = left - wide / 2, asked.lead - long / 2
    quarter, way = int(rng.integers(4)), int(rng.choice([-1, 1]))
    centre = np.array([x + hole / 2, 0, z + hole / 2])
    spiral = Spiral(
        centre, inner, outer, asked.risers, asked.rise, quarter * np.pi / 2, way * sector
    )
    level = asked.storey
    corner = centre[[0, 2]] + hole / 2 * _out_of((quarter + way * 0.5) * np.pi / 2)
    low, high = np.minimum(corner, centre[[0, 2]]), np.maximum(corner, centre[[0, 2]])
    landings = [Landing((float(low[0]), float(low[1])), (float(high[0]), float(high[1])), level)]
    right = Landing((x + hole, -long / 2), (wide / 2, long / 2), level)
    near = Landing((x, -long / 2), (x + hole, z), level)
    landings += [right, near]
    if left:
        landings.append(Landing((-wide / 2, -long / 2), (x, long / 2), level))
    if beyond:
        landings.append(Landing((x, z + hole), (x + hole, long / 2), level))
    ground = tuple(Landing(floor.low, floor.high, 0.0) for floor in (near, right))
    return Plan(asked.size(wide, long, 1), (), tuple(landings), ground, (spiral,))


def _out_of(yaw: float) -> Array:
    """Return the corner of a square of half side 1 that is nearest to a direction."""
    return np.sign([np.sin(yaw), np.cos(yaw)])
