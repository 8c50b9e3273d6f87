"""Things that stand in streets. Every function returns parts around the origin, on y = 0."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Part, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import box, joined, revolved, tube


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
