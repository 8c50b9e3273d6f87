"""What is behind the windows of cars, and the lamps of all that drives."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Material, Part, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import Array, Mesh, blob, cushion, joined, tilt, wire

_RED = np.array([[0.35, 0.01, 0.01]] * 3)


def lamps(rng: Generator, heads: Mesh, tails: Mesh, lit: bool) -> Parts:
    """Return head lamps and tail lamps; lit ones shine white and red."""
    warm = np.array([1.0, rng.uniform(0.85, 1.0), rng.uniform(0.6, 1.05)])
    white = Material("plain", np.tile(warm, (3, 1)), (1.0, 1.0), float(rng.uniform(6, 14)))
    red = Material("plain", 3 * _RED, (1.0, 1.0), float(rng.uniform(0.3, 0.9)))
    dark = Material("plain", _RED, (1.0, 1.0), gloss=0.05)
    return [
        Part(heads, white if lit else material(rng, "paint")),
        Part(tails, red if lit else dark),
    ]


def interior(rng: Generator, width: float, belt: float, reach: tuple[float, float]) -> Parts:
    """Return seats and a steering wheel, and in some cars a driver, who looks towards -z.

    Args:
        rng: Draws them.
        width: Half the width of the car, metres.
        belt: Height of what the seats rise from, metres.
        reach: Height of the roof, and z of the front seats.
    """
    roof, z = reach
    tall = max(0.3, roof - belt - 0.14)
    seats = []
    for x, behind in ((-0.42, 0.0), (0.42, 0.0), (-0.42, 0.85), (0.42, 0.85)):
        middle = (x * width, belt - 0.12 + tall / 2, z + behind)
        seats.append(cushion(middle, (0.48 * width, tall, 0.13), 0.4, 4))
        if behind == 0:
            seats.append(cushion((x * width, belt + tall, z), (0.24, 0.15, 0.09), 0.6, 4))
    angle = np.linspace(0, 2 * np.pi, 11)
    ring = 0.18 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1) @ tilt(-0.5).T
    wheel = wire(ring + np.array([-0.42 * width, belt + 0.04, z - 0.5]), 0.013)
    parts = [
        Part(joined(seats), material(rng, str(rng.choice(["leather", "fabric", "tyre"])))),
        Part(wheel, material(rng, "tyre")),
    ]
    if rng.random() < 0.3:
        parts += _driver(rng, np.array([-0.42 * width, belt - 0.15, z - 0.15]), roof)
    return parts


def _driver(rng: Generator, at: Array, roof: float) -> Parts:
    """Return head and shoulders of somebody."""
    high = roof - 0.1 - at[1]
    up = np.array([0, high, 0])
    chest = blob(rng, (0.46, 0.62 * high, 0.24), 0.0, 6).placed(at + 0.3 * up)
    skull = blob(rng, (0.16, 0.24, 0.19), 0.0, 6).placed(at + up - (0, 0.12, 0.02))
    hair = blob(rng, (0.18, 0.18, 0.2), 0.03, 6).placed(at + up - (0, 0.07, -0.03))
    return [
        Part(chest, material(rng, "fabric")),
        Part(skull, material(rng, "skin")),
        Part(hair, material(rng, "bark")),
    ]
