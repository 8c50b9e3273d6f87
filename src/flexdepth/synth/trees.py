"""Trees and undergrowth of several habits, near and far. All stand around the origin on y = 0."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Material, Part, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import (
    Mesh,
    blob,
    joined,
    leaves,
    leaves_at,
    revolved,
    rods,
    surface,
    tube,
    wire,
)

_FOLIAGE = ("leaf", "leaf", "leaf", "leaf", "autumn", "blossom")


def foliage(rng: Generator) -> Material:
    """Return what leaves look like: mostly green."""
    return material(rng, "leaf" if rng.random() < 0.8 else str(rng.choice(_FOLIAGE)))


def broadleaf(rng: Generator) -> Parts:
    """A tree with boughs, each with its own cloud of leaves, and air between them."""
    height = float(rng.uniform(4, 16))
    stem, wide = height * rng.uniform(0.2, 0.42), height * rng.uniform(0.22, 0.42)
    lean = rng.normal(0, 0.04, 2) * height
    top = np.array([lean[0], stem, lean[1]])
    wood = [tube((0, -0.3, 0), top, (0.028 * height, 0.02 * height))]
    green = []
    leaf = float(min(rng.uniform(0.015, 0.04) * height, 0.25))
    for _ in range(int(rng.integers(7, 16))):
        way = rng.normal(size=3)
        way /= np.linalg.norm(way)
        middle = top + np.array([0, 0.45 * (height - stem), 0])
        tip = middle + way * (wide, 0.5 * (height - stem), wide) * rng.uniform(0.45, 0.9)
        wood.append(tube(top, tip, (0.012 * height, 0.004 * height), 5))
        size = np.array([1, rng.uniform(0.55, 0.9), 1]) * height * rng.uniform(0.12, 0.28)
        green.append(leaves(rng, size * 1.15, int(rng.integers(120, 280)), leaf).placed(tip))
        green.append(blob(rng, 0.72 * size, 0.2, 7).placed(tip))
    bark = material(rng, "bark")
    return [Part(joined(wood), bark), Part(joined(green), foliage(rng))]


def conifer(rng: Generator) -> Parts:
    """A spruce or a pine: a cone of drooping whorls with ragged edges."""
    height = float(rng.uniform(4, 20))
    foot, wide = height * rng.uniform(0.03, 0.25), height * rng.uniform(0.13, 0.25)
    meshes, spots = [], []
    for level in np.linspace(0, 1, int(rng.integers(12, 24))):
        y = foot + (height - foot) * level
        radius = wide * (1.04 - level) * rng.uniform(0.8, 1.1)
        angle = np.linspace(0, 2 * np.pi, 14)
        ragged = radius * rng.uniform(0.5, 1.15, 14)
        ragged[-1] = ragged[0]
        rim = np.stack([ragged * np.cos(angle), -0.45 * ragged, ragged * np.sin(angle)], 1)
        inner = 0.1 * rim + np.array([0, 0.25 * radius, 0])
        meshes.append(surface(np.stack([inner, rim]) + np.array([0, y, 0])))
        spots.append(rim[:-1] * rng.uniform(0.5, 1.05, (13, 1)) + np.array([0, y, 0]))
    meshes.append(leaves_at(rng, np.concatenate(spots * 3), min(0.05 * height, 0.4)))
    trunk = tube((0, -0.3, 0), (0, 0.97 * height, 0), (0.02 * height, 0.004 * height))
    dark = material(rng, "leaf")
    dark = Material(dark.pattern, dark.colours * rng.uniform(0.35, 0.9), dark.size)
    return [Part(trunk, material(rng, "bark")), Part(joined(meshes), dark)]


def poplar(rng: Generator) -> Parts:
    """A slender tree, or a cypress."""
    height = float(rng.uniform(5, 18))
    wide = height * rng.uniform(0.1, 0.18)
    middle = (0, 0.54 * height, 0)
    body = blob(rng, (wide, 0.9 * height, wide), 0.08).placed(middle)
    shell = leaves(rng, (1.2 * wide, 0.95 * height, 1.2 * wide), 500, 0.025 * height)
    trunk = tube((0, -0.3, 0), (0, 0.3 * height, 0), (0.018 * height, 0.014 * height))
    return [
        Part(joined([body, shell.placed(middle)]), foliage(rng)),
        Part(trunk, material(rng, "bark")),
    ]


def palm(rng: Generator) -> Parts:
    """A palm: a bent trunk and arching fronds."""
    height = float(rng.uniform(3, 11))
    share = np.linspace(0, 1, 7)
    bend = rng.normal(0, 0.12, 2)
    line = np.stack([bend[0] * share**2, share, bend[1] * share**2], 1) * height
    radius = 0.02 * height + 0.06
    trunk = wire(line, radius, 7)
    fronds = [
        _frond(height * rng.uniform(0.28, 0.42), yaw, rng.uniform(-0.2, 0.9)).placed(line[-1])
        for yaw in rng.uniform(0, 2 * np.pi, int(rng.integers(11, 20)))
    ]
    return [Part(trunk, material(rng, "bark")), Part(joined(fronds), material(rng, "leaf"))]


def _frond(length: float, yaw: float, rise: float) -> Mesh:
    """Return an arching rib with leaflets on both sides."""
    s = np.linspace(0.05, 1, 22)
    rib = np.stack([0 * s, rise * s - (0.5 + 0.5 * rise) * s**2.2, 0.9 * s], 1) * length
    spread = 0.22 * length * np.sin(np.pi * s**0.7) ** 0.6 + 0.01
    blades = []
    for side in (-1, 1):
        tip = rib + np.stack([side * spread, -0.45 * spread, 0.5 * spread], 1)
        wide = np.array([0, 0, 0.022 * length])
        blades.append(np.stack([rib - wide, rib + wide, tip], 1))
    corners = np.concatenate(blades)
    return Mesh(corners, corners[..., [0, 2]].copy()).placed((0, 0, 0), yaw)


def bare(rng: Generator) -> Parts:
    """A tree without leaves: limbs that fork into ever thinner twigs."""
    height = float(rng.uniform(4, 13))
    start, end = np.zeros((1, 3)), np.array([[0.0, 0.33 * height, 0]])
    radius = 0.024 * height
    limbs = [tube(start[0] - (0, 0.3, 0), end[0], (radius, 0.8 * radius))]
    for level in range(5):
        fork = 3 if level < 2 else 2
        base, way = np.repeat(end, fork, 0), np.repeat(end - start, fork, 0)
        length = np.linalg.norm(way, axis=1, keepdims=True) * rng.uniform(0.55, 0.9, (len(base), 1))
        turned = way / np.linalg.norm(way, axis=1, keepdims=True)
        turned = turned + rng.normal(0, 0.42, base.shape) + (0, 0.12, 0)
        tip = base + length * turned / np.linalg.norm(turned, axis=1, keepdims=True)
        radius *= 0.58
        limbs.append(rods(base, tip, max(radius, 0.006)))
        start, end = base, tip
    return [Part(joined(limbs), material(rng, "bark"))]


def shrub(rng: Generator) -> Parts:
    """A bush that is leaves all through, some with flowers."""
    size = rng.uniform((0.5, 0.4, 0.5), (2.8, 2.2, 2.8))
    middle = (0, 0.45 * size[1], 0)
    leaf = float(rng.uniform(0.035, 0.12))
    count = int(rng.uniform(0.4, 1.2) * min(2200, 1.5 * size[0] * size[1] / leaf**2) + 150)
    green = leaves(rng, size, count, leaf)
    core = blob(rng, 0.62 * size, 0.35, 9)
    parts = [Part(joined([green, core]).placed(middle), foliage(rng))]
    if rng.random() < 0.3:
        blooms = leaves(rng, 1.05 * size, int(rng.integers(30, 150)), leaf)
        parts.append(Part(blooms.placed(middle), material(rng, "blossom")))
    return parts


def far_tree(rng: Generator) -> Parts:
    """A tree that is only seen from far away: few triangles."""
    height = float(rng.uniform(5, 18))
    if rng.random() < 0.35:
        wide = height * rng.uniform(0.12, 0.25)
        cone = revolved([(wide, 0), (0.6 * wide, 0.4 * height), (0, height)], 7)
        return [Part(cone, material(rng, "wood far"))]
    size = np.array([rng.uniform(0.4, 0.8), rng.uniform(0.5, 0.8), rng.uniform(0.4, 0.8)]) * height
    crown = blob(rng, size, 0.25, 7).placed((0, height - 0.5 * size[1], 0))
    ragged = leaves(rng, 1.15 * size, 70, 0.09 * height).placed((0, height - 0.5 * size[1], 0))
    trunk = tube((0, -1, 0), (0, 0.5 * height, 0), (0.02 * height, 0.02 * height), 5)
    return [Part(joined([crown, ragged]), material(rng, "wood far")),
            Part(trunk, material(rng, "bark"))]  # fmt: skip


TREES: tuple[Callable[[Generator], Parts], ...] = (
    broadleaf, broadleaf, broadleaf, conifer, poplar, palm, bare,
)  # fmt: skip
"""Trees of all habits."""


def tree(rng: Generator) -> Parts:
    """A tree of any habit."""
    return TREES[int(rng.integers(len(TREES)))](rng)
