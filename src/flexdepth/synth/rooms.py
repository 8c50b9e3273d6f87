"""Rooms: homes, offices, kitchens, corridors and cellars, with furniture, lamps and doors."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.furniture import AGAINST_WALLS, FREE_STANDING, STORED, Parts, placed
from flexdepth.synth.materials import Part, fitted, glowing, material
from flexdepth.synth.scene import AreaLight, Scene
from flexdepth.synth.shapes import Mesh, box, joined, quad, tube, turn

_WALL_YAWS = (0.0, np.pi / 2, np.pi, -np.pi / 2)


@dataclass(frozen=True)
class _Kind:
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
    """

    lowest: tuple[float, float, float]
    largest: tuple[float, float, float]
    surfaces: tuple[str, str, str]
    along_walls: tuple[Callable[[Generator], Parts], ...]
    anywhere: tuple[Callable[[Generator], Parts], ...]
    crowd: tuple[float, float]
    density: float
    dark: float
    hung: float


_HOME = _Kind(
    lowest=(2.4, 2.4, 2.2),
    largest=(8.0, 8.0, 3.2),
    surfaces=("wall", "ceiling", "floor"),
    along_walls=AGAINST_WALLS,
    anywhere=FREE_STANDING,
    crowd=(0.4, 1.0),
    density=0.35,
    dark=0.2,
    hung=0.0,
)
_CELLAR = _Kind(
    lowest=(2.2, 2.6, 1.95),
    largest=(6.5, 9.0, 2.7),
    surfaces=("bare", "bare", "bare"),
    along_walls=STORED,
    anywhere=STORED,
    crowd=(0.7, 1.0),
    density=0.45,
    dark=0.75,
    hung=7.0,
)


def room(rng: Generator) -> Scene:
    """Return a furnished room of a home or an office with the camera somewhere inside."""
    return _furnished(rng, _HOME)


def cellar(rng: Generator) -> Scene:
    """Return a cellar, shed or workshop: low, bare, crowded and mostly dark."""
    return _furnished(rng, _CELLAR)


def _furnished(rng: Generator, kind: _Kind) -> Scene:
    width, length, height = rng.uniform(kind.lowest, kind.largest)
    if rng.random() < 0.15:
        width, length = rng.uniform(1.4, 2.4), rng.uniform(5, 14)
    crowd = rng.uniform(*kind.crowd)
    parts = _shell(rng, kind.surfaces, width, length, height)
    for yaw in _WALL_YAWS:
        across, reach = (width, length) if yaw in (0.0, np.pi) else (length, width)
        against = _row_along_wall(rng, kind.along_walls, across, crowd)
        against += _on_wall(rng, across, height)
        parts += placed(against, tuple(turn(yaw) @ (0, 0, reach / 2)), yaw)
    for _ in range(int(rng.poisson(kind.density * crowd * width * length))):
        make = kind.anywhere[int(rng.integers(len(kind.anywhere)))]
        x, z = rng.uniform(-0.42, 0.42, 2) * (width, length)
        yaw = (
            float(rng.choice(_WALL_YAWS) + rng.normal(0, 0.2))
            if rng.random() < 0.7
            else rng.uniform(0, 6.3)
        )
        parts += placed(make(rng), (x, 0, z), yaw)
    parts += _under_ceiling(rng, kind.hung, width, length, height)
    margin = np.minimum((0.35, 0, 0.35), (width / 4, 0, length / 4))
    corner = np.array([width / 2, 0, length / 2]) - margin
    warm = np.array([1, rng.uniform(0.85, 1), rng.uniform(0.65, 1.1)])
    dark = rng.random() < kind.dark
    return Scene(
        parts=parts,
        lamps=_lamps(rng, 1 if dark else int(rng.integers(1, 4)), width, length, height),
        sun=None,
        ambient=warm * (rng.uniform(0.005, 0.06) if dark else rng.uniform(0.08, 0.5)),
        occlusion_reach=float(rng.uniform(0.5, 1.6)),
        horizon=np.ones(3),
        zenith=np.ones(3),
        clouds=0.0,
        eyes=(
            -corner + np.array([0, rng.uniform(0.5, 1.2), 0]),
            corner + np.array([0, rng.uniform(1.2, min(2.0, height - 0.2)), 0]),
        ),
        outdoors=False,
    )


def _shell(
    rng: Generator, surfaces: tuple[str, str, str], width: float, length: float, height: float
) -> Parts:
    """Return floor, ceiling, walls and skirting."""
    on_wall, overhead, underfoot = surfaces
    corner = np.array([-width / 2, 0, -length / 2])
    floor = quad(corner, (width, 0, 0), (0, 0, length))
    ceiling = quad((-width / 2, height, -length / 2), (width, 0, 0), (0, 0, length))
    parts = [Part(floor, material(rng, underfoot)), Part(ceiling, material(rng, overhead))]
    shared = material(rng, on_wall)
    trim = material(rng, "wood")
    for yaw in _WALL_YAWS:
        across, reach = (width, length) if yaw in (0.0, np.pi) else (length, width)
        wall = quad((-across / 2, 0, 0), (across, 0, 0), (0, height, 0))
        look = shared if rng.random() < 0.75 else material(rng, on_wall)
        board = box((0, 0.04, -0.01), (across, 0.08, 0.015))
        parts += placed(
            [Part(wall, look), Part(board, trim)], tuple(turn(yaw) @ (0, 0, reach / 2)), yaw
        )
    if rng.random() < 0.3:
        rug = box(
            (0, 0.006, 0),
            (*(rng.uniform(0.3, 0.7, 1) * width), 0.012, rng.uniform(0.3, 0.7) * length),
        )
        parts.append(Part(rug, material(rng, "fabric")))
    return parts


def _row_along_wall(
    rng: Generator, things: tuple[Callable[[Generator], Parts], ...], across: float, crowd: float
) -> Parts:
    """Return furniture side by side along a wall at z = 0 that is `across` wide."""
    parts: Parts = []
    x = -across / 2 + rng.exponential(0.4)
    while x < across / 2 - 0.4:
        thing = things[int(rng.integers(len(things)))](rng)
        if rng.random() < crowd:
            corners = np.concatenate([part.mesh.corners.reshape(-1, 3) for part in thing])
            low, high = corners.min(0), corners.max(0)
            if x + high[0] - low[0] > across / 2:
                break
            parts += placed(thing, (x - low[0], 0, -high[2] - 0.02 - rng.exponential(0.03)))
            x += high[0] - low[0]
        x += rng.exponential(0.5)
    return parts


def _on_wall(rng: Generator, across: float, height: float) -> Parts:
    """Return doors, windows and pictures on a wall at z = 0."""
    parts: Parts = []
    for _ in range(int(rng.poisson(2.2))):
        kind = rng.random()
        wide, tall, base = rng.uniform((0.25, 0.25, 1.0), (1.3, 1.0, 1.5))
        if kind < 0.25:
            wide, tall, base = rng.uniform(0.75, 1.0), rng.uniform(1.95, 2.1), 0.0
        elif kind < 0.45:
            wide, tall, base = rng.uniform(0.6, 2.0), rng.uniform(0.8, 1.5), rng.uniform(0.5, 1.0)
        tall = min(tall, height - base - 0.05)
        if wide > across - 0.3 or tall < 0.2:
            continue
        x = rng.uniform(-across / 2 + 0.1, across / 2 - wide - 0.1)
        look = fitted(rng, "cabinet" if kind < 0.25 else "poster", wide, tall)
        if 0.25 <= kind < 0.45:
            look = glowing(
                rng, str(rng.choice(["mottled", "plain", "windows"])), rng.uniform(0.4, 4)
            )
        parts.append(Part(quad((x, base, -0.02), (wide, 0, 0), (0, tall, 0)), look))
        parts.append(Part(_frame(x, base, wide, tall), material(rng, "wood")))
    return parts


def _frame(x: float, base: float, wide: float, tall: float) -> Mesh:
    bar = 0.05
    upright = [box((x + s * wide, base + tall / 2, -0.02), (bar, tall + bar, 0.05)) for s in (0, 1)]
    lying = [box((x + wide / 2, base + s * tall, -0.02), (wide, bar, 0.05)) for s in (0, 1)]
    return joined(upright + lying)


def _under_ceiling(
    rng: Generator, count: float, width: float, length: float, height: float
) -> Parts:
    """Return joists in a row, pipes, ducts and cables under the ceiling; `count` on average."""
    parts: Parts = []
    if count and rng.random() < 0.5:
        deep, pitch = rng.uniform((0.08, 0.35), (0.22, 0.9))
        rows = np.arange(-length / 2 + 0.1, length / 2, pitch)
        joists = [box((0, height - deep / 2, z), (width, deep, 0.05)) for z in rows]
        parts.append(Part(joined(joists), material(rng, "wood")))
    for _ in range(int(rng.poisson(count))):
        look = material(rng, str(rng.choice(["metal", "metal", "paint", "thing"])))
        bore = float(np.exp(rng.uniform(np.log(0.008), np.log(0.15))))
        x, z = rng.uniform(-0.47, 0.47, (2, 2)) * ((width, width), (length, length))
        level = height - bore - rng.uniform(0.02, 0.3)
        match int(rng.integers(4)):
            case 0:
                ends = (-width / 2, level, z[0]), (width / 2, level, z[0])
            case 1:
                ends = (x[0], level, -length / 2), (x[0], level, length / 2)
            case 2:
                ends = (x[0], 0.0, z[0]), (x[0], height, z[0])
            case _:
                ends = (x[0], level, z[0]), (x[1], level - rng.uniform(0, 0.5), z[1])
        parts.append(Part(tube(*ends, (bore, bore)), look))
    return parts


def _lamps(
    rng: Generator, count: int, width: float, length: float, height: float
) -> list[AreaLight]:
    lamps = []
    for _ in range(count):
        tint = np.array([1, rng.uniform(0.8, 1), rng.uniform(0.55, 1)])
        at: NDArray[np.float64] = np.array(
            [rng.uniform(-0.4, 0.4) * width, height - 0.06, rng.uniform(-0.4, 0.4) * length]
        )
        if rng.random() < 0.3:
            at[1] = rng.uniform(0.9, height - 0.3)
        lamps.append(
            AreaLight(at, float(rng.uniform(0.05, 0.7)), tint * rng.uniform(0.6, 4.0) / count)
        )
    return lamps
