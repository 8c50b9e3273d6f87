"""One thing near the camera, outdoors, with everything else far behind it."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.random import Generator

from flexdepth.synth.bystanders import bystander, pet
from flexdepth.synth.field_things import rock
from flexdepth.synth.fixtures import ball
from flexdepth.synth.flowers import bed, daisy, grass, herb, sunflower
from flexdepth.synth.landscapes import landscape
from flexdepth.synth.materials import Part, material
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.scene import Aim, Carrier, Scene
from flexdepth.synth.shapes import Array, box, joined, rods, tube, wire
from flexdepth.synth.streets import street
from flexdepth.synth.trees import shrub
from flexdepth.synth.vehicles import bicycle

Make = Callable[[Generator], Parts]

_NEAR: tuple[tuple[float, Make, tuple[float, float]], ...] = (
    (0.2, sunflower, (0.4, 1.6)),
    (0.2, daisy, (0.12, 0.6)),
    (0.06, herb, (0.25, 1.2)),
    (0.06, shrub, (0.7, 2.5)),
    (0.12, pet, (0.4, 2.0)),
    (0.1, bystander, (0.8, 2.8)),
    (0.1, bicycle, (0.5, 2.0)),
    (0.06, rock, (0.5, 2.0)),
)
"""What is looked at, how often, and from how far."""


def flowers(rng: Generator) -> Scene:
    """Return a bed of flowers that the camera is held into, before a landscape."""
    tall = rng.random() < 0.5
    make: Make = sunflower if tall else daisy
    base = landscape(rng)
    reach = 14.0 if tall else 5.0
    count = int(rng.integers(100, 320))
    away, yaw = reach * rng.random(count) ** 0.8, rng.uniform(0, 2 * np.pi, count)
    spots = np.stack([away * np.sin(yaw), 0 * yaw, away * np.cos(yaw)], 1)
    spots = spots[away > (0.8 if tall else 0.25)]
    parts = bed(rng, make, spots, 4)
    blades = rng.uniform(-reach, reach, (int(rng.integers(0, 5000)), 3)) * (0.6, 0, 0.6)
    if len(blades):
        parts.append(Part(grass(rng, blades, 0.35 if tall else 0.12), material(rng, "leaf")))
    height = (0.7, 1.9) if tall else (0.15, 0.8)
    carrier = Carrier(height, Aim.AROUND, 0.0, (-0.05, 0.2), 0.06, (35.0, 75.0))
    return _near(rng, base, parts, np.zeros(3), (0.5, carrier))


def close_up(rng: Generator) -> Scene:
    """Return a thing near the camera before a landscape or a street."""
    shares = np.array([share for share, _, _ in _NEAR])
    _, make, span = _NEAR[int(rng.choice(len(shares), p=shares / shares.sum()))]
    base = landscape(rng) if rng.random() < 0.6 else street(rng)
    thing = make(rng)
    corners = np.concatenate([part.mesh.corners.reshape(-1, 3) for part in thing])
    low, high = corners.min(0), corners.max(0)
    looked_at = (low + high) / 2
    looked_at[1] = low[1] + (high[1] - low[1]) * rng.uniform(0.45, 0.9)
    away = float(np.exp(rng.uniform(*np.log(span))))
    level = looked_at[1] + away * rng.uniform(-0.35, 0.6)
    height = float(max(level, 0.08))
    carrier = Carrier((height, height + 0.1), Aim.SUBJECT, 0.12, (0.0, 0.06), 0.06, (35.0, 65.0))
    return _near(rng, base, placed(thing, (0, 0, 0)), looked_at, (away, carrier))


def hoop(rng: Generator) -> Scene:
    """Return a basketball hoop with its net from below, the sky behind it."""
    base = landscape(rng) if rng.random() < 0.5 else street(rng)
    subject = np.array([0, 3.0, 0])
    carrier = Carrier((1.2, 1.9), Aim.SUBJECT, 0.12, (0.0, 0.08), 0.08, (35.0, 60.0))
    return _near(rng, base, basket(rng), subject, (float(rng.uniform(1.2, 4)), carrier))


def basket(rng: Generator) -> Parts:
    """A basketball hoop at three metres, with board, post and net, and sometimes a ball in it."""
    angle = np.linspace(0, 2 * np.pi, 19)

    def ring(radius: float, y: float) -> list[Array]:
        return [np.array([radius * np.sin(a), y, radius * np.cos(a)]) for a in angle]

    sizes = ((0.23, 3.05), (0.19, 2.93), (0.155, 2.82), (0.13, 2.7), (0.12, 2.6))
    rows = [ring(*size) for size in sizes]
    knots = [
        (above[j], below[to % 18])
        for k, (above, below) in enumerate(pairwise(rows))
        for j in range(k % 2, 18, 2)
        for to in (j - 1, j + 1)
    ]
    upper, lower = np.swapaxes(knots, 0, 1)
    net = rods(upper, lower, 0.007)
    board = box((0, 3.4, 0.42), (1.8, 1.05, 0.04))
    post = joined([tube((0, 0, 1.3), (0, 3.2, 1.3), (0.08, 0.08)),
                   tube((0, 3.2, 1.3), (0, 3.2, 0.42), (0.05, 0.05)),
                   tube((0, 3.05, 0.42), (0, 3.05, 0.23), (0.03, 0.03))])  # fmt: skip
    parts = [
        Part(wire(rows[0], 0.011), material(rng, "metal")),
        Part(net, material(rng, "paint")),
        Part(board, material(rng, str(rng.choice(["paint", "poster", "glass"])))),
        Part(post, material(rng, "metal")),
    ]
    if rng.random() < 0.5:
        parts += placed(ball(rng), (rng.normal(0, 0.1), rng.uniform(2.5, 3.2), rng.normal(0, 0.1)))
    return parts


def _near(
    rng: Generator, base: Scene, parts: Parts, subject: Array, held: tuple[float, Carrier]
) -> Scene:
    """Return a scene with parts around its middle and the camera so far away from the subject."""
    away, carrier = held
    aside = 0.0 if carrier.aim is Aim.SUBJECT else away
    yaw = rng.uniform(0, 2 * np.pi)
    at = subject + away * np.array([np.sin(yaw), 0, np.cos(yaw)])
    low = np.where([True, False, True], at - 0.1 * away - aside, 0)
    high = np.where([True, False, True], at + 0.1 * away + aside, 2)
    return replace(
        base,
        parts=base.parts + parts,
        eyes=(low, high),
        carriers=((1.0, carrier),),
        subject=subject,
        nearest=0.09,
        variety=4,
        road=0.0,
    )
