"""Stairs that wind: around a post, or in a wide curve."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexdepth.synth.flights import WAIST, Build
from flexdepth.synth.materials import Part
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import Array, Mesh, joined, quad, surface, tube

_POST = 0.3
"""Inner radius below which treads are fixed to a post in the middle, metres."""


@dataclass(frozen=True, eq=False)
class Spiral:
    """A flight whose steps are sectors of a ring.

    Attributes:
        centre: On the lowest floor, metres.
        inner: Radius of the well, or of the post.
        outer: Radius of the outer edge.
        risers: How many; the last one leads onto the landing.
        rise: Height of a riser, metres.
        end: Angle of the last riser, from z towards x.
        sector: Angle from one riser to the next, positive from z towards x.
    """

    centre: Array
    inner: float
    outer: float
    risers: int
    rise: float
    end: float
    sector: float

    def point(self, radius: float, riser: ArrayLike, up: ArrayLike) -> Array:
        """Return points at a radius, at the angles of risers (0 is the first), at some heights."""
        angle = self.end + (np.asarray(riser) - (self.risers - 1)) * self.sector
        across = [radius * np.sin(angle), np.asarray(up) + 0 * angle, radius * np.cos(angle)]
        return np.asarray(self.centre + np.stack(across, -1))

    def steps(self) -> Array:
        """Return a point of each tread where one walks."""
        number = np.arange(self.risers - 1)
        radius = self.inner + 0.6 * (self.outer - self.inner)
        return self.point(radius, number + 0.5, (number + 1) * self.rise)

    def edges(self) -> list[Array]:
        """Return the lines of the nosings at the outer edge, and at that of an open well."""
        number = np.linspace(0, self.risers - 1, 2 * self.risers - 1)
        radii = [self.outer - 0.03, *([self.inner + 0.03] if self.inner > _POST else [])]
        return [self.point(radius, number, (number + 1) * self.rise) for radius in radii]


def spiral_parts(spiral: Spiral, build: Build) -> Parts:
    """Return the stairs as they are built; those around a post have open risers."""
    number = range(spiral.risers - 1)
    thick = max(build.board, 0.03)
    treads = [_sector(spiral, k, k + 1.06, ((k + 1) * spiral.rise - thick, thick)) for k in number]
    parts = [Part(joined(treads), build.tread)]
    if spiral.inner <= _POST:
        top = spiral.centre + np.array([0, spiral.risers * spiral.rise + 1.0, 0])
        post = tube(spiral.centre, top, (spiral.inner, spiral.inner), 16)
        return [*parts, Part(post, build.string)]
    if build.riser is not None:
        risers = [
            _riser(spiral, k, k * spiral.rise - 0.01, spiral.rise) for k in range(spiral.risers)
        ]
        parts += [Part(joined(risers), build.riser), Part(_underside(spiral), build.under)]
    strings = [_string(spiral, radius) for radius in (spiral.inner, spiral.outer)]
    return [*parts, Part(joined(strings), build.string)]


def _sector(spiral: Spiral, first: float, last: float, span: tuple[float, float]) -> Mesh:
    """Return a tread from one angle to another, its underside at a height and so thick."""
    low, thick = span
    angles = np.linspace(first, last, 5)
    ring = [
        (spiral.inner, low + thick),
        (spiral.outer, low + thick),
        (spiral.outer, low),
        (spiral.inner, low),
        (spiral.inner, low + thick),
    ]
    around = surface(np.stack([spiral.point(r, angles, y) for r, y in ring], 1))
    ends = [_riser(spiral, k, low, thick) for k in (first, last)]
    return joined([around, *ends])


def _riser(spiral: Spiral, number: float, low: float, tall: float) -> Mesh:
    inner, outer = (spiral.point(radius, number, low) for radius in (spiral.inner, spiral.outer))
    return quad(inner, outer - inner, (0, tall, 0))


def _underside(spiral: Spiral) -> Mesh:
    number = np.linspace(0, spiral.risers - 1, 2 * spiral.risers)
    rims = [
        spiral.point(radius, number, number * spiral.rise - WAIST)
        for radius in (spiral.inner, spiral.outer)
    ]
    return surface(np.stack(rims))


def _string(spiral: Spiral, radius: float) -> Mesh:
    """Return the curved board that carries the treads at one side."""
    number = np.linspace(0, spiral.risers - 1, 2 * spiral.risers)
    rims = [
        spiral.point(radius, number, number * spiral.rise + up)
        for up in (-WAIST, spiral.rise + 0.03)
    ]
    return surface(np.stack(rims))
