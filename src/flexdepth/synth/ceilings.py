"""What hangs under ceilings: joists, pipes, cables and lamps."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Material, Part, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.scene import AreaLight
from flexdepth.synth.shapes import Mesh, blob, box, joined, quad, revolved, tube


def under_ceiling(
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


def odd_corners(rng: Generator, look: Material, size: tuple[float, float, float]) -> Parts:
    """Return what makes rooms less of a box: pillars, chimneys, beams, a sloping roof."""
    width, length, height = size
    parts: Parts = []
    if rng.random() < 0.2:
        wide, deep = rng.uniform(0.2, 0.8, 2)
        x, z = rng.choice((-0.5, 0.5), 2) * (width - wide, length - deep) * rng.uniform(0.3, 1, 2)
        parts.append(Part(box((x, height / 2, z), (wide, height, deep)), look))
    if rng.random() < 0.12:
        level, reach = rng.uniform(0.9, 0.9 * height), rng.uniform(0.3, 0.6) * width
        rise = (-reach, height - level + 0.01, 0)
        slope = quad((width / 2, level, -length / 2), rise, (0, 0, length))
        parts.append(Part(slope, look if rng.random() < 0.5 else material(rng, "wood")))
    if rng.random() < 0.12:
        deep, z = rng.uniform(0.15, 0.4), rng.uniform(-0.4, 0.4) * length
        beam = box((0, height - deep / 2, z), (width, deep, rng.uniform(0.15, 0.4)))
        parts.append(Part(beam, look if rng.random() < 0.5 else material(rng, "wood")))
    return parts


def lamps(
    rng: Generator, count: int, size: tuple[float, float, float]
) -> tuple[Parts, list[AreaLight]]:
    """Return ceiling lamps of a room of the given width, length and height, and their light."""
    width, length, height = size
    parts: Parts = []
    lights = []
    hanging = rng.random() < 0.35
    shade = rng.uniform(0.12, 0.3)
    tint = np.array([1, rng.uniform(0.8, 1), rng.uniform(0.5, 1)])
    for _ in range(count):
        x, z = rng.uniform(-0.4, 0.4, 2) * (width, length)
        drop = float(rng.uniform(0.3, 0.9)) if hanging and height > 2.3 else 0.03
        side = float(rng.uniform(0.1, 0.7))
        power = tint * rng.uniform(1.0, 6.0) / count
        body = _fitting(rng, drop, shade if hanging else side)
        shining = Material("plain", np.tile(tint, (3, 1)), (1.0, 1.0), float(rng.uniform(2, 9)))
        parts.append(Part(body.placed((x, height, z)), shining))
        if hanging:
            wire = tube((x, height, z), (x, height - drop + 0.05, z), (0.006, 0.006))
            parts.append(Part(wire, material(rng, "plastic")))
        lights.append(AreaLight(np.array([x, height - drop - 0.12, z]), side, power))
    return parts, lights


def _fitting(rng: Generator, drop: float, size: float) -> Mesh:
    """Return the shining body of a lamp that hangs `drop` below y = 0."""
    if drop > 0.1:
        if rng.random() < 0.5:
            return blob(rng, (size, size, size), 0.0, 14).placed((0, -drop, 0))
        bell = [(0.03, -drop + 0.08), (size / 2, -drop), (size, -drop - 0.06)]
        return revolved(bell, 24)
    kind = rng.random()
    if kind < 0.4:
        return box((0, -0.025, 0), (size, 0.03, rng.uniform(0.1, 1.2)))
    return revolved([(0, -0.08), (size / 2, -0.06), (size / 2, 0)], 24)
