"""Railings along flights and landings, and handrails on walls."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.random import Generator

from flexdepth.synth.flights import bar
from flexdepth.synth.materials import Material, Part, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import Array, Mesh, box, joined, tube

_SUNK = 0.16
"""Metres by which balusters reach below nosings and edges, into what carries them."""

Fill = Callable[["Railing", Array, Array], Mesh]
"""What is between the feet and the rail, from one point of the floor's edge to another."""


@dataclass(frozen=True, eq=False)
class Railing:
    """How the railings of one staircase are made.

    Attributes:
        tall: Height of the rail above nosings and floors, metres.
        rail: Its width and height.
        fill: What is below it.
        gap: Metres from one baluster to the next, or from one bar to the next.
        thick: Of a baluster, a bar, a sheet or a wall.
        post: Side of the posts at the ends, or 0.
        frame: Material of rail and posts.
        filling: Of what is below.
    """

    tall: float
    rail: tuple[float, float]
    fill: Fill
    gap: float
    thick: float
    post: float
    frame: Material
    filling: Material

    def along(self, line: Array) -> Parts:
        """Return the railing over a line of points on the edge of floors and nosings."""
        wide, high = self.rail
        raised = line + np.array([0, self.tall - high / 2, 0])
        rails = [bar(a, b, wide, high) for a, b in pairwise(raised)]
        fills = [self.fill(self, a, b) for a, b in pairwise(line)]
        parts = [Part(joined(rails), self.frame), Part(joined(fills), self.filling)]
        if self.post:
            posts = [self._post(end) for end in (line[0], line[-1])]
            parts.append(Part(joined(posts), self.frame))
        return parts

    def _post(self, foot: Array) -> Mesh:
        down, up = 0.25, self.tall + 0.06
        side = self.post
        shaft = box(foot + np.array([0, (up - down) / 2, 0]), (side, up + down, side))
        cap = box(foot + np.array([0, up + 0.01, 0]), (1.3 * side, 0.03, 1.3 * side))
        return joined([shaft, cap])

    def on_wall(self, line: Array) -> Parts:
        """Return the handrail alone, which stands on the wall."""
        wide, high = self.rail
        raised = line + np.array([0, self.tall - high / 2, 0])
        return [Part(joined([bar(a, b, wide, high) for a, b in pairwise(raised)]), self.frame)]


def balusters(railing: Railing, start: Array, end: Array) -> Mesh:
    """Return upright bars from the floor, or a string's edge, to the rail."""
    feet = _between(start, end, railing.gap)
    side, tall = railing.thick, railing.tall - 0.01
    middle = np.array([0, (tall - _SUNK) / 2, 0])
    return joined([box(foot + middle, (side, tall + _SUNK, side)) for foot in feet])


def turned(railing: Railing, start: Array, end: Array) -> Mesh:
    """Return balusters that are thicker below, as a lathe makes them."""
    feet = _between(start, end, railing.gap)
    thin, bulge = railing.thick / 2, 0.3 * railing.tall
    up = np.array([0, 1.0, 0])
    lower = [tube(f - _SUNK * up, f + bulge * up, (0.7 * thin, 1.5 * thin), 6) for f in feet]
    upper = [
        tube(f + bulge * up, f + (railing.tall - 0.03) * up, (1.3 * thin, 0.7 * thin), 6)
        for f in feet
    ]
    return joined([*lower, *upper])


def bars(railing: Railing, start: Array, end: Array) -> Mesh:
    """Return bars or cables that run with the rail, held by posts."""
    levels = np.arange(0.12, railing.tall - 0.06, railing.gap)
    up = np.array([0, 1.0, 0])
    lying = [tube(start + y * up, end + y * up, (railing.thick / 2,) * 2, 6) for y in levels]
    posts = [
        tube(p - _SUNK * up, p + (railing.tall - 0.02) * up, (0.02, 0.02), 8)
        for p in _between(start, end, 1.0)
    ]
    return joined([*lying, *posts])


def sheet(railing: Railing, start: Array, end: Array) -> Mesh:
    """Return boards, sheets or panes, with a slit below the rail and one above the floor."""
    return _filled(start, end, 0.08, railing.tall - 0.12, railing.thick)


def parapet(railing: Railing, start: Array, end: Array) -> Mesh:
    """Return a low wall."""
    return _filled(start, end, -0.25, railing.tall, railing.thick)


def _filled(start: Array, end: Array, low: float, high: float, thick: float) -> Mesh:
    middle = np.array([0, (low + high) / 2, 0])
    return bar(start + middle, end + middle, thick, high - low)


def _between(start: Array, end: Array, gap: float) -> Array:
    """Return points from one end to the other, half a gap or less from both."""
    count = max(1, round(float(np.linalg.norm((end - start)[[0, 2]])) / gap))
    return np.asarray(start + (np.arange(count)[:, None] + 0.5) / count * (end - start))


_FILLS: dict[Fill, tuple[tuple[float, float], tuple[float, float], tuple[str, ...]]] = {
    balusters: ((0.012, 0.09), (0.035, 0.14), ("metal", "paint", "wood", "plastic")),
    turned: ((0.025, 0.1), (0.04, 0.15), ("paint", "wood")),
    bars: ((0.006, 0.1), (0.03, 0.3), ("metal",)),
    sheet: ((0.01, 0.0), (0.02, 0.0), ("metal", "paint", "wood", "pane", "pane", "pane")),
    parapet: ((0.08, 0.0), (0.14, 0.0), ("wall", "paint")),
}
"""Least and most thickness and gap, metres, and material kinds."""


def railing(rng: Generator, fill: Fill) -> Railing:
    """Return random railings with a kind of filling."""
    steel = fill is bars or rng.random() < 0.35
    frame = material(rng, "metal" if steel else str(rng.choice(["wood", "wood", "paint"])))
    least, most, kinds = _FILLS[fill]
    thick, gap = rng.uniform(least, most)
    filling = frame if fill is bars else material(rng, str(rng.choice(kinds)))
    wide = thick + 0.02 if fill is parapet else rng.uniform(0.035, 0.07)
    posted = fill is not parapet and rng.random() < 0.75
    return Railing(
        tall=float(rng.uniform(0.85, 1.1)),
        rail=(float(wide), float(rng.uniform(0.03, 0.07))),
        fill=fill,
        gap=float(gap),
        thick=float(thick),
        post=float(rng.uniform(0.05, 0.11)) if posted else 0.0,
        frame=frame,
        filling=filling,
    )
