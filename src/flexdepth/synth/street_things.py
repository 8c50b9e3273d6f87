"""What streets and parks are furnished with. Every function returns parts on y = 0."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.bystanders import seated
from flexdepth.synth.materials import Part, fitted, glowing, material
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.shapes import box, cushion, joined, leaves_at, quad, revolved, rods, tube, wire
from flexdepth.synth.trees import foliage


def lamp_post(rng: Generator, lit: bool) -> tuple[Parts, tuple[float, float, float]]:
    """Return a street lamp whose arm points along x, and where its light is."""
    height, reach = rng.uniform((3.0, 0.0), (8.0, 2.0))
    share = np.linspace(0, 1, 6)
    arm = np.stack([reach * share, height + 0.3 * np.sin(2.5 * share), 0 * share], 1)
    post = joined([tube((0, 0, 0), (0, height, 0), (0.09, 0.05)), wire(arm, 0.035)])
    head = (reach + 0.1, float(arm[-1, 1]) - 0.08, 0.0)
    shade = cushion(head, (0.55, 0.14, 0.24), 0.4) if reach > 0.4 else cushion(head, (0.4,) * 3, 1)
    bulb = glowing(rng, "plain", 12.0) if lit else material(rng, "paint")
    parts = [Part(post, material(rng, "metal")), Part(shade, bulb)]
    return parts, (head[0], head[1] - 0.2, head[2])


def bench(rng: Generator) -> Parts:
    """A park bench along x, its back at +z, at times with somebody on it."""
    length = rng.uniform(1.2, 2.2)
    slats = [box((0, 0.45, z), (length, 0.03, 0.09)) for z in (-0.18, -0.06, 0.06, 0.18)]
    slats += [box((0, y, 0.26 + 0.2 * (y - 0.5)), (length, 0.09, 0.03)) for y in (0.6, 0.73, 0.86)]
    legs = [
        wire([(x, 0, z), (x, 0.44, z), (x, 0.44, 0.24), (x, 0.9, 0.34)], 0.02)
        for x in (-0.42 * length, 0.42 * length)
        for z in (-0.2, 0.22)
    ]
    parts = [Part(joined(slats), material(rng, "wood")), Part(joined(legs), material(rng, "metal"))]
    if rng.random() < 0.35:
        x = float(rng.uniform(-0.3, 0.3)) * length
        parts += placed(seated(rng, 0.465), (x, 0, 0.05), float(rng.normal(0, 0.15)))
    return parts


def bin_(rng: Generator) -> Parts:
    """A litter bin, or a dustbin on wheels."""
    look = material(rng, str(rng.choice(["metal", "thing", "tyre"])))
    if rng.random() < 0.5:
        radius, tall = rng.uniform((0.18, 0.6), (0.3, 1.0))
        outline = [(radius, 0.05), (1.1 * radius, tall), (0.9 * radius, tall), (0, 0.8 * tall)]
        return [Part(revolved(outline, 18), look)]
    body = box((0, 0.5, 0), (0.55, 0.9, 0.6))
    return [Part(joined([body, box((0, 0.98, -0.03), (0.6, 0.07, 0.72))]), look)]


def letter_box(rng: Generator) -> Parts:
    """A post box, a hydrant, or a switch cabinet."""
    kind = rng.random()
    if kind < 0.35:
        tall, radius = rng.uniform((1.2, 0.2), (1.6, 0.28))
        profile = [(radius * 1.1, 0), (radius, 0.1), (radius, tall), (1.15 * radius, tall),
                   (0.6 * radius, tall + 0.15), (0, tall + 0.18)]  # fmt: skip
        return [Part(revolved(profile, 20), material(rng, "thing"))]
    size = rng.uniform((0.3, 0.7, 0.25), (1.4, 1.5, 0.5))
    face = box((0, size[1] / 2, 0), size)
    return [Part(face, material(rng, str(rng.choice(["metal", "poster", "cabinet"]))))]


def bollards(rng: Generator) -> Parts:
    """A row of bollards along x, some with a chain between them."""
    count, apart, tall = int(rng.integers(3, 9)), rng.uniform(1.0, 2.2), rng.uniform(0.5, 1.1)
    x = (np.arange(count) - count / 2) * apart
    posts = [tube((at, 0, 0), (at, tall, 0), (0.06, 0.05)) for at in x]
    if rng.random() < 0.5:
        s = np.linspace(0, 1, 7)
        for a in x[:-1]:
            sag = 0.9 * tall - 0.6 * s * (1 - s)
            posts.append(wire(np.stack([a + apart * s, sag, 0 * s], 1), 0.012, 4))
    return [Part(joined(posts), material(rng, str(rng.choice(["metal", "tyre", "rock"]))))]


def bus_stop(rng: Generator) -> Parts:
    """A roof on posts with a bench, mostly panes, and a poster at one end; open towards -z."""
    wide, deep, tall = rng.uniform((2.5, 1.2, 2.3), (4.5, 1.7, 2.6))
    roof = box((0, tall, 0), (wide + 0.3, 0.08, deep + 0.3))
    posts = [
        tube((s * wide / 2, 0, z), (s * wide / 2, tall, z), (0.04, 0.04))
        for s in (-1, 1)
        for z in (-deep / 2, deep / 2)
    ]
    frame = [box((0, y, deep / 2), (wide, 0.05, 0.04)) for y in (0.3, tall - 0.2)]
    poster = box((wide / 2, 1.25, 0), (0.1, 1.8, deep * 0.9))
    panes = [
        quad((-wide / 2, 0.3, deep / 2), (wide, 0, 0), (0, tall - 0.5, 0)),
        quad((-wide / 2, 0.3, -deep / 2), (0, 0, deep), (0, tall - 0.5, 0)),
    ]
    glazing = [Part(joined(panes), material(rng, "pane"))] if rng.random() < 0.8 else []
    return [
        *glazing,
        Part(joined([roof, *posts, *frame]), material(rng, "metal")),
        Part(poster, fitted(rng, "poster", deep, 1.8)),
        Part(box((0, 0.45, deep / 2 - 0.25), (0.7 * wide, 0.05, 0.3)), material(rng, "wood")),
    ]


def hoarding(rng: Generator) -> Parts:
    """A large poster on two posts, turned towards -z."""
    wide, tall, above = rng.uniform((1.5, 1.2, 0.5), (5, 3, 3))
    face = quad((-wide / 2, above, -0.06), (wide, 0, 0), (0, tall, 0))
    board = box((0, above + tall / 2, 0), (wide + 0.1, tall + 0.1, 0.1))
    posts = [tube((s * wide / 3, 0, 0.1), (s * wide / 3, above + tall, 0.1), (0.06, 0.06))
             for s in (-1, 1)]  # fmt: skip
    return [
        Part(face, fitted(rng, "poster", wide, tall)),
        Part(joined([board, *posts]), material(rng, "metal")),
    ]


def hedge(rng: Generator) -> Parts:
    """A clipped hedge along x, ragged with leaves."""
    length, tall, deep = rng.uniform((3, 0.6, 0.4), (14, 2.0, 1.1))
    core = cushion((0, tall / 2, 0), (length, tall, deep), 0.15, 12)
    spots = rng.uniform(-0.5, 0.5, (int(length * tall * 60), 3))
    side = rng.choice(3, len(spots), p=[0.1, 0.3, 0.6])
    rows = np.arange(len(spots))
    spots[rows, side] = 0.5 * np.sign(spots[rows, side])
    ragged = leaves_at(rng, spots * (length, tall, deep) + (0, tall / 2, 0), 0.09)
    return [Part(joined([core, ragged]), foliage(rng))]


def stall(rng: Generator) -> Parts:
    """A market stall or a parasol over a table, with goods."""
    wide, deep, tall = rng.uniform((1.8, 1.2, 2.1), (4, 2.2, 2.7))
    posts = [
        tube((x * wide / 2, 0, z * deep / 2), (x * wide / 2, tall, z * deep / 2), (0.03, 0.03))
        for x in (-1, 1)
        for z in (-1, 1)
    ]
    roof = [
        quad((-wide / 2 - 0.2, tall - 0.2, s * (deep / 2 + 0.3)), (wide + 0.4, 0, 0),
             (0, 0.5, -s * (deep / 2 + 0.3)))
        for s in (-1, 1)
    ]  # fmt: skip
    parts = [
        Part(joined(roof), material(rng, "fabric")),
        Part(joined(posts), material(rng, "metal")),
        Part(box((0, 0.4, 0), (wide * 0.95, 0.8, deep * 0.7)), material(rng, "thing")),
    ]
    for _ in range(int(rng.integers(4, 14))):
        size = rng.uniform(0.12, 0.45, 3)
        x, z = rng.uniform(-0.42, 0.42, 2) * (wide, 0.6 * deep)
        crate = box((x, 0.8 + size[1] / 2, z), size)
        parts.append(Part(crate, material(rng, str(rng.choice(["thing", "autumn", "blossom"])))))
    return parts


def cables(rng: Generator, reach: float, x: float) -> Parts:
    """Telegraph poles in a row along z at the given x, with wires that sag between them."""
    apart, tall = rng.uniform((18, 5), (40, 9))
    z = np.arange(-reach, reach, apart) + rng.uniform(0, apart)
    posts = [tube((x, 0, at), (x, tall, at), (0.13, 0.1)) for at in z]
    posts += [box((x, tall - 0.4, at), (1.6, 0.1, 0.1)) for at in z]
    s = np.linspace(0, 1, 9)
    sag = tall - 0.3 - 2.5 * s * (1 - s)
    lines = np.concatenate(
        [
            np.stack([0 * s + x + out, sag, at + apart * s], 1)[None]
            for at in z[:-1]
            for out in (-0.7, -0.25, 0.25, 0.7)
        ]
    )
    wires = rods(lines[:, :-1].reshape(-1, 3), lines[:, 1:].reshape(-1, 3), 0.012)
    return [Part(joined(posts), material(rng, "bark")), Part(wires, material(rng, "tyre"))]
