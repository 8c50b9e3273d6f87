"""Lamps, plants, pipes, textiles that hang, and what else is in rooms."""

from math import pi

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Part, fitted, glowing, material, shown
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import (
    Mesh,
    blob,
    box,
    curtain,
    cushion,
    joined,
    leaves,
    prism,
    quad,
    revolved,
    tube,
)
from flexdepth.synth.skins import skin
from flexdepth.synth.small_things import vessel


def lamp(rng: Generator) -> Parts:
    """A standing lamp with a glowing shade."""
    height, radius = rng.uniform((1.1, 0.1), (1.8, 0.25))
    shade = revolved([(radius, height - 0.3), (radius * rng.uniform(0.5, 1), height)], 28)
    stand = joined(
        [
            tube((0, 0, 0), (0, height - 0.15, 0), (0.015, 0.012)),
            revolved([(0, 0.03), (0.15, 0.02), (0.15, 0)]),
        ]
    )
    return [
        Part(shade, glowing(rng, "plain", rng.uniform(0.5, 2))),
        Part(stand, material(rng, "metal")),
    ]


def plant(rng: Generator) -> Parts:
    """A plant in a pot."""
    pot, crown = rng.uniform((0.15, 0.3), (0.4, 1.2))
    foliage = leaves(
        rng, (crown, crown, crown), int(rng.integers(150, 500)), rng.uniform(0.08, 0.2) * crown
    )
    stem = tube((0, 0.05, 0), (0, pot + 0.4 * crown, 0), (0.015, 0.01))
    return [
        *vessel(rng, pot),
        Part(foliage.placed((0, pot + 0.55 * crown, 0)), material(rng, "leaf")),
        Part(stem, material(rng, "bark")),
    ]


def ball(rng: Generator) -> Parts:
    """A ball, a bean bag or a lumpy bag."""
    size = rng.uniform(0.15, 0.8)
    shape = blob(rng, (size, size * rng.uniform(0.5, 1), size), rng.choice([0.0, 0.06, 0.15]), 16)
    return [Part(shape.placed((0, size * 0.4, 0)), material(rng, "fabric"))]


def drape(rng: Generator) -> Parts:
    """A curtain that hangs to the floor."""
    width, height = rng.uniform((0.4, 1.6), (1.6, 2.4))
    return [Part(curtain(rng, width, height, rng.uniform(0.02, 0.07)), material(rng, "fabric"))]


def boiler(rng: Generator) -> Parts:
    """A tank or a washing machine with pipes that rise from it."""
    height, radius = rng.uniform((0.8, 0.2), (1.8, 0.4))
    look = material(rng, str(rng.choice(["paint", "metal"])))
    if rng.random() < 0.5:
        body = revolved([(0, height), (0.8 * radius, height), (radius, 0.9 * height), (radius, 0)])
    else:
        body = box((0, height / 2, 0), (2 * radius, height, 2 * radius))
    bore = rng.uniform(0.012, 0.05)
    pipes = [
        tube((x, height - 0.1, 0.1), (x, rng.uniform(1.9, 2.4), 0.1), (bore, bore))
        for x in rng.uniform(-0.8, 0.8, int(rng.integers(1, 5))) * radius
    ]
    return [Part(body, look), Part(joined(pipes), material(rng, "metal"))]


def washing(rng: Generator) -> Parts:
    """Clothes on a line or a rail."""
    width, height = rng.uniform((0.6, 1.3), (2.0, 1.9))
    parts = [
        Part(
            tube((-width / 2, height, 0), (width / 2, height, 0), (0.012, 0.012)),
            material(rng, "metal"),
        )
    ]
    x = -width / 2
    while x < width / 2 - 0.2:
        wide, long = rng.uniform((0.2, 0.4), (0.6, 1.1))
        cloth = curtain(rng, wide, long, rng.uniform(0.01, 0.05))
        parts.append(Part(cloth.placed((x, height - long, 0)), material(rng, "fabric")))
        x += wide + rng.exponential(0.08)
    return parts


def toy_house(rng: Generator) -> Parts:
    """A wedge or a gabled block: something with slanted sides."""
    size = rng.uniform(0.2, 0.9, 3)
    gable = [
        (-0.5, 0),
        (0.5, 0),
        (0.5, rng.uniform(0.2, 0.9)),
        (rng.uniform(-0.3, 0.3), 1),
        (-0.5, rng.uniform(0.2, 0.9)),
    ]
    return [Part(prism(gable, 1.0).scaled(size), material(rng, "thing"))]


def _hoop(centre: tuple[float, float, float], radius: float, bore: float) -> Mesh:
    """Return a ring that stands in the xy plane."""
    angle = np.linspace(0, 2 * pi, 29)
    middle = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], 1)
    return skin(middle + np.asarray(centre), (0, 0, 1), np.full((29, 2), bore), 8)


def bicycle(rng: Generator) -> Parts:
    """A bicycle that leans or stands, seen from its side."""
    radius = rng.uniform(0.28, 0.34)
    hubs = np.array([[-0.52, radius, 0], [0.52, radius, 0]])
    seat, head, crank = np.array([[-0.22, 0.86, 0], [0.36, 0.82, 0], [-0.08, 0.3, 0]])
    bars = [
        (hubs[0], seat),
        (hubs[0], crank),
        (crank, seat),
        (seat, head),
        (crank, head),
        (head, hubs[1]),
    ]
    frame = [tube(a, b, (0.016, 0.016)) for a, b in bars]
    handle = skin(
        [(0.3, 0.98, -0.28), (0.38, 0.98, -0.1), (0.37, 0.97, 0.1), (0.3, 0.98, 0.28)],
        (0, 1, 0), np.full((4, 2), 0.014), 6,
    )  # fmt: skip
    frame += [tube(head, (0.37, 0.97, 0), (0.014, 0.014)), handle]
    spokes = [
        tube(hub, hub + radius * np.array([np.cos(a), np.sin(a), 0]), (0.0018, 0.0018), 4)
        for hub in hubs
        for a in 2 * pi * np.arange(14) / 14
    ]
    tyres = [_hoop(tuple(hub), radius, 0.018) for hub in hubs]
    saddle = cushion((-0.24, 0.92, 0), (0.26, 0.07, 0.15), 0.6)
    return [
        Part(joined(frame), material(rng, "plastic")),
        Part(joined([*tyres, saddle]), material(rng, "tyre")),
        Part(joined(spokes), material(rng, "metal")),
    ]


def coats(rng: Generator) -> Parts:
    """Coats and bags on hooks, or on a stand."""
    width = rng.uniform(0.3, 1.3)
    rail = box((0, 1.7, 0), (width, 0.08, 0.02))
    parts = [Part(rail, material(rng, "wood"))]
    for x in np.arange(-width / 2 + 0.1, width / 2, rng.uniform(0.18, 0.3)):
        if rng.random() < 0.2:
            continue
        long, wide = rng.uniform((0.3, 0.22), (1.1, 0.42))
        v = np.linspace(0, 1, 9)
        line = np.stack([x + 0.02 * np.sin(4 * v), 1.68 - long * v, -0.05 - 0.06 * np.sqrt(v)], 1)
        girth = wide / 2 * np.clip(0.25 + 1.1 * v**0.6, 0, 1) * (1 + 0.1 * rng.normal(size=9))
        thick = 0.05 + 0.05 * np.sin(pi * v) + 0.01 * rng.normal(size=9)
        parts.append(
            Part(skin(line, (1, 0, 0), np.stack([girth, thick], 1), 14), material(rng, "fabric"))
        )
    return parts


def bag(rng: Generator) -> Parts:
    """A rucksack, a handbag or a bin bag, with handles."""
    size = rng.uniform((0.24, 0.22, 0.14), (0.5, 0.45, 0.32))
    body = blob(rng, size * (1, 1.05, 1), rng.uniform(0.03, 0.12), 18).placed(
        (0, 0.48 * size[1], 0)
    )
    angle = np.linspace(0, pi, 9)
    loop = np.stack(
        [0.25 * size[0] * np.cos(angle), 0.9 * size[1] + 0.15 * np.sin(angle), 0 * angle], 1
    )
    strap = skin(loop, (0, 0, 1), np.full((9, 2), 0.01), 6)
    look = material(rng, str(rng.choice(["fabric", "leather", "plastic"])))
    return [Part(body, look), Part(strap, material(rng, "leather"))]


def radiator(rng: Generator) -> Parts:
    """A ribbed radiator with its pipe."""
    width, height = rng.uniform((0.5, 0.35), (1.6, 0.75))
    ribs = [
        cushion((x, 0.12 + height / 2, -0.05), (0.05, height, 0.1), 0.4, 8)
        for x in np.arange(-width / 2, width / 2, 0.062)
    ]
    pipe = tube((width / 2, 0.2, -0.05), (width / 2 + 0.1, 0, -0.03), (0.01, 0.01))
    return [Part(joined([*ribs, pipe]), material(rng, "paint"))]


def mirror(rng: Generator) -> Parts:
    """A tall mirror in a frame, leaning or hung."""
    wide, tall = rng.uniform((0.4, 0.8), (1.2, 1.9))
    base = rng.uniform(0, 0.6)
    pane = quad((-wide / 2, base, -0.03), (wide, 0, 0), (0, tall, 0))
    board = box((0, base + tall / 2, -0.012), (wide + 0.08, tall + 0.08, 0.024))
    return [Part(pane, material(rng, "mirror")), Part(board, material(rng, "wood"))]


def television(rng: Generator) -> Parts:
    """A low board with a television, lit or dark."""
    wide = rng.uniform(0.7, 1.5)
    tall, base = 0.57 * wide, rng.uniform(0.35, 0.6)
    chest = box((0, base / 2, 0), (wide * rng.uniform(1, 1.4), base, 0.42))
    face = quad((wide / 2 - 0.015, base + 0.065, -0.021), (0.03 - wide, 0, 0), (0, tall - 0.03, 0))
    case = [
        box((0, base + 0.05 + tall / 2, 0), (wide, tall, 0.04)),
        box((0, base + 0.03, 0), (0.3, 0.06, 0.2)),
    ]
    name = str(rng.choice(["landscape", "portrait", "facade", "interior", "photograph", "petals"]))
    lit = shown(name, (wide - 0.03, tall - 0.03), float(rng.uniform(0.5, 2)))
    return [
        Part(chest, fitted(rng, "cabinet", wide / 2, base)),
        Part(joined(case), material(rng, "plastic")),
        Part(face, lit if rng.random() < 0.6 else material(rng, "glass")),
    ]


def board(rng: Generator) -> Parts:
    """A notice board or a whiteboard with sheets pinned to it."""
    wide, tall = rng.uniform((0.7, 0.5), (2.0, 1.2))
    base = rng.uniform(0.9, 1.2)
    parts = [
        Part(
            box((0, base + tall / 2, -0.01), (wide, tall, 0.02)),
            material(rng, str(rng.choice(["paint", "wood", "fabric"]))),
        )
    ]
    for _ in range(int(rng.integers(3, 16))):
        w, h = rng.uniform((0.1, 0.12), (0.32, 0.4))
        x = rng.uniform(-wide / 2, wide / 2 - w)
        y = base + rng.uniform(0, max(tall - h, 0.01))
        pinned = quad((x, y, -0.022 - 0.003 * rng.random()), (w, 0, 0), (0, h, 0))
        parts.append(
            Part(pinned, fitted(rng, str(rng.choice(["paper", "picture", "packet"])), w, h))
        )
    return parts
