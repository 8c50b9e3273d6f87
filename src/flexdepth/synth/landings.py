"""Floors and landings of stairs, the flights between them, and where one could fall off."""

from dataclasses import dataclass

import numpy as np

from flexdepth.synth.flights import Flight
from flexdepth.synth.shapes import Array
from flexdepth.synth.spirals import Spiral


@dataclass(frozen=True, eq=False)
class Landing:
    """A level rectangle: a floor or a landing.

    Attributes:
        low: Least x and z, metres.
        high: Greatest x and z.
        level: Height of what one stands on.
    """

    low: tuple[float, float]
    high: tuple[float, float]
    level: float

    @property
    def size(self) -> tuple[float, float]:
        """Width along x and length along z."""
        return self.high[0] - self.low[0], self.high[1] - self.low[1]

    def edges(self) -> list[tuple[int, float, float, float]]:
        """Return its edges: the axis across each, the edge's place on it, and from where to where.

        The axis is 0 for x and 1 for z.
        """
        (left, near), (right, far) = self.low, self.high
        return [(0, left, near, far), (0, right, near, far), (1, near, left, right),
                (1, far, left, right)]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Plan:
    """Where everything is, around the origin; the lowest floor is y = 0.

    Attributes:
        size: Width along x, length along z, and height of the space, metres.
        flights: Flights.
        landings: Floors above the lowest one, and landings.
        ground: What is free of the lowest floor.
        spirals: Flights that wind.
    """

    size: tuple[float, float, float]
    flights: tuple[Flight, ...]
    landings: tuple[Landing, ...]
    ground: tuple[Landing, ...]
    spirals: tuple[Spiral, ...] = ()


def open_edges(plan: Plan) -> list[Array]:
    """Return where one could fall off a landing: lines of two points on the landings' edges."""
    lines = []
    for landing in plan.landings:
        for axis, place, start, end in landing.edges():
            if abs(abs(place) - plan.size[axis] / 2) < 0.02:
                continue
            closed = _joins(plan, landing, (axis, place))
            inwards = 0.03 if place == landing.low[axis] else -0.03
            for low, high in _left_over((start, end), closed):
                ends = np.empty((2, 3))
                ends[:, 1] = landing.level
                ends[:, 2 * axis] = place + inwards
                ends[:, 2 - 2 * axis] = low, high
                lines.append(ends)
    return lines


def _joins(plan: Plan, landing: Landing, edge: tuple[int, float]) -> list[tuple[float, float]]:
    """Return where flights and other landings join an edge: spans along it."""
    axis, place = edge
    spans = []
    for flight in plan.flights:
        for end in (flight.foot, flight.top):
            if abs(end[1] - landing.level) < 0.01 and abs(end[2 * axis] - place) < 0.01:
                middle = float(end[2 - 2 * axis])
                spans.append((middle - flight.width / 2, middle + flight.width / 2))
    for spiral in plan.spirals:
        ends = spiral.point(1.0, spiral.risers - 1, 0)
        outward = (ends - spiral.centre)[2 - 2 * axis]
        on_edge = abs(outward) > 0.5 and abs(spiral.centre[2 * axis] - place) < 0.01
        if on_edge and abs(spiral.risers * spiral.rise - landing.level) < 0.01:
            middle = float(spiral.centre[2 - 2 * axis])
            inner, outer = (middle + outward * r for r in (spiral.inner, spiral.outer))
            spans.append((min(inner, outer), max(inner, outer)))
    for other in plan.landings:
        touches = min(abs(other.low[axis] - place), abs(other.high[axis] - place)) < 0.01
        if other is not landing and other.level == landing.level and touches:
            spans.append((other.low[1 - axis], other.high[1 - axis]))
    return spans


def _left_over(
    span: tuple[float, float], taken: list[tuple[float, float]]
) -> list[tuple[float, float]]:
    """Return what is left of a span, without scraps."""
    left, start = [], span[0]
    for low, high in sorted(taken):
        end = min(low, span[1])
        if end - start > 0.1:
            left.append((start, end))
        start = max(start, high)
    return [*left, (start, span[1])] if span[1] - start > 0.1 else left
