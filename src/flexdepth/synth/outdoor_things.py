"""Things that stand in streets. Every function returns parts around the origin, on y = 0."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.furniture import Parts
from flexdepth.synth.materials import Part, material
from flexdepth.synth.shapes import (
    blob,
    box,
    cushion,
    joined,
    leaves,
    revolved,
    tube,
)


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
