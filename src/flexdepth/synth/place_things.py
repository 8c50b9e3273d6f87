"""What parks and squares are known by. Every function returns parts around the origin on y = 0."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.bystanders import bystander, seated
from flexdepth.synth.materials import Part, material
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.shapes import box, draped, joined, revolved, tube, wire


def statue(rng: Generator) -> Parts:
    """Somebody of stone or bronze on a plinth."""
    look = material(rng, str(rng.choice(["rock", "metal"])))
    tall, wide = rng.uniform((0.6, 0.8), (2.5, 2.0))
    figure = [part.mesh.scaled((1.3, 1.3, 1.3)).placed((0, tall, 0)) for part in bystander(rng)]
    plinth = [
        box((0, tall / 2, 0), (wide, tall, wide)),
        box((0, 0.1, 0), (1.3 * wide, 0.2, 1.3 * wide)),
    ]
    return [Part(joined(figure), look), Part(joined(plinth), material(rng, "rock"))]


def fountain(rng: Generator) -> Parts:
    """A round basin with water and a column of bowls."""
    radius, rim = rng.uniform((1.2, 0.3), (4, 0.8))
    basin = [(radius, 0), (radius, rim), (radius - 0.25, rim), (radius - 0.3, 0.1)]
    bowls = [(0.25, 0), (0.2, 1.0), (0.9, 1.3), (0.95, 1.4), (0.12, 1.35), (0.1, 2.0), (0.5, 2.2),
             (0.52, 2.28), (0, 2.25)]  # fmt: skip
    pool = revolved([(radius - 0.2, 0.75 * rim), (0, 0.75 * rim)], 24)
    return [
        Part(joined([revolved(basin, 28), revolved(bowls, 16)]), material(rng, "rock")),
        Part(pool, material(rng, "lake")),
    ]


def playground(rng: Generator) -> Parts:
    """A swing, a slide or a climbing frame."""
    look = material(rng, str(rng.choice(["thing", "metal", "paint", "wood"])))
    kind = rng.random()
    if kind < 0.4:
        wide, tall = rng.uniform((2.5, 2.0), (4, 2.6))
        bars = [tube((-wide / 2, tall, 0), (wide / 2, tall, 0), (0.05, 0.05))]
        bars += [tube((s * wide / 2, tall, 0), (s * wide / 2, 0, z), (0.045, 0.045))
                 for s in (-1, 1) for z in (-0.8, 0.8)]  # fmt: skip
        seats = []
        for x in (-wide / 4, wide / 4):
            swing = rng.normal(0, 0.3)
            bars += [wire([(x + s, tall, 0), (x + s, 0.5, swing)], 0.01) for s in (-0.2, 0.2)]
            seats.append(box((x, 0.5, swing), (0.45, 0.04, 0.2)))
        return [Part(joined(bars), look), Part(joined(seats), material(rng, "tyre"))]
    if kind < 0.7:
        s = np.linspace(0, 1, 8)
        chute = [
            np.stack([0 * s + x, 1.6 * (1 - s) ** 1.3 + 0.25, 2.6 * s], 1) for x in (-0.25, 0.25)
        ]
        steps = [box((0, 0.25 + 0.27 * k, -0.9 + 0.16 * k), (0.5, 0.04, 0.15)) for k in range(6)]
        rails = [tube((x, 0, -1.0), (x, 2.2, 0), (0.03, 0.03)) for x in (-0.28, 0.28)]
        return [
            Part(draped(np.stack(chute)), look),
            Part(joined([*steps, *rails]), material(rng, "metal")),
        ]
    ticks = np.arange(-1.2, 1.3, 0.6)
    frame = [tube((x, 0, z), (x, 2.2, z), (0.025, 0.025), 6) for x in ticks for z in ticks[::2]]
    frame += [
        tube((-1.2, y, z), (1.2, y, z), (0.025, 0.025), 6)
        for y in (0.7, 1.4, 2.1)
        for z in ticks[::2]
    ]
    frame += [
        tube((x, y, -1.2), (x, y, 1.2), (0.025, 0.025), 6) for y in (0.7, 1.4, 2.1) for x in ticks
    ]
    return [Part(joined(frame), look)]


def cafe(rng: Generator) -> Parts:
    """A table with chairs, some taken, under a parasol."""
    table = revolved(
        [(0.25, 0), (0.03, 0.04), (0.03, 0.7), (0.38, 0.7), (0.38, 0.74), (0, 0.74)], 16
    )
    chairs, guests = [], []
    for yaw in rng.uniform(0, 6.3) + np.arange(int(rng.integers(2, 5))) * 1.7:
        seat = [box((0, 0.45, 0), (0.42, 0.03, 0.42)), box((0, 0.72, 0.2), (0.42, 0.35, 0.03))]
        seat += [tube((x, 0, z), (x, 0.45, z), (0.015, 0.015), 5) for x in (-0.18, 0.18)
                 for z in (-0.18, 0.18)]  # fmt: skip
        out = np.array([np.sin(yaw), 0, np.cos(yaw)]) * rng.uniform(0.6, 0.9)
        chairs.append(joined(seat).placed(out, yaw))
        if rng.random() < 0.25:
            guests += placed(seated(rng, 0.465), (float(out[0]), 0, float(out[2])), float(yaw))
    parts = [
        Part(table, material(rng, "metal")),
        Part(joined(chairs), material(rng, "wood")),
        *guests,
    ]
    if rng.random() < 0.6:
        roof = revolved([(1.4, 2.1), (0.7, 2.4), (0, 2.6)], int(rng.choice([4, 8, 20])))
        parts += [
            Part(roof, material(rng, "fabric")),
            Part(tube((0, 0, 0), (0, 2.5, 0), (0.02, 0.02)), parts[0].material),
        ]
    return parts


def colonnade(rng: Generator) -> Parts:
    """Arcades along x: columns, arches and a roof, a wall behind."""
    bays, pitch, tall = int(rng.integers(3, 9)), rng.uniform(2.2, 4.5), rng.uniform(3, 6)
    deep, thick = rng.uniform(2.5, 4.5), rng.uniform(0.14, 0.35)
    x = (np.arange(bays + 1) - bays / 2) * pitch
    profile = [(1.5, 0), (1.5, 0.2), (1, 0.3), (0.85, tall - 0.3), (1.5, tall - 0.15), (1.5, tall)]
    column = revolved([(thick * out, y) for out, y in profile], 14)
    stone = [column.placed((at, 0, 0)) for at in x]
    angle = np.linspace(0, np.pi, 13)
    if rng.random() < 0.6:
        for at in x[:-1] + pitch / 2:
            half = pitch / 2 - thick
            arc = np.stack([half * np.cos(angle), tall + half * np.sin(angle)], 1)
            top = np.stack([half * np.cos(angle), np.full(13, tall + pitch / 2)], 1)
            rows = [np.insert(line, 2, z, axis=1) for line in (top, arc) for z in (-thick,)]
            under_arch = np.insert(arc, 2, thick, axis=1)
            stone.append(draped(np.stack([*rows, under_arch]) + np.array([at, 0, 0])))
        tall += pitch / 2
    roof = box((0, tall + 0.3, deep / 2), (bays * pitch + 1, 0.6, deep + 1))
    wall = box((0, tall / 2, deep), (bays * pitch, tall, 0.2))
    return [
        Part(joined([*stone, roof]), material(rng, str(rng.choice(["rock", "paint", "wall"])))),
        Part(wall, material(rng, "brickwork")),
    ]


def steps(rng: Generator) -> Parts:
    """A flight of steps outside that leads up to a terrace."""
    count, wide = int(rng.integers(4, 16)), rng.uniform(2, 12)
    tread, rise = rng.uniform((0.28, 0.13), (0.4, 0.18))
    flight = [
        box((0, rise * (k + 0.5), tread * k), (wide, rise * 1.02, tread * 1.2))
        for k in range(count)
    ]
    end = tread * count
    flight.append(box((0, rise * count / 2, end + 2), (wide + 4, rise * count, 4)))
    rails = []
    if rng.random() < 0.6:
        for x in (-wide / 2, 0, wide / 2):
            line = [(x, 0, 0), (x, 0.9, 0), (x, rise * count + 0.9, end), (x, rise * count, end)]
            rails.append(wire(line, 0.025))
    parts = [Part(joined(flight), material(rng, str(rng.choice(["pavement", "rock"]))))]
    return [*parts, Part(joined(rails), material(rng, "metal"))] if rails else parts
