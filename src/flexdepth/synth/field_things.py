"""Things that stand and lie in the open. Every function returns parts around the origin."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.buildings import building
from flexdepth.synth.materials import Part, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import blob, revolved, tube


def rock(rng: Generator) -> Parts:
    """A boulder or a stone."""
    size = rng.uniform((0.3, 0.2, 0.3), (1, 0.8, 1)) * np.exp(rng.uniform(-0.8, 1.3))
    return [Part(blob(rng, size, 0.3, 12).placed((0, 0.25 * size[1], 0)), material(rng, "rock"))]


def bale(rng: Generator) -> Parts:
    """A round bale of straw that lies on its side."""
    radius, wide = rng.uniform((0.55, 1.0), (0.85, 1.5))
    roll = revolved([(0, -wide / 2), (radius, -wide / 2), (radius, wide / 2), (0, wide / 2)], 22)
    lying = roll.turned(np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]))
    return [Part(lying.placed((0, 0.95 * radius, 0)), material(rng, "straw"))]


def log(rng: Generator) -> Parts:
    """A trunk that lies on the ground."""
    length, radius = rng.uniform((1.5, 0.1), (6, 0.4))
    stem = tube((-length / 2, 0.8 * radius, 0), (length / 2, 0.8 * radius, 0), (radius, radius))
    return [Part(stem, material(rng, "bark"))]


def barn(rng: Generator) -> Parts:
    """A house by itself."""
    return building(rng, float(rng.uniform(6, 16)), 0.0)
