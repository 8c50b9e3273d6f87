"""Things that stand in streets. Every function returns parts around the origin, on y = 0."""

from itertools import pairwise

import numpy as np
from numpy.random import Generator

from flexdepth.synth.furniture import Parts, placed
from flexdepth.synth.materials import Material, Part, colour, fitted, material
from flexdepth.synth.shapes import (
    Mesh,
    blob,
    box,
    cushion,
    joined,
    leaves,
    prism,
    quad,
    revolved,
    tube,
)

_CAR = ((-2.1, 0.25), (-2.15, 0.6), (-1.9, 0.78), (-1.0, 0.9), (1.9, 0.92), (2.1, 0.7), (2.1, 0.25))
_CABIN = ((-1.1, 0.88), (-0.35, 1.42), (0.9, 1.45), (1.75, 0.9))
_VAN = ((-2.5, 0.25), (-2.55, 0.95), (-2.0, 1.15), (-1.3, 1.9), (2.5, 2.0), (2.55, 0.25))
_VAN_GLASS = ((-1.95, 1.15), (-1.35, 1.8), (-0.4, 1.82), (-0.4, 1.15))


def _wheels(width: float, base: float, radius: float) -> Mesh:
    disc = revolved([(0, -0.1), (radius, -0.1), (radius, 0.1), (0, 0.1)], 16)
    upright = disc.turned(np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]))
    return joined(
        [
            upright.placed((i * (width / 2 - 0.08), radius, j * base / 2))
            for i in (-1, 1)
            for j in (-1, 1)
        ]
    )


def vehicle(rng: Generator) -> Parts:
    """A car or a van that drives towards -z."""
    van = rng.random() < 0.2
    body, glass = (_VAN, _VAN_GLASS) if van else (_CAR, _CABIN)
    width = 1.95 if van else 1.75
    stretch = rng.uniform((0.95, 0.9, 0.8), (1.08, 1.15, 1.15))
    shade = colour(rng, 1.0, (0.01, 0.8))
    paint = Material("plain", np.stack([shade, shade * 0.8, shade * 0.6]), (3.0, 3.0))
    cabin = Part(prism(glass, width * (1.005 if van else 0.86)), material(rng, "glass"))
    lamp = [
        box((i * width * 0.36, 0.66, j * 2.12), (0.3, 0.14, 0.1)) for i in (-1, 1) for j in (-1, 1)
    ]
    parts = [
        Part(prism(body, width), paint),
        cabin,
        Part(_wheels(width, 2.6 if not van else 3.1, 0.32), material(rng, "tyre")),
        Part(joined(lamp), material(rng, "paint")),
    ]
    if not van:
        parts.append(Part(box((0, 1.45, 0.25), (width * 0.8, 0.05, 1.25)), paint))
    return [Part(part.mesh.scaled(stretch), part.material) for part in parts]


def bicycle(rng: Generator) -> Parts:
    """A bicycle along z, leaning on nothing."""
    angle = np.linspace(0, 2 * np.pi, 17)
    rims = []
    for z in (-0.52, 0.52):
        ring = np.stack([0 * angle, 0.34 + 0.33 * np.sin(angle), z + 0.33 * np.cos(angle)], 1)
        rims += [tube(a, b, (0.02, 0.02), 5) for a, b in pairwise(ring)]
    joints = {
        "seat": (0, 0.9, 0.2),
        "pedal": (0, 0.3, 0.05),
        "head": (0, 0.85, -0.4),
        "rear": (0, 0.34, 0.52),
        "front": (0, 0.34, -0.52),
    }
    pairs = (
        ("seat", "pedal"),
        ("pedal", "head"),
        ("head", "front"),
        ("seat", "rear"),
        ("pedal", "rear"),
        ("seat", "head"),
    )
    frame = [tube(joints[a], joints[b], (0.02, 0.02), 5) for a, b in pairs]
    bar = tube((-0.28, 1.0, -0.38), (0.28, 1.0, -0.38), (0.015, 0.015), 5)
    return [
        Part(joined(rims), material(rng, "tyre")),
        Part(joined([*frame, bar]), material(rng, "metal")),
    ]


def tree(rng: Generator) -> Parts:
    """A tree: a trunk, some branches and a crown of lumps and leaves."""
    height = rng.uniform(3, 11)
    stem = height * rng.uniform(0.25, 0.5)
    crown = rng.uniform((0.35, 0.5, 0.35), (0.8, 0.9, 0.8)) * height
    wood = [tube((0, 0, 0), (0, height * 0.75, 0), (0.025 * height, 0.008 * height))]
    for _ in range(int(rng.integers(3, 8))):
        tip = rng.normal(0, 0.22, 3) * height + (0, stem + 0.3 * height, 0)
        wood.append(
            tube((0, stem * rng.uniform(0.8, 1.3), 0), tip, (0.012 * height, 0.004 * height), 6)
        )
    parts = [Part(joined(wood), material(rng, "bark"))]
    if rng.random() < 0.12:
        return parts
    centre = (0, stem + crown[1] / 2, 0)
    foliage = [
        leaves(rng, crown * 1.08, int(rng.integers(400, 1200)), 0.045 * height).placed(centre)
    ]
    for _ in range(int(rng.integers(2, 6))):
        at = np.asarray(centre) + rng.uniform(-0.25, 0.25, 3) * crown
        foliage.append(blob(rng, crown * rng.uniform(0.35, 0.65), 0.12).placed(at))
    return [*parts, Part(joined(foliage), material(rng, "leaf"))]


def bush(rng: Generator) -> Parts:
    """A bush or a clipped hedge."""
    size = rng.uniform((0.6, 0.5, 0.6), (3, 1.8, 1.5))
    body = blob(rng, size, 0.1) if rng.random() < 0.6 else cushion((0, 0, 0), size, 0.2)
    shell = leaves(rng, size * 1.08, int(rng.integers(150, 500)), 0.14)
    return [Part(joined([body, shell]).placed((0, 0.42 * size[1], 0)), material(rng, "leaf"))]


def pole(rng: Generator) -> Parts:
    """A lamp post, a traffic sign, a traffic light or a telegraph pole."""
    height, radius = rng.uniform(2.2, 8.0), rng.uniform(0.03, 0.12)
    shaft = tube((0, 0, 0), (0, height, 0), (radius, 0.7 * radius))
    parts = [Part(shaft, material(rng, str(rng.choice(["metal", "bark"]))))]
    kind = rng.random()
    if kind < 0.4:
        shape = revolved(
            [(0, -0.02), (0.32, -0.02), (0.32, 0.02), (0, 0.02)], int(rng.choice([3, 4, 8, 20]))
        )
        face = shape.turned(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]))
        parts.append(Part(face.placed((0, min(height, 2.5), -0.1)), material(rng, "poster")))
    elif kind < 0.6:
        parts.append(
            Part(box((0, min(height, 3.0), -0.15), (0.3, 0.9, 0.25)), material(rng, "tyre"))
        )
    elif kind < 0.85:
        arm = joined(
            [
                tube((0, height, 0), (1.2, height + 0.2, 0), (0.04, 0.03)),
                box((1.3, height + 0.2, 0), (0.6, 0.12, 0.25)),
            ]
        )
        parts.append(Part(arm, parts[0].material))
    return parts


def fence(rng: Generator) -> Parts:
    """A fence, wall or railing along x."""
    length, height = rng.uniform((4, 0.7), (15, 2.0))
    if rng.random() < 0.5:
        return [Part(box((0, height / 2, 0), (length, height, 0.2)), material(rng, "brickwork"))]
    posts = [
        box((x, height / 2, 0), (0.07, height, 0.05))
        for x in np.arange(-length / 2, length / 2, rng.uniform(0.14, 0.6))
    ]
    rails = [box((0, height * y, 0), (length, 0.06, 0.03)) for y in (0.2, 0.85)]
    return [Part(joined(posts + rails), material(rng, str(rng.choice(["wood", "metal", "paint"]))))]


def house(rng: Generator, width: float) -> Parts:
    """A building whose front stands in the plane z = 0, facing -z, `width` wide."""
    storey = rng.uniform(2.7, 3.5)
    storeys = int(rng.integers(1, 7)) if rng.random() < 0.5 else int(rng.integers(1, 3))
    height, depth = storeys * storey, rng.uniform(6, 14)
    bays = max(1, round(width / rng.uniform(2.2, 4.0)))
    look = material(rng, "brickwork")
    parts = [Part(box((0, height / 2, depth / 2), (width, height, depth)), look)]
    parts += _facade(rng, width, storey, storeys, bays)
    if rng.random() < 0.6:
        peak, eave = height + rng.uniform(0.25, 0.6) * depth / 2, 0.35
        gable = [(-eave, height - 0.1), (depth / 2, peak), (depth + eave, height - 0.1)]
        parts.append(
            Part(
                prism(gable, width + (2 * eave if rng.random() < 0.7 else 0)), material(rng, "roof")
            )
        )
    else:
        parts.append(
            Part(
                box((0, height, depth / 2), (width + 0.4, 0.35, depth + 0.4)),
                material(rng, "paint"),
            )
        )
    return parts


def _facade(rng: Generator, width: float, storey: float, storeys: int, bays: int) -> Parts:
    """Return windows set into the front, a door, and shop windows on some ground floors."""
    shop = rng.random() < 0.25
    pitch = width / bays
    wide, tall = pitch * rng.uniform(0.3, 0.65), storey * rng.uniform(0.35, 0.6)
    sill, inset = storey * rng.uniform(0.2, 0.35), rng.uniform(-0.03, 0.02)
    panes, frames, doors = [], [], []
    for floor in range(storeys):
        for bay in range(bays):
            x, y = (bay + 0.5) * pitch - width / 2, floor * storey
            if floor == 0 and (shop or bay == bays // 2):
                span = pitch * 0.9 if shop else 1.0
                doors.append(quad((x - span / 2, 0.15, -0.04), (span, 0, 0), (0, 2.2, 0)))
                continue
            panes.append(quad((x - wide / 2, y + sill, inset - 0.03), (wide, 0, 0), (0, tall, 0)))
            frames.append(box((x, y + sill, -0.06), (wide + 0.25, 0.1, 0.2)))
            frames.append(box((x, y + sill + tall, -0.04), (wide + 0.2, 0.12, 0.12)))
    parts: Parts = []
    if panes:
        glass = fitted(rng, "facade", wide, tall) if rng.random() < 0.4 else material(rng, "glass")
        parts += [Part(joined(panes), glass), Part(joined(frames), material(rng, "paint"))]
    if doors:
        parts.append(Part(joined(doors), material(rng, "poster" if shop else "cabinet")))
    if rng.random() < 0.25 and storeys > 1:
        bands = [box((0, k * storey, -0.05), (width, 0.2, 0.15)) for k in range(1, storeys)]
        parts.append(Part(joined(bands), material(rng, "paint")))
    return parts


__all__ = ["bicycle", "bush", "fence", "house", "placed", "pole", "tree", "vehicle"]
