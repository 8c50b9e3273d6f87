"""Rooms: homes, offices, kitchens, shops, corridors and cellars, with their furniture and light."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from flexdepth.synth.ceilings import lamps, odd_corners, under_ceiling
from flexdepth.synth.clutter import ON_FLOORS, clutter
from flexdepth.synth.furniture import (
    AGAINST_WALLS,
    FREE_STANDING,
    IN_OFFICES,
    IN_SHOPS,
    KITCHENS,
    OFFICES,
    SHOPS,
    STORED,
)
from flexdepth.synth.parts import Maker, Parts, bounds, chosen, placed
from flexdepth.synth.scene import AreaLight, Beam, Scene
from flexdepth.synth.shapes import Array
from flexdepth.synth.viewpoints import IN_ROOMS
from flexdepth.synth.walls import Gap, Walls, shell

YAWS = (0.0, np.pi / 2, np.pi, -np.pi / 2)
"""The ways out through the four walls of a room."""

_OPEN = 0.4
"""Share of rooms that open into another through a wide gap or an open door."""


@dataclass(frozen=True)
class Kind:
    """What makes a room a home or a cellar.

    Attributes:
        lowest: Least width, length and height, metres.
        largest: The most.
        surfaces: Material kinds of walls, ceiling and floor.
        along_walls: What stands along the walls.
        anywhere: What stands anywhere.
        crowd: Least and most share of the places that are taken.
        density: Free-standing things per square metre of a full room.
        dark: Share of rooms with a weak lamp and hardly any other light.
        hung: How many pipes, joists and cables hang under the ceiling, on average.
        pictures: How many doors, windows and pictures a wall has, on average.
    """

    lowest: tuple[float, float, float]
    largest: tuple[float, float, float]
    surfaces: tuple[str, str, str]
    along_walls: tuple[Maker, ...]
    anywhere: tuple[Maker, ...]
    crowd: tuple[float, float]
    density: float
    dark: float = 0.1
    hung: float = 0.0
    pictures: float = 3.0


_PLAIN = ("wall", "ceiling", "floor")

HOME = Kind((2.4, 2.4, 2.2), (8, 8, 3.2), _PLAIN, AGAINST_WALLS, FREE_STANDING, (0.4, 1), 0.35)
OFFICE = Kind((3, 3, 2.4), (12, 12, 3.2), _PLAIN, OFFICES, IN_OFFICES, (0.5, 1), 0.3, 0.03, 1.0)
KITCHEN = Kind((2.2, 2.4, 2.3), (6, 6, 3), _PLAIN, KITCHENS, FREE_STANDING[:7], (0.8, 1), 0.25)
SHOP = Kind((4, 5, 2.6), (12, 14, 4), _PLAIN, SHOPS, IN_SHOPS, (0.7, 1), 0.3, 0.02, 2.0)
CORRIDOR = Kind((1.3, 5, 2.2), (2.6, 18, 3.2), _PLAIN, AGAINST_WALLS, FREE_STANDING, (0, 0.5), 0.1)
CELLAR = Kind(
    (2.2, 2.6, 1.95), (6.5, 9, 2.7), ("bare", "bare", "bare"), STORED, STORED, (0.7, 1), 0.45,
    0.6, 7.0, 1.0,
)  # fmt: skip

_KINDS = (HOME, OFFICE, KITCHEN, CORRIDOR)
"""What may be next door."""


def home(rng: Generator) -> Scene:
    """Return a living room, a bedroom or a study."""
    return furnished(rng, HOME)


def office(rng: Generator) -> Scene:
    """Return an office with desks, screens and shelves."""
    return furnished(rng, OFFICE)


def cookery(rng: Generator) -> Scene:
    """Return a kitchen of a home or an office, with counters along most walls and a table."""
    return furnished(rng, KITCHEN)


def shop(rng: Generator) -> Scene:
    """Return a shop with shelves of goods in rows."""
    return furnished(rng, SHOP)


def corridor(rng: Generator) -> Scene:
    """Return a long narrow room."""
    return furnished(rng, CORRIDOR)


def cellar(rng: Generator) -> Scene:
    """Return a cellar, shed or workshop: low, bare, crowded and mostly dark."""
    return furnished(rng, CELLAR)


def furnished(rng: Generator, kind: Kind) -> Scene:
    """Return a room of a kind with the camera somewhere inside; some open into another."""
    size = _size(rng, kind)
    width, length, height = size
    opening = Gap.drawn(rng, width, height) if rng.random() < _OPEN else None
    whole = _contents(rng, kind, size, opening)
    if opening is not None:
        whole = whole.beside(_next_door(rng, kind, opening, size), (0, 0, length / 2))
    return lit(rng, whole, size, bool(rng.random() < kind.dark))


def lit(rng: Generator, whole: "Contents", size: tuple[float, float, float], dark: bool) -> Scene:
    """Return the scene of what is in a space around the origin, of a width, length and height."""
    width, length, height = size
    warm = np.array([1, rng.uniform(0.85, 1), rng.uniform(0.65, 1.1)])
    corner = np.array([width / 2, 0, length / 2]) - np.minimum(
        (0.35, 0, 0.35), (width / 4, 0, length / 4)
    )
    below = height - 0.12
    return Scene(
        parts=whole.parts,
        lamps=whole.lamps[:1] if dark else whole.lamps,
        sun=None,
        ambient=warm * (rng.uniform(0.01, 0.08) if dark else rng.uniform(0.05, 0.45)),
        occlusion_reach=float(rng.uniform(0.4, 1.4)),
        horizon=np.ones(3),
        zenith=np.ones(3),
        clouds=0.0,
        eyes=(-corner, corner + np.array([0, below, 0])),
        outdoors=False,
        beams=() if dark else tuple(whole.beams),
        subjects=tuple(whole.subjects),
        carriers=IN_ROOMS,
        ceiling=below,
    )


def _size(rng: Generator, kind: Kind) -> tuple[float, float, float]:
    width, length, height = rng.uniform(kind.lowest, kind.largest)
    return float(width), float(length), float(height)


def _next_door(
    rng: Generator, kind: Kind, opening: Gap, size: tuple[float, float, float]
) -> "Contents":
    """Return the room behind an opening; it begins at z = 0."""
    other = _KINDS[int(rng.integers(len(_KINDS)))] if rng.random() < 0.6 else kind
    width, length, _ = _size(rng, other)
    wide, long = max(min(width, 6.0), opening.right - opening.left + 0.3), min(length, 6.0)
    behind = _contents(rng, other, (wide, long, size[2]), None, closed=YAWS[:2] + YAWS[3:])
    middle = (opening.left + opening.right) / 2
    return Contents([], [], [], []).beside(behind, (middle, 0, long / 2))


@dataclass(frozen=True, eq=False)
class Contents:
    """What a room consists of: parts, lamps, sunlight and what is worth a look from near."""

    parts: Parts
    lamps: list[AreaLight]
    beams: list[Beam]
    subjects: list[tuple[Array, Array]]

    def beside(self, other: "Contents", at: tuple[float, float, float]) -> "Contents":
        """Return these with the parts and one lamp of another room moved to a place."""
        moved = [replace(lamp, centre=lamp.centre + at) for lamp in other.lamps[:1]]
        return replace(self, parts=self.parts + placed(other.parts, at), lamps=self.lamps + moved)


def _contents(
    rng: Generator,
    kind: Kind,
    size: tuple[float, float, float],
    opening: Gap | None,
    closed: tuple[float, ...] = YAWS,
) -> Contents:
    """Return a room around the origin; `opening` is in its wall at +z."""
    width, length, height = size
    crowd = rng.uniform(*kind.crowd)
    walls = Walls.drawn(rng, kind.surfaces[0], kind.pictures, bool(rng.random() < 0.6))
    parts = shell(rng, kind.surfaces, width, length, height)
    beams: list[Beam] = []
    things: list[Parts] = []
    for yaw in closed:
        across, reach = (width, length) if yaw in (0.0, np.pi) else (length, width)
        at = (float(np.sin(yaw) * reach / 2), 0.0, float(np.cos(yaw) * reach / 2))
        gap = opening if yaw == 0.0 else None
        against = row_along_wall(rng, kind.along_walls, across, crowd)
        things += [placed(thing, at, yaw) for thing in against if gap is None or gap.misses(thing)]
        wall, lit = walls.built(rng, (across, height), (np.asarray(at), yaw), gap)
        parts += wall
        beams += lit
    things += _strewn(rng, kind, crowd, (width, length))
    parts += [part for thing in things for part in thing]
    parts += under_ceiling(rng, kind.hung, width, length, height)
    parts += odd_corners(rng, walls.shared, size)
    fittings, lights = lamps(rng, int(rng.integers(1, 4)), size)
    return Contents(parts + fittings, lights, beams, [bounds(thing) for thing in things])


def _strewn(rng: Generator, kind: Kind, crowd: float, size: tuple[float, float]) -> list[Parts]:
    """Return what stands anywhere in a room; most of it is square with the walls."""
    things = []
    for _ in range(int(rng.poisson(kind.density * crowd * size[0] * size[1]))):
        thing = chosen(rng, kind.anywhere)
        x, z = rng.uniform(-0.42, 0.42, 2) * size
        square = float(rng.choice(YAWS) + rng.normal(0, 0.15))
        yaw = square if rng.random() < 0.7 else float(rng.uniform(0, 6.3))
        things.append(placed(thing, (float(x), 0, float(z)), yaw))
    if rng.random() < 0.4:
        count = int(rng.integers(2, 14))
        room = (0.85 * size[0], 0.85 * size[1])
        things.append(clutter(rng, room, count, 0.4, ON_FLOORS))
    return things


def row_along_wall(
    rng: Generator, things: tuple[Maker, ...], across: float, crowd: float
) -> list[Parts]:
    """Return furniture side by side along a wall at z = 0 that is `across` wide."""
    row: list[Parts] = []
    x = -across / 2 + rng.exponential(0.3)
    while x < across / 2 - 0.4:
        thing = chosen(rng, things)
        if rng.random() < crowd:
            low, high = bounds(thing)
            if x + high[0] - low[0] > across / 2:
                break
            gap = 0.02 + rng.exponential(0.02)
            row.append(placed(thing, (float(x - low[0]), 0, float(-high[2] - gap))))
            x += high[0] - low[0]
        x += rng.exponential(0.4)
    return row
