"""Rooms: homes, offices, kitchens and corridors, with furniture, lamps, doors and windows."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.furniture import AGAINST_WALLS, FREE_STANDING, Parts, placed
from flexdepth.synth.materials import Part, fitted, glowing, material
from flexdepth.synth.scene import AreaLight, Scene
from flexdepth.synth.shapes import Mesh, box, joined, quad, turn

_WALL_YAWS = (0.0, np.pi / 2, np.pi, -np.pi / 2)


def room(rng: Generator) -> Scene:
    """Return a furnished room with the camera somewhere inside."""
    width, length, height = rng.uniform((2.4, 2.4, 2.2), (8.0, 8.0, 3.2))
    if rng.random() < 0.15:
        width, length = rng.uniform(1.4, 2.4), rng.uniform(5, 14)
    crowd = rng.uniform(0.4, 1.0)
    parts = _shell(rng, width, length, height)
    for yaw in _WALL_YAWS:
        across, reach = (width, length) if yaw in (0.0, np.pi) else (length, width)
        against = _row_along_wall(rng, across, crowd) + _on_wall(rng, across, height)
        parts += placed(against, tuple(turn(yaw) @ (0, 0, reach / 2)), yaw)
    for _ in range(int(rng.poisson(0.35 * crowd * width * length))):
        make = FREE_STANDING[int(rng.integers(len(FREE_STANDING)))]
        x, z = rng.uniform(-0.42, 0.42, 2) * (width, length)
        yaw = (
            float(rng.choice(_WALL_YAWS) + rng.normal(0, 0.2))
            if rng.random() < 0.7
            else rng.uniform(0, 6.3)
        )
        parts += placed(make(rng), (x, 0, z), yaw)
    margin = np.minimum((0.35, 0, 0.35), (width / 4, 0, length / 4))
    corner = np.array([width / 2, 0, length / 2]) - margin
    warm = np.array([1, rng.uniform(0.85, 1), rng.uniform(0.65, 1.1)])
    return Scene(
        parts=parts,
        lamps=_lamps(rng, width, length, height),
        sun=None,
        ambient=warm * rng.uniform(0.08, 0.5),
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


def _shell(rng: Generator, width: float, length: float, height: float) -> Parts:
    """Return floor, ceiling, walls and skirting."""
    corner = np.array([-width / 2, 0, -length / 2])
    floor = quad(corner, (width, 0, 0), (0, 0, length))
    ceiling = quad((-width / 2, height, -length / 2), (width, 0, 0), (0, 0, length))
    parts = [Part(floor, material(rng, "floor")), Part(ceiling, material(rng, "ceiling"))]
    shared = material(rng, "wall")
    trim = material(rng, "wood")
    for yaw in _WALL_YAWS:
        across, reach = (width, length) if yaw in (0.0, np.pi) else (length, width)
        wall = quad((-across / 2, 0, 0), (across, 0, 0), (0, height, 0))
        look = shared if rng.random() < 0.75 else material(rng, "wall")
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


def _row_along_wall(rng: Generator, across: float, crowd: float) -> Parts:
    """Return furniture side by side along a wall at z = 0 that is `across` wide."""
    parts: Parts = []
    x = -across / 2 + rng.exponential(0.4)
    while x < across / 2 - 0.4:
        thing = AGAINST_WALLS[int(rng.integers(len(AGAINST_WALLS)))](rng)
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


def _lamps(rng: Generator, width: float, length: float, height: float) -> list[AreaLight]:
    count = int(rng.integers(1, 4))
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
