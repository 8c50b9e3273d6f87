"""The walls around stairs: doors and windows where one stands level, pictures that climb along."""

from itertools import pairwise

import numpy as np
from numpy.random import Generator

from flexdepth.synth.flights import WAIST, Flight, bar
from flexdepth.synth.landings import Landing, Plan
from flexdepth.synth.materials import Material, Part, fitted
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.railings import Railing
from flexdepth.synth.rooms import YAWS
from flexdepth.synth.scene import Beam
from flexdepth.synth.shapes import Array, box, quad
from flexdepth.synth.walls import Walls

_PAINTED = 1.25
"""Height up to which a wall may be of another colour, metres."""

_UPRIGHT = 1.9
"""Metres from a floor to the one above where somebody stands upright, and doors fit."""

Strip = tuple[float, float, tuple[float, ...]]
"""From where to where along a wall, and the levels of the floors that meet the wall there."""


def stair_walls(
    rng: Generator, plan: Plan, walls: Walls, paint: Material | None
) -> tuple[Parts, list[Beam]]:
    """Return the four walls and the sun through their windows; `paint` is their lower part's."""
    parts: Parts = []
    beams: list[Beam] = []
    for yaw in YAWS:
        wide = plan.size[0 if _is_end(yaw) else 1]
        whole = quad((-wide / 2, 0, 0), (wide, 0, 0), (0, plan.size[2], 0))
        parts += placed([Part(whole, walls.shared)], tuple(_place(plan, yaw, 0)), yaw)
        for start, end, levels in strips(plan, yaw):
            across, foot = end - start, _place(plan, yaw, (start + end) / 2)
            for level, upper in pairwise((*levels, plan.size[2] + WAIST)):
                tall = upper - WAIST - level
                if tall < _UPRIGHT:
                    continue
                place = foot + np.array([0, level, 0])
                panel, lit = walls.built(rng, (across, tall), (place, yaw))
                # The first part is the panel itself, which the whole wall has already.
                parts += panel[1:]
                beams += lit
                if paint is not None:
                    low = quad((-across / 2, 0, -0.002), (across, 0, 0), (0, _PAINTED, 0))
                    parts += placed([Part(low, paint)], tuple(place), yaw)
    return parts, beams


def strips(plan: Plan, yaw: float) -> list[Strip]:
    """Return a wall in strips, each with the same floors from end to end."""
    half = plan.size[0 if _is_end(yaw) else 1] / 2
    floors = [
        (*span, landing.level)
        for landing in plan.landings
        if (span := _along_wall(plan, yaw, _corners(landing))) is not None
    ]
    runs = [
        span
        for flight in plan.flights
        if (span := _along_wall(plan, yaw, _outline(flight))) is not None
    ]
    ends = sorted({-half, half, *(end for span in (*floors, *runs) for end in span[:2])})
    found: list[Strip] = []
    for start, end in pairwise(ends):
        middle = (start + end) / 2
        levels = sorted(level for low, high, level in floors if low < middle < high)
        if not any(low < middle < high for low, high in runs):
            levels = [0.0, *levels]
        same = bool(found) and found[-1][2] == tuple(levels)
        first = found.pop()[0] if same else start
        found.append((first, end, tuple(levels)))
    return found


def _is_end(yaw: float) -> bool:
    """Return whether the wall in this direction is one of those across z."""
    return bool(abs(np.cos(yaw)) > 0.5)


def _place(plan: Plan, yaw: float, along: float) -> Array:
    """Return the foot of a wall, so far along it from its middle."""
    out = np.array([np.sin(yaw) * plan.size[0] / 2, 0, np.cos(yaw) * plan.size[1] / 2])
    return out + along * np.array([np.cos(yaw), 0, -np.sin(yaw)])


def _along_wall(plan: Plan, yaw: float, corners: Array) -> tuple[float, float] | None:
    """Return the span along a wall of what stands at it; None for what does not."""
    reach = plan.size[1 if _is_end(yaw) else 0] / 2
    if (corners @ (np.sin(yaw), np.cos(yaw))).max() < reach - 0.02:
        return None
    along = corners @ (np.cos(yaw), -np.sin(yaw))
    return round(float(along.min()), 6), round(float(along.max()), 6)


def _corners(landing: Landing) -> Array:
    (left, near), (right, far) = landing.low, landing.high
    return np.array([(left, near), (right, near), (left, far), (right, far)])


def _outline(flight: Flight) -> Array:
    return np.concatenate([flight.slope(s * flight.width / 2) for s in (-1, 1)])[:, [0, 2]]


def at_wall(plan: Plan, flight: Flight, side: int) -> bool:
    """Return whether a wall is beside a flight, on the right (1) or the left (-1) of who climbs."""
    beyond = np.abs(flight.point(side * (flight.width / 2 + 0.02), 0, 0)[[0, 2]])
    return bool((beyond > np.asarray(plan.size[:2]) / 2).any())


def along_wall(
    rng: Generator, flight: Flight, side: int, walls: Walls, paint: Material | None
) -> Parts:
    """Return what a wall has beside a flight: a skirting, paint, pictures."""
    edge = flight.width / 2
    line = flight.slope(side * (edge - 0.01))
    parts = [Part(bar(line[0], line[1], 0.02, 0.24), walls.trim)]
    if paint is not None:
        low = flight.slope(side * (edge - 0.002)) - np.array([0, 0.3, 0])
        parts.append(Part(quad(low[0], low[1] - low[0], (0, _PAINTED + 0.3, 0)), paint))
    every = int(rng.integers(2, 6))
    if rng.random() < 0.45 and walls.pictures > 1:
        wide, tall = rng.uniform(0.2, 0.55, 2)
        level = rng.uniform(1.3, 1.6) - tall / 2
        for k in range(int(rng.integers(every)), flight.risers - 1, every):
            foot = flight.point(side * edge, (k + 0.5) * flight.going, (k + 1) * flight.rise)
            parts += placed(
                _picture(rng, walls.trim, wide, tall),
                (foot[0], foot[1] + level, foot[2]),
                flight.yaw - side * np.pi / 2,
            )
    return parts


def _picture(rng: Generator, frame: Material, wide: float, tall: float) -> Parts:
    pane = quad((-wide / 2, 0, -0.024), (wide, 0, 0), (0, tall, 0))
    back = box((0, tall / 2, -0.011), (wide + 0.06, tall + 0.06, 0.02))
    return [Part(pane, fitted(rng, "picture", wide, tall)), Part(back, frame)]


def held_on(flight: Flight, side: int, rails: Railing) -> Parts:
    """Return the handrail on the wall beside a flight."""
    return rails.on_wall(flight.slope(side * (flight.width / 2 - 0.07)))
