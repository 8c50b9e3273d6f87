"""Things that stand in rooms. Every function returns parts around the origin, standing on y = 0."""

from collections.abc import Callable
from math import pi

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Material, Part, fitted, glowing, material
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
    turn,
)

Parts = list[Part]


def placed(parts: Parts, at: tuple[float, float, float], yaw: float = 0.0) -> Parts:
    """Return the parts turned about the vertical axis and moved."""
    return [Part(part.mesh.placed(at, yaw), part.material) for part in parts]


def _legs(width: float, depth: float, height: float, thickness: float) -> Mesh:
    x, z = width / 2 - thickness, depth / 2 - thickness
    legs = [
        box((i * x, height / 2, j * z), (thickness, height, thickness))
        for i in (-1, 1)
        for j in (-1, 1)
    ]
    return joined(legs)


def vessel(rng: Generator, height: float) -> Parts:
    """A vase, bottle, cup or bowl: a random surface of revolution."""
    steps = np.linspace(0, 1, 12)
    knots = rng.uniform(0.2, 1, 5)
    radius = np.interp(steps, np.linspace(0, 1, 5), knots) * height * rng.uniform(0.2, 0.6)
    profile = np.stack([np.r_[0, radius], np.r_[0, steps * height]], 1)
    return [Part(revolved(profile, 18), material(rng, "thing"))]


def clutter(rng: Generator, width: float, depth: float, count: int, tallest: float = 0.35) -> Parts:
    """Small things on a surface of the given size at y = 0, none taller than `tallest`."""
    parts: Parts = []
    for _ in range(count):
        at = (rng.uniform(-0.45, 0.45) * width, 0.0, rng.uniform(-0.45, 0.45) * depth)
        yaw = float(rng.normal(0, 0.5))
        kind = rng.random()
        if kind < 0.4:
            size = rng.uniform((0.04, 0.02, 0.04), (0.3, tallest, 0.25))
            thing = [Part(box((0, size[1] / 2, 0), size), material(rng, "thing"))]
        elif kind < 0.75:
            thing = vessel(rng, float(rng.uniform(0.06, tallest)))
        elif kind < 0.85:
            thing = [
                Part(blob(rng, (0.12, 0.1, 0.12), 0.1).placed((0, 0.05, 0)), material(rng, "thing"))
            ]
        else:
            thing = screen(rng, float(min(0.6, tallest * rng.uniform(0.8, 1.4))))
        parts += placed(thing, at, yaw)
    return parts


def screen(rng: Generator, width: float) -> Parts:
    """A monitor or a laptop, lit or dark."""
    height = 0.6 * width
    body = joined(
        [
            box((0, height / 2 + 0.08, 0.012), (width, height, 0.02)),
            box((0, 0.04, 0.03), (0.04, 0.08, 0.03)),
            box((0, 0.005, 0), (0.4 * width, 0.01, 0.15)),
        ]
    )
    face = quad((-width / 2 + 0.01, 0.09, -0.001), (width - 0.02, 0, 0), (0, height - 0.02, 0))
    lit = (
        glowing(rng, "collage", rng.uniform(0.2, 1))
        if rng.random() < 0.5
        else material(rng, "glass")
    )
    return [Part(body, material(rng, "metal")), Part(face, lit)]


def table(rng: Generator) -> Parts:
    """A table or desk with things on it."""
    width, depth, height = rng.uniform((0.6, 0.5, 0.4), (2.0, 1.0, 0.8))
    look = material(rng, "wood")
    if rng.random() < 0.25:
        top = revolved(
            [
                (0, height),
                (depth / 2, height),
                (depth / 2, height - 0.03),
                (0.04, height - 0.04),
                (0.04, 0),
                (0.2, 0),
            ]
        )
        parts = [Part(top, look)]
        width = depth = 0.7 * depth
    else:
        top = box((0, height - 0.02, 0), (width, 0.04, depth))
        parts = [
            Part(top, look),
            Part(_legs(width, depth, height - 0.04, rng.uniform(0.03, 0.07)), look),
        ]
    return parts + placed(clutter(rng, width, depth, int(rng.integers(0, 10))), (0, height, 0))


def chair(rng: Generator) -> Parts:
    """A chair, with legs or on a column."""
    seat, width, back = rng.uniform((0.4, 0.38, 0.35), (0.5, 0.55, 0.65))
    cloth, frame = material(rng, "fabric"), material(rng, str(rng.choice(["wood", "metal"])))
    thick = rng.uniform(0.02, 0.09)
    soft = cushion if rng.random() < 0.5 else box
    body = [
        soft((0, seat, 0), (width, thick, width)),
        soft((0, seat + 0.1 + back / 2, width / 2), (width, back, thick)),
    ]
    if rng.random() < 0.65:
        stand = _legs(width, width, seat, rng.uniform(0.02, 0.045))
    else:
        spokes = [
            tube((0, 0.06, 0), (0.28 * np.cos(a), 0.04, 0.28 * np.sin(a)), (0.02, 0.02))
            for a in 2 * pi * np.arange(5) / 5
        ]
        stand = joined([tube((0, 0.06, 0), (0, seat, 0), (0.025, 0.025)), *spokes])
    posts = joined(
        [
            tube(
                (x * width / 2, seat, width / 2),
                (x * width / 2, seat + 0.2, width / 2),
                (0.015, 0.015),
            )
            for x in (-0.8, 0.8)
        ]
    )
    return [Part(joined(body), cloth), Part(joined([stand, posts]), frame)]


def shelf(rng: Generator) -> Parts:
    """An open shelf with books and things."""
    width, height, depth = rng.uniform((0.5, 0.8, 0.22), (1.6, 2.2, 0.4))
    levels = int(rng.integers(2, 7))
    pitch = height / levels
    boards = [box((0, k * pitch, 0), (width, 0.025, depth)) for k in range(levels + 1)]
    sides = [box((s * width / 2, height / 2, 0), (0.025, height, depth)) for s in (-1, 1)]
    back = box((0, height / 2, depth / 2), (width, height, 0.01))
    parts = [Part(joined(boards + sides + [back]), material(rng, "wood"))]
    for k in range(levels):
        if rng.random() < 0.6:
            parts += placed(_books(rng, width, 0.85 * pitch, depth), (0, k * pitch + 0.012, 0))
        else:
            count = int(rng.integers(0, 6))
            parts += placed(
                clutter(rng, width, 0.5 * depth, count, 0.7 * pitch), (0, k * pitch + 0.012, 0)
            )
    return parts


def _books(rng: Generator, width: float, height: float, depth: float) -> Parts:
    looks = [material(rng, "thing") for _ in range(6)]
    x = -width / 2 + 0.03
    books: list[list[Mesh]] = [[] for _ in looks]
    while x < width / 2 - 0.08:
        w, h, d = rng.uniform((0.015, 0.5, 0.5), (0.06, 1, 0.9)) * (1, height, depth)
        lean = turn(0) if rng.random() < 0.9 else turn(0.2)
        books[int(rng.integers(6))].append(
            box((x + w / 2, h / 2, depth / 2 - d / 2 - 0.02), (w, h, d)).turned(lean)
        )
        x += w + 0.002 + (rng.exponential(0.2) if rng.random() < 0.08 else 0)
    return [Part(joined(meshes), look) for meshes, look in zip(books, looks, strict=True) if meshes]


def sofa(rng: Generator) -> Parts:
    """A sofa or an armchair with cushions."""
    width, depth, seat = rng.uniform((0.7, 0.75, 0.35), (2.4, 1.0, 0.5))
    cloth = material(rng, "fabric")
    body = [
        cushion((0, seat / 2, 0), (width, seat, depth), 0.2),
        cushion((0, seat * 0.95, depth * 0.42), (width, seat * 0.95, 0.25), 0.3),
        cushion((0, seat, -0.08), (width * 0.85, 0.18, depth * 0.8), 0.3),
    ]
    body += [
        cushion((s * width / 2, seat * 0.7, 0), (0.2, seat * 0.8, depth), 0.3) for s in (-1, 1)
    ]
    parts = [Part(joined(body), cloth)]
    for _ in range(int(rng.integers(0, 4))):
        pillow = cushion((0, 0.2, 0), (0.42, 0.38, 0.14), 0.6).placed(
            (rng.uniform(-0.4, 0.4) * width, seat + 0.03, 0.2), rng.normal(0, 0.4)
        )
        parts.append(Part(pillow, material(rng, "fabric")))
    return parts


def bed(rng: Generator) -> Parts:
    """A bed with a headboard, a blanket and pillows."""
    width, length, height = rng.uniform((0.9, 1.9, 0.35), (1.8, 2.15, 0.6))
    parts = [
        Part(box((0, height / 2 - 0.1, 0), (width, height - 0.15, length)), material(rng, "wood")),
        Part(cushion((0, height, 0), (width, 0.22, length), 0.25), material(rng, "fabric")),
        Part(
            cushion((0, height + 0.05, -0.3), (width * 1.06, 0.24, length * 0.7), 0.3),
            material(rng, "fabric"),
        ),
        Part(
            box((0, height * 0.9, length / 2), (width, height * 1.8, 0.06)), material(rng, "wood")
        ),
    ]
    pillows = [
        cushion((s * width / 4, height + 0.16, length / 2 - 0.28), (width * 0.42, 0.15, 0.4), 0.6)
        for s in (-1, 1)
    ]
    return [*parts, Part(joined(pillows), material(rng, "fabric"))]


def cabinet(rng: Generator) -> Parts:
    """A wardrobe, chest, fridge or box, with doors on its front."""
    width, height, depth = rng.uniform((0.35, 0.4, 0.35), (1.4, 2.2, 0.7))
    look = fitted(rng, "cabinet", width, height)
    body = Part(box((0, height / 2, 0), (width, height, depth)), look)
    return [body, *placed(clutter(rng, width, depth, int(rng.integers(0, 5))), (0, height, 0))]


def kitchen(rng: Generator) -> Parts:
    """A counter with a worktop, things on it and cupboards above."""
    width, depth, height = rng.uniform((1.2, 0.5, 0.8), (3.2, 0.7, 0.95))
    front = fitted(rng, "cabinet", width / max(1, round(width / 0.6)), height)
    top = material(rng, str(rng.choice(["wood", "metal", "paint"])))
    parts = [
        Part(box((0, height / 2, 0), (width, height, depth)), front),
        Part(box((0, height + 0.02, -0.02), (width, 0.04, depth + 0.04)), top),
        *placed(clutter(rng, width, depth, int(rng.integers(3, 16)), 0.45), (0, height + 0.04, 0)),
    ]
    if rng.random() < 0.7:
        base, tall = height + rng.uniform(0.45, 0.6), rng.uniform(0.4, 0.8)
        upper = box(
            (0, base + tall / 2, depth / 2 - 0.16), (width * rng.uniform(0.4, 1), tall, 0.32)
        )
        parts.append(Part(upper, front))
    if rng.random() < 0.5:
        parts.append(
            Part(box((width / 2 + 0.32, 0.9, 0), (0.6, 1.8, 0.62)), material(rng, "metal"))
        )
    return parts


def lamp(rng: Generator) -> Parts:
    """A standing lamp with a glowing shade."""
    height, radius = rng.uniform((1.1, 0.1), (1.8, 0.25))
    shade = revolved([(radius, height - 0.3), (radius * rng.uniform(0.5, 1), height)])
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
    stem = tube((0, pot, 0), (0, pot + 0.4 * crown, 0), (0.015, 0.01))
    return [
        *vessel(rng, pot),
        Part(foliage.placed((0, pot + 0.55 * crown, 0)), material(rng, "leaf")),
        Part(stem, material(rng, "bark")),
    ]


def stack(rng: Generator) -> Parts:
    """A pile of boxes."""
    parts: Parts = []
    floor = 0.0
    size = rng.uniform(0.25, 0.7, 3)
    for _ in range(int(rng.integers(1, 5))):
        yaw = float(rng.normal(0, 0.3))
        block = box((0, size[1] / 2, 0), size).placed(
            (rng.normal(0, 0.04), floor, rng.normal(0, 0.04)), yaw
        )
        parts.append(Part(block, material(rng, str(rng.choice(["thing", "wood"])))))
        floor += size[1]
        size = size * rng.uniform(0.6, 1, 3)
    return parts


def ball(rng: Generator) -> Parts:
    """A ball, a bean bag or a lumpy bag."""
    size = rng.uniform(0.15, 0.8)
    shape = blob(rng, (size, size * rng.uniform(0.5, 1), size), rng.choice([0.0, 0.06, 0.15]), 16)
    return [Part(shape.placed((0, size * 0.4, 0)), material(rng, "fabric"))]


def person(rng: Generator) -> Parts:
    """Somebody who stands or walks."""
    height = rng.uniform(1.2, 1.95)
    stride, swing = rng.normal(0, 0.18, 2)
    hip, shoulder, head = 0.5 * height, 0.82 * height, 0.93 * height
    girth = rng.uniform(0.16, 0.26)

    def limb(side: float, top: float, bottom: float, reach: float, radius: float) -> Mesh:
        knee = (side, (top + bottom) / 2, reach * 0.4 - 0.04)
        lower = tube(knee, (side * 1.05, bottom, reach), (radius * 0.85, radius * 0.6))
        return joined([tube((side, top, 0), knee, (radius, radius * 0.85)), lower])

    legs = [limb(s * 0.1, hip, 0.05, s * stride, 0.075) for s in (-1, 1)]
    arms = [limb(s * (girth + 0.04), shoulder, 0.46 * height, -s * swing, 0.05) for s in (-1, 1)]
    torso = cushion(
        (0, (hip + shoulder) / 2 + 0.02, 0), (2 * girth, shoulder - hip + 0.14, 0.26), 0.7
    )
    skull = blob(rng, (0.17, 0.25, 0.2), 0.02).placed((0, head, 0))
    hair = blob(rng, (0.19, 0.16, 0.21), 0.05).placed((0, head + 0.06, 0.02))
    return [
        Part(joined(legs), material(rng, "fabric")),
        Part(joined([torso, *arms]), material(rng, "fabric")),
        Part(skull, material(rng, "skin")),
        Part(hair, material(rng, "bark")),
    ]


def stairs(rng: Generator) -> Parts:
    """A flight of stairs, without a rail."""
    width, rise, run = rng.uniform((0.8, 0.15, 0.24), (1.4, 0.2, 0.32))
    count = int(rng.integers(3, 14))
    outline = [(0.0, 0.0)]
    for k in range(count):
        outline += [(k * run, (k + 1) * rise), ((k + 1) * run, (k + 1) * rise)]
    steps = [
        box((0, (k + 1) * rise / 2, (k + 0.5) * run), (width, (k + 1) * rise, run))
        for k in range(count)
    ]
    return [Part(joined(steps), material(rng, str(rng.choice(["wood", "floor", "pavement"]))))]


def drape(rng: Generator) -> Parts:
    """A curtain that hangs to the floor."""
    width, height = rng.uniform((0.4, 1.6), (1.6, 2.4))
    return [Part(curtain(rng, width, height, rng.uniform(0.02, 0.07)), material(rng, "fabric"))]


def heap(rng: Generator) -> Parts:
    """Things piled on the floor: boxes, bags, bottles, cloth, boards that lean."""
    width, depth, height = rng.uniform((0.5, 0.4, 0.2), (1.6, 1.2, 0.9))
    parts = clutter(rng, width, depth, int(rng.integers(5, 25)), height)
    for _ in range(int(rng.integers(0, 4))):
        size = rng.uniform(0.15, 0.6)
        bag = blob(rng, (size, 0.8 * size, size), 0.12).placed(
            (rng.uniform(-0.5, 0.5) * width, 0.3 * size, rng.uniform(-0.5, 0.5) * depth)
        )
        parts.append(Part(bag, material(rng, "fabric")))
    for _ in range(int(rng.integers(0, 4))):
        foot, top = rng.uniform(-0.5, 0.5, 2) * width
        reach = rng.uniform(0.6, 2.0)
        board = tube((foot, 0, -0.2), (top, reach, 0.2), (rng.uniform(0.01, 0.05),) * 2)
        parts.append(Part(board, material(rng, str(rng.choice(["wood", "metal"])))))
    return parts


def rack(rng: Generator) -> Parts:
    """An open rack on posts, crowded with tins, boxes and tools."""
    width, height, depth = rng.uniform((0.6, 1.2, 0.3), (2.0, 2.2, 0.6))
    levels = int(rng.integers(3, 6))
    pitch = height / levels
    boards = [box((0, (k + 0.6) * pitch, 0), (width, 0.02, depth)) for k in range(levels)]
    frame = joined([*boards, _legs(width, depth, height, rng.uniform(0.02, 0.05))])
    parts = [Part(frame, material(rng, str(rng.choice(["metal", "wood"]))))]
    for k in range(levels):
        things = clutter(rng, width, depth, int(rng.integers(2, 12)), 0.8 * pitch)
        parts += placed(things, (0, (k + 0.6) * pitch + 0.01, 0))
    return parts


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


FREE_STANDING: tuple[Callable[[Generator], Parts], ...] = (
    table, table, chair, chair, chair, sofa, lamp, plant, stack, ball, person, toy_house, cabinet,
    heap, washing,
)  # fmt: skip
"""What may stand anywhere in a room; twice what stands there often."""

AGAINST_WALLS: tuple[Callable[[Generator], Parts], ...] = (
    shelf, shelf, sofa, bed, cabinet, cabinet, kitchen, kitchen, table, drape, plant, stairs,
)  # fmt: skip
"""What stands with its back (its +z side) to a wall."""

STORED: tuple[Callable[[Generator], Parts], ...] = (
    heap, heap, heap, rack, rack, stack, stack, boiler, washing, table, cabinet, ball, chair, sofa,
)  # fmt: skip
"""What stands in cellars, sheds and workshops, along the walls as well as anywhere."""

__all__ = ["AGAINST_WALLS", "FREE_STANDING", "STORED", "Material", "Parts", "person", "placed"]
