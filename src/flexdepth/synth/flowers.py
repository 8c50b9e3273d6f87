"""Flowers, grass and leaves near enough to be looked at. All stand around the origin on y = 0."""

import colorsys
from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Material, Part, material
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.shapes import Array, Mesh, blob, joined, surface, tilt, wire


def _vivid(rng: Generator) -> Material:
    """Return the colour of petals: bright and saturated, paler towards the rim."""
    hue = float(rng.choice([0.0, 0.05, 0.1, 0.14, 0.75, 0.85, 0.92]) + rng.normal(0, 0.02))
    inner = np.array(colorsys.hsv_to_rgb(hue % 1, rng.uniform(0.3, 1), rng.uniform(0.5, 0.95)))
    if rng.random() < 0.2:
        inner = np.full(3, rng.uniform(0.7, 0.9))
    other = np.clip(inner * rng.uniform(0.5, 1.2, 3), 0.01, 0.95)
    return Material("mottled", np.stack([inner, other, 0.6 * inner]), (0.12, 0.12))


def _petal(length: float, width: float, rise: float, curl: float) -> Mesh:
    """Return a petal or a leaf that grows from the origin along z, rises, and curls down."""
    s = np.linspace(0, 1, 5)[:, None]
    t = np.linspace(-1, 1, 3)[None]
    wide = width * np.sin(np.pi * np.clip(s, 0.02, 1) ** 0.75) ** 0.8 / 2 + 0.02 * width
    x = t * wide
    y = length * (rise * s - curl * s**2) + 0.25 * wide * t**2
    return surface(np.stack([x + 0 * s, y, length * s + 0 * t], -1))


def _head(rng: Generator, radius: float, count: int) -> tuple[Mesh, Mesh]:
    """Return the petals and the middle of a flower that looks up."""
    core = radius * rng.uniform(0.15, 0.45)
    width = rng.uniform(1.0, 2.2) * 2 * np.pi * (core + 0.3 * radius) / count
    rise, curl = rng.uniform(0.0, 0.8), rng.uniform(0.0, 0.7)
    petals = []
    for k in range(count):
        one = _petal(radius - 0.7 * core, width, rise + rng.normal(0, 0.08), curl)
        yaw = 2 * np.pi * k / count + rng.normal(0, 0.08)
        petals.append(one.placed((0.7 * core * np.sin(yaw), 0, 0.7 * core * np.cos(yaw)), yaw))
    middle = blob(rng, (2 * core, core * rng.uniform(0.4, 1.2), 2 * core), 0.06, 7)
    return joined(petals), middle.placed((0, 0.1 * core, 0))


def _stalk(rng: Generator, height: float, thick: float) -> tuple[Mesh, Array]:
    """Return a bent stalk, and its tip."""
    share = np.linspace(0, 1, 5)
    bend = rng.normal(0, 0.1, 2) * height
    line = np.stack([bend[0] * share**2, height * share, bend[1] * share**2], 1)
    return wire(line, thick), line[-1]


def flower(rng: Generator, height: float, radius: float) -> Parts:
    """A flower on its stalk with some leaves; it nods to where it likes."""
    stalk, tip = _stalk(rng, height, max(0.003, 0.012 * height))
    nod = tilt(-float(rng.uniform(0, 1.4)))
    petals, middle = (
        mesh.turned(nod).placed(tip, 0) for mesh in _head(rng, radius, int(rng.integers(5, 26)))
    )
    blades = [
        _petal(height * rng.uniform(0.2, 0.45), height * rng.uniform(0.05, 0.22), 0.7, 0.8).placed(
            (0, height * rng.uniform(0.05, 0.75), 0), yaw
        )
        for yaw in rng.uniform(0, 6.3, int(rng.integers(2, 7)))
    ]
    dark = Material("speckled", rng.uniform(0.02, 0.5, (3, 1)) * (1, 0.7, 0.25), (0.03, 0.03))
    return [
        Part(joined([stalk, *blades]), material(rng, "leaf")),
        Part(petals, _vivid(rng)),
        Part(middle, dark),
    ]


def daisy(rng: Generator) -> Parts:
    """A small flower of a meadow or a garden."""
    return flower(rng, rng.uniform(0.15, 0.7), rng.uniform(0.03, 0.1))


def sunflower(rng: Generator) -> Parts:
    """A tall flower with a large head."""
    return flower(rng, rng.uniform(1.0, 2.0), rng.uniform(0.12, 0.25))


def herb(rng: Generator) -> Parts:
    """A plant of broad leaves around a stalk, or a fern."""
    height = rng.uniform(0.2, 1.2)
    stalk, _ = _stalk(rng, height, 0.01 * height)
    narrow = rng.uniform(0.06, 0.35)
    blades = []
    for level in np.linspace(0.05, 1, int(rng.integers(5, 16))):
        length = height * rng.uniform(0.3, 0.7) * (1.15 - 0.6 * level)
        one = _petal(length, narrow * length, rng.uniform(0.2, 1.2), rng.uniform(0.2, 1.0))
        blades.append(one.placed((0, level * height, 0), rng.uniform(0, 6.3)))
    return [Part(joined([stalk, *blades]), material(rng, "leaf"))]


def bed(
    rng: Generator, make: Callable[[Generator], Parts], spots: Array, templates: int = 3
) -> Parts:
    """Return plants of a few individuals, each put at many of the spots, in any direction."""
    kinds = [make(rng) for _ in range(templates)]
    facing = rng.uniform(0, 2 * np.pi)
    parts: Parts = []
    for kind, own in zip(kinds, np.array_split(spots, templates), strict=True):
        for at in own:
            grown = rng.uniform(0.7, 1.2)
            turned = facing + rng.normal(0, 0.9)
            big = [Part(part.mesh.scaled(grown), part.material) for part in kind]
            parts += placed(big, tuple(at), turned)
    return parts


def grass(rng: Generator, spots: Array, height: float) -> Mesh:
    """Return bent blades, three triangles each, one at each spot."""
    count = len(spots)
    tall = height * rng.uniform(0.4, 1.3, (count, 1))
    yaw = rng.uniform(0, 2 * np.pi, count)
    wide = np.stack([np.cos(yaw), 0 * yaw, np.sin(yaw)], 1) * (0.003 + 0.012 * tall)
    bend = rng.normal(0, 0.3, (count, 3)) * tall * (1, 0, 1)
    middle = spots + (0, 0.6, 0) * tall + 0.3 * bend
    tip = spots + (0, 1.0, 0) * tall + bend
    a, b, c, d = spots - wide, spots + wide, middle - 0.7 * wide, middle + 0.7 * wide
    corners = np.concatenate(
        [np.stack([a, b, c], 1), np.stack([c, b, d], 1), np.stack([c, d, tip], 1)]
    )
    return Mesh(corners, corners[..., [0, 1]].copy())
