"""Tables, desks and counters with what lies on them."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.clutter import IN_KITCHENS, ON_DESKS, ON_TABLES, clutter
from flexdepth.synth.devices import keyboard, monitor
from flexdepth.synth.materials import Material, Part, fitted, material
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.seating import legs
from flexdepth.synth.shapes import box, cushion, joined, quad, revolved, tube
from flexdepth.synth.skins import skin


def table(rng: Generator) -> Parts:
    """A table or desk with things on it."""
    width, depth, height = rng.uniform((0.6, 0.5, 0.4), (2.0, 1.0, 0.8))
    if rng.random() < 0.12:
        return _glass_table(rng, (width, depth, height))
    look = material(rng, str(rng.choice(["wood", "wood", "counter"])))
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
            Part(legs(width, depth, height - 0.04, rng.uniform(0.03, 0.11)), look),
        ]
    return parts + placed(
        clutter(rng, (width, depth), int(rng.integers(0, 12)), 0.5, ON_TABLES), (0, height, 0)
    )


def _glass_table(rng: Generator, size: tuple[float, float, float]) -> Parts:
    """Return a table with a top of glass, round or not, some with a shelf below."""
    width, depth, height = size
    pane, frame = material(rng, "pane"), material(rng, str(rng.choice(["metal", "wood"])))
    reach = (width, depth)
    if rng.random() < 0.35:
        edge = [(0, height), (depth / 2, height), (depth / 2, height - 0.012)]
        foot = revolved([(0.05, height - 0.012), (0.03, 0.05), (0.22, 0.02), (0.22, 0)])
        parts = [Part(revolved(edge, 32), pane), Part(foot, frame)]
        reach = (0.7 * depth, 0.7 * depth)
    else:
        top = [quad((-width / 2, height, -depth / 2), (width, 0, 0), (0, 0, depth))]
        top += [
            quad((-width / 2, height - 0.012, s * depth / 2), (width, 0, 0), (0, 0.012, 0))
            for s in (-1, 1)
        ]
        stand = [legs(0.96 * width, 0.94 * depth, height - 0.006, rng.uniform(0.02, 0.06))]
        if rng.random() < 0.4:
            stand.append(box((0, 0.4 * height, 0), (0.9 * width, 0.02, 0.86 * depth)))
        parts = [Part(joined(top), pane), Part(joined(stand), frame)]
    things = clutter(rng, reach, int(rng.integers(0, 10)), 0.5, ON_TABLES)
    return parts + placed(things, (0, height, 0))


def desk(rng: Generator) -> Parts:
    """A desk with screens, keyboards and papers; whoever works there sits before it, at -z."""
    width, depth, height = rng.uniform((1.1, 0.6, 0.68), (2.2, 0.9, 0.78))
    look = material(rng, str(rng.choice(["wood", "counter", "paint"])))
    parts = [
        Part(box((0, height - 0.015, 0), (width, 0.03, depth)), look),
        Part(legs(width, depth, height - 0.03, 0.05), material(rng, "metal")),
    ]
    if rng.random() < 0.6:
        chest = box((0.35 * width, (height - 0.05) / 2, 0), (0.42, height - 0.05, depth * 0.9))
        parts.append(Part(chest, fitted(rng, "cabinet", 0.42, height)))
    x = rng.uniform(-0.2, 0.2) * width
    for k in range(int(rng.integers(0, 4))):
        at = (x + (k - 1) * rng.uniform(0.4, 0.6), height, rng.uniform(0.1, 0.3) * depth)
        parts += placed(monitor(rng), at, float(rng.normal(0, 0.2)))
    parts += placed(keyboard(rng), (x, height, -0.25 * depth), float(rng.normal(0, 0.1)))
    count = int(rng.integers(2, 16))
    return parts + placed(clutter(rng, (width, depth), count, 0.4, ON_DESKS), (0, height, 0))


def _tap(rng: Generator, height: float) -> Parts:
    metal = Material("plain", np.full((3, 3), 0.3), (1.0, 1.0), 0.0, 0.6, 0.05)
    rise = rng.uniform(0.15, 0.35)
    line = [
        (0, 0, 0),
        (0, rise, 0),
        (0, rise + 0.05, -0.05),
        (0, rise + 0.04, -0.15),
        (0, rise, -0.18),
    ]
    spout = skin(np.asarray(line), (1, 0, 0), np.full((5, 2), 0.012), 8)
    lever = tube((0.03, 0.03, 0), (0.09, 0.07, 0), (0.012, 0.007))
    return placed([Part(joined([spout, lever]), metal)], (0, height, 0))


def _machine(rng: Generator) -> Parts:
    """A coffee machine, a kettle, a microwave, a toaster."""
    kind = rng.random()
    if kind < 0.3:
        size = rng.uniform((0.42, 0.24, 0.3), (0.55, 0.32, 0.4))
        front = fitted(rng, "glass", size[0], size[1])
        pane = box((0.05, size[1] / 2, -size[2] / 2), (0.65 * size[0], 0.75 * size[1], 0.01))
        return [Part(box((0, size[1] / 2, 0), size), material(rng, "plastic")), Part(pane, front)]
    if kind < 0.55:
        body = revolved(
            [(0, 0), (0.08, 0), (0.085, 0.06), (0.06, 0.2), (0.02, 0.22), (0, 0.235)], 22
        )
        grip = skin(
            [(0.06, 0.19, 0), (0.12, 0.19, 0), (0.13, 0.1, 0), (0.09, 0.05, 0)],
            (0, 0, 1),
            np.full((4, 2), 0.011),
            6,
        )
        return [
            Part(body, material(rng, str(rng.choice(["metal", "plastic"])))),
            Part(grip, material(rng, "plastic")),
        ]
    size = rng.uniform((0.2, 0.28, 0.25), (0.35, 0.42, 0.4))
    back = cushion((0, size[1] / 2, 0.3 * size[2]), (size[0], size[1], 0.4 * size[2]), 0.12)
    head = cushion(
        (0, 0.85 * size[1], -0.1 * size[2]), (size[0], 0.3 * size[1], 0.7 * size[2]), 0.15
    )
    base = box((0, 0.015, -0.1 * size[2]), (size[0], 0.03, 0.8 * size[2]))
    pot = revolved([(0, 0.03), (0.05, 0.03), (0.06, 0.09), (0.035, 0.15)], 18).placed(
        (0, 0, -0.12 * size[2])
    )
    coffee = revolved([(0, 0.033), (0.048, 0.033), (0.055, 0.08), (0, 0.08)], 18).placed(
        (0, 0, -0.12 * size[2])
    )
    return [
        Part(joined([back, head, base]), material(rng, "plastic")),
        Part(pot, material(rng, "pane")),
        Part(coffee, material(rng, "coffee")),
    ]


def kitchen(rng: Generator) -> Parts:
    """A counter with doors, a worktop, a sink, machines and clutter, and cupboards above."""
    width, depth, height = rng.uniform((1.2, 0.55, 0.82), (3.6, 0.68, 0.95))
    module = width / max(1, round(width / 0.6))
    front = fitted(rng, "cabinet", module, height - 0.1)
    top = material(rng, "counter")
    plinth, level = 0.1, height + 0.04
    parts = [
        Part(box((0, (height + plinth) / 2, 0), (width, height - plinth, depth)), front),
        Part(box((0, plinth / 2, 0.04), (width, plinth, depth - 0.08)), material(rng, "metal")),
        Part(box((0, height + 0.02, -0.015), (width, 0.04, depth + 0.03)), top),
        Part(
            box((0, level + 0.28, depth / 2 - 0.004), (width, 0.56, 0.008)), material(rng, "splash")
        ),
    ]
    sink = rng.uniform(-0.35, 0.35) * width
    if rng.random() < 0.6:
        bowl = box((sink, level - 0.002, -0.03), (0.5, 0.012, 0.38))
        inside = box((sink, level + 0.0045, -0.03), (0.44, 0.002, 0.32))
        parts += [Part(bowl, material(rng, "metal")), Part(inside, material(rng, "water"))]
        parts += placed(_tap(rng, level), (sink, 0, 0.2))
    for _ in range(int(rng.integers(0, 4))):
        at = (rng.uniform(-0.42, 0.42) * width, level, rng.uniform(0, 0.2) * depth)
        parts += placed(_machine(rng), at, float(rng.normal(0, 0.2)))
    count = int(rng.integers(3, 20))
    parts += placed(clutter(rng, (width, 0.9 * depth), count, 0.42, IN_KITCHENS), (0, level, 0))
    if rng.random() < 0.7:
        base, tall = height + rng.uniform(0.5, 0.65), rng.uniform(0.4, 0.8)
        share = rng.uniform(0.4, 1)
        upper = box(
            ((1 - share) * rng.uniform(-0.5, 0.5) * width, base + tall / 2, depth / 2 - 0.16),
            (share * width, tall, 0.32),
        )
        parts.append(
            Part(upper, fitted(rng, "cabinet", module, tall) if rng.random() < 0.3 else front)
        )
    if rng.random() < 0.4:
        fridge = box((width / 2 + 0.32, 0.9, 0), (0.6, 1.8, 0.62))
        parts.append(Part(fridge, fitted(rng, "cabinet", 0.6, 1.8)))
    return parts
