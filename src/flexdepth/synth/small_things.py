"""Small things that lie on tables and in shelves: crockery, bottles, food, paper, packets."""

from math import pi

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Part, fitted, material
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.shapes import (
    Mesh,
    blob,
    box,
    cushion,
    joined,
    leaves,
    quad,
    revolved,
    surface,
    tube,
)
from flexdepth.synth.skins import skin

_GLAZE = "ceramic"


def vessel(rng: Generator, height: float) -> Parts:
    """A vase or a jar: a smooth random surface of revolution, open or closed."""
    steps = np.linspace(0, 1, 16)
    knots = np.r_[rng.uniform(0.3, 1), rng.uniform(0.2, 1, 4)]
    waves = np.polynomial.polynomial.polyval(
        steps, np.polynomial.polynomial.polyfit(np.linspace(0, 1, 5), knots, 4)
    )
    radius = np.clip(waves, 0.12, 1.1) * height * rng.uniform(0.2, 0.5)
    profile = [(0.0, 0.0), *zip(radius, steps * height, strict=True)]
    if rng.random() < 0.5:
        profile += [(0.9 * r, y) for r, y in zip(radius[:5:-2], steps[:5:-2] * height, strict=True)]
    return [Part(revolved(profile, 20), material(rng, str(rng.choice([_GLAZE, "thing", "flask"]))))]


def jar(rng: Generator) -> Parts:
    """A vase of ordinary size."""
    return vessel(rng, float(rng.uniform(0.08, 0.4)))


def cup(rng: Generator) -> Parts:
    """A glass, or a cup with a handle, mostly full of coffee, at times on a saucer."""
    if rng.random() < 0.35:
        return _tumbler(rng)
    radius, height = rng.uniform((0.032, 0.06), (0.048, 0.11))
    foot = radius * rng.uniform(0.6, 1)
    wall = 0.004
    steps = np.linspace(0, 1, 6)
    bow = foot + (radius - foot) * steps ** rng.uniform(0.3, 1)
    outer = [(0.0, 0.0), *zip(bow, steps * height, strict=True)]
    inner = [
        (r - wall, y + wall) for r, y in zip(bow[::-1], steps[::-1] * height - wall, strict=True)
    ]
    look = material(rng, _GLAZE)
    angle = np.linspace(-pi / 2, pi / 2, 9)
    ring = np.stack(
        [radius * 0.9 + 0.025 * np.cos(angle), height * (0.52 + 0.3 * np.sin(angle)), 0 * angle], 1
    )
    handle = skin(ring, (0, 0, 1), np.full((9, 2), 0.0045), 6)
    parts = [Part(revolved([*outer, *inner, (0, wall)], 24), look), Part(handle, look)]
    if rng.random() < 0.7:
        level = height * rng.uniform(0.5, 0.92)
        width = float(np.interp(level / height, steps, bow)) - wall
        parts.append(Part(revolved([(0, level), (width, level)], 24), material(rng, "coffee")))
    if rng.random() < 0.35:
        dish = [(0, 0), (0.05, 0), (0.075, 0.012), (0.072, 0.014), (0.045, 0.005), (0, 0.005)]
        parts = [*placed(parts, (0, 0.005, 0)), Part(revolved(dish, 28), look)]
    return placed(parts, (0, 0, 0), float(rng.uniform(0, 2 * pi)))


def _tumbler(rng: Generator) -> Parts:
    """Return a glass, with or without a stem, and what is left in it."""
    radius, height = rng.uniform((0.028, 0.08), (0.042, 0.15))
    base = float(rng.choice([0.006, 0.45 * height]))
    foot = [(0, 0), (0.9 * radius, 0.002), (0.004, 0.006), (0.004, base)] if base > 0.01 else []
    steps = np.linspace(0, 1, 7)
    bow = radius * (1 - rng.uniform(0, 0.3) * (1 - steps)) * np.minimum(1, 0.5 + 4 * steps)
    wall = [*zip(bow, base + steps * (height - base), strict=True)]
    parts = [Part(revolved([*foot, (0, base), *wall], 24), material(rng, "flask"))]
    if rng.random() < 0.6:
        left = steps * rng.uniform(0.2, 0.85)
        inside = 0.95 * np.interp(left, steps, bow)
        level = base + 0.002 + left * (height - base)
        filled = [(0, level[0]), *zip(inside, level, strict=True), (0, level[-1])]
        drink = str(rng.choice(["drink", "coffee", "plastic", "flask"]))
        parts.append(Part(revolved(filled, 24), material(rng, drink)))
    return parts


def bottle(rng: Generator) -> Parts:
    """A bottle with neck, cap and label."""
    radius, height = rng.uniform((0.025, 0.17), (0.05, 0.34))
    shoulder, neck = rng.uniform((0.5, 0.22), (0.75, 0.45))
    profile = [
        (0, 0), (radius, 0.003), (radius, shoulder * height),
        (radius * 0.8, (shoulder + 0.06) * height), (radius * neck, (shoulder + 0.16) * height),
        (radius * neck, height), (0, height),
    ]  # fmt: skip
    body = material(rng, str(rng.choice(["flask", "flask", "plastic", "plastic"])))
    paper = fitted(rng, "packet", 2 * pi * radius, 0.3 * height)
    band = revolved([(radius + 1e-3, 0.12 * height), (radius + 1e-3, 0.42 * height)], 24)
    cap = revolved(
        [
            (0, height + 0.02),
            (radius * neck + 0.004, height + 0.02),
            (radius * neck + 0.004, height - 0.01),
        ]
    )
    parts = [
        Part(revolved(profile, 24), body),
        Part(band, paper),
        Part(cap, material(rng, "plastic")),
    ]
    if body.clear and rng.random() < 0.6:
        level = shoulder * height * rng.uniform(0.2, 1)
        filled = [(0, 0.006), (0.95 * radius, 0.006), (0.95 * radius, level), (0, level)]
        parts.append(Part(revolved(filled, 24), material(rng, str(rng.choice(["drink", "flask"])))))
    return parts


def tin(rng: Generator) -> Parts:
    """A tin, a paint pot or a roll."""
    radius, height = rng.uniform((0.025, 0.05), (0.09, 0.2))
    paper = fitted(rng, "packet", 2 * pi * radius, height)
    lid = [(0, height), (radius * 0.95, height), (radius, height - 0.004)]
    return [
        Part(revolved([(radius, 0), (radius, height)], 24), paper),
        Part(revolved(lid, 24), material(rng, "metal")),
    ]


def plate(rng: Generator) -> Parts:
    """A plate or a bowl with food on it."""
    radius, deep = rng.uniform((0.07, 0.012), (0.15, 0.07))
    steps = np.linspace(0, 1, 8)
    curve = deep * steps ** rng.uniform(1.5, 4)
    profile = [*zip(radius * steps, curve + 0.004, strict=True), (radius, deep), (0.5 * radius, 0)]
    parts = [Part(revolved(profile, 28), material(rng, _GLAZE))]
    for _ in range(int(rng.integers(0, 7))):
        size = rng.uniform(0.02, 0.07, 3)
        lump = blob(rng, size, rng.uniform(0, 0.12), 9)
        at = (
            *(rng.uniform(-0.4, 0.4, 1) * radius),
            0.012 + size[1] / 2,
            rng.uniform(-0.4, 0.4) * radius,
        )
        parts.append(
            Part(lump.placed(at), material(rng, str(rng.choice(["food", "food", "thing", "leaf"]))))
        )
    return parts


def fruit(rng: Generator) -> Parts:
    """A few round things: apples, rolls, balls of wool."""
    parts: Parts = []
    look = material(rng, str(rng.choice(["thing", "food", "plastic"])))
    for _ in range(int(rng.integers(1, 5))):
        size = rng.uniform(0.05, 0.1)
        at = (*rng.uniform(-0.08, 0.08, 1), size * 0.48, rng.uniform(-0.08, 0.08))
        parts.append(Part(blob(rng, (size, size * 0.95, size), 0.02, 12).placed(at), look))
    return parts


def sheets(rng: Generator) -> Parts:
    """Papers or magazines that lie flat, one over the other."""
    parts: Parts = []
    for k in range(int(rng.integers(1, 6))):
        wide, long = rng.uniform((0.14, 0.2), (0.23, 0.31))
        thick = float(rng.choice([0.001, 0.004, 0.012]))
        middle = (0, 0.002 + 0.012 * k * rng.random(), 0)
        sheet = box(middle, (wide, thick, long))
        print_side = quad(
            (wide / 2, middle[1] + thick / 2 + 4e-4, -long / 2), (-wide, 0, 0), (0, 0, long)
        )
        at, yaw = (*rng.normal(0, 0.06, 1), 0.0, rng.normal(0, 0.06)), float(rng.normal(0, 0.5))
        look = fitted(rng, str(rng.choice(["paper", "packet", "picture"])), wide, long)
        parts += placed([Part(sheet, material(rng, "paint")), Part(print_side, look)], at, yaw)
    return parts


def book(rng: Generator) -> Parts:
    """Books that lie on each other."""
    parts: Parts = []
    level = 0.0
    for _ in range(int(rng.integers(1, 5))):
        size = rng.uniform((0.11, 0.012, 0.16), (0.22, 0.05, 0.3))
        cover = box((0, level + size[1] / 2, 0), size)
        parts += placed(
            [Part(cover, fitted(rng, "packet", *size[::2]))], (0, 0, 0), rng.normal(0, 0.3)
        )
        level += size[1]
    return parts


def packet(rng: Generator) -> Parts:
    """A printed box or bag that stands."""
    size = rng.uniform((0.05, 0.06, 0.03), (0.24, 0.34, 0.14))
    look = fitted(rng, "packet", size[0], size[1])
    soft = cushion((0, size[1] / 2, 0), size, rng.uniform(0.2, 0.6), 9)
    return [Part(soft if rng.random() < 0.3 else box((0, size[1] / 2, 0), size), look)]


def framed(rng: Generator) -> Parts:
    """A small picture that stands and leans back, or a calendar."""
    wide, tall = rng.uniform((0.1, 0.12), (0.3, 0.3))
    pane = quad((wide / 2, 0.012, -0.012), (-wide, 0, 0), (0, tall, 0.25 * tall))
    board = box((0, 0, 0), (wide + 0.03, tall + 0.03, 0.01))
    lean = np.array([[1, 0, 0], [0, 0.97, -0.24], [0, 0.24, 0.97]])
    back = board.turned(lean).placed((0, tall / 2 + 0.01, tall / 8))
    return [Part(pane, fitted(rng, "picture", wide, tall)), Part(back, material(rng, "wood"))]


def shoes(rng: Generator) -> Parts:
    """A pair of shoes that lie as they were left."""
    look = material(rng, str(rng.choice(["leather", "fabric", "plastic"])))
    size = rng.uniform(0.8, 1.1)
    parts: Parts = []
    for x in (-0.07, 0.07):
        sole = cushion((0, 0.012, 0), (0.09, 0.024, 0.27), 0.6, 9)
        toe = cushion((0, 0.045, -0.06), (0.085, 0.07, 0.15), 0.9, 10)
        heel = cushion((0, 0.065, 0.07), (0.075, 0.12, 0.12), 0.6, 10)
        shoe = [Part(joined([toe, heel]), look), Part(sole, material(rng, "tyre"))]
        at = (x + rng.normal(0, 0.02), 0.0, rng.normal(0, 0.05))
        parts += placed(shoe, at, float(rng.normal(0, 0.3)))
    return [Part(part.mesh.scaled((size,) * 3), part.material) for part in parts]


def pens(rng: Generator) -> Parts:
    """A pot with pens, brushes, cutlery or flowers."""
    height = rng.uniform(0.08, 0.12)
    sticks: list[Mesh] = []
    for _ in range(int(rng.integers(2, 10))):
        lean = rng.normal(0, 0.025, 2)
        top = (lean[0] * 2, rng.uniform(0.14, 0.28), lean[1] * 2)
        sticks.append(
            tube((lean[0] * 0.3, 0.02, lean[1] * 0.3), top, (0.004, rng.uniform(0.003, 0.012)), 6)
        )
    pot = revolved(
        [(0, 0), (0.04, 0), (0.045, height), (0.042, height), (0.038, 0.01), (0, 0.01)], 18
    )
    parts = [Part(pot, material(rng, "ceramic")), Part(joined(sticks), material(rng, "thing"))]
    if rng.random() < 0.4:
        bloom = leaves(rng, (0.2, 0.16, 0.2), 60, 0.05).placed((0, 0.26, 0))
        parts.append(Part(bloom, material(rng, str(rng.choice(["leaf", "thing"])))))
    return parts


def gadget(rng: Generator) -> Parts:
    """A telephone, a radio, a remote control, a toy: rounded boxes and knobs."""
    size = rng.uniform((0.04, 0.015, 0.06), (0.28, 0.2, 0.22))
    body = cushion((0, size[1] / 2, 0), size, rng.uniform(0.08, 0.5), 10)
    knobs = [
        box((*rng.uniform(-0.35, 0.35, 1) * size[0], size[1], rng.uniform(-0.35, 0.35) * size[2]),
            rng.uniform(0.006, 0.03, 3))
        for _ in range(int(rng.integers(0, 9)))
    ]  # fmt: skip
    parts = [Part(body, material(rng, "plastic"))]
    return [*parts, Part(joined(knobs), material(rng, "plastic"))] if knobs else parts


def block(rng: Generator) -> Parts:
    """A plain box."""
    size = rng.uniform((0.04, 0.02, 0.04), (0.3, 0.35, 0.25))
    return [Part(box((0, size[1] / 2, 0), size), material(rng, str(rng.choice(["thing", "card"]))))]


def cable(rng: Generator) -> Parts:
    """A cable or a hose that lies in curves."""
    count = 24
    turning = np.cumsum(rng.normal(0, 0.35, count)) + rng.uniform(0, 6.3)
    step = rng.uniform(0.015, 0.05)
    line = np.cumsum(np.stack([np.cos(turning), 0 * turning, np.sin(turning)], 1) * step, 0)
    bore = float(rng.uniform(0.0025, 0.006))
    line += np.array([0, bore, 0]) - line.mean(0) * (1, 0, 1)
    return [Part(skin(line, (0, 1, 0), np.full((count, 2), bore), 6), material(rng, "plastic"))]


def cloth(rng: Generator) -> Parts:
    """A crumpled towel, shirt or napkin."""
    wide, long, high = rng.uniform((0.12, 0.12, 0.02), (0.4, 0.35, 0.1))
    return [Part(crumpled(rng, wide, long, high), material(rng, "fabric"))]


def crumpled(rng: Generator, wide: float, long: float, high: float, cells: int = 22) -> Mesh:
    """Return a cloth that lies on y = 0 in folds up to `high`, thin towards its rim."""
    x, z = np.meshgrid(np.linspace(-0.5, 0.5, cells), np.linspace(-0.5, 0.5, cells))
    folds = sum(
        np.abs(np.sin(x * a + z * b + c)) / (1 + k)
        for k, (a, b, c) in enumerate(rng.normal(0, (7, 7, 3), (5, 3)))
    )
    rim = np.clip(6 * (0.5 - np.maximum(np.abs(x), np.abs(z))), 0, 1)
    bent = 1 + 0.12 * np.sin(3 * z + rng.uniform(0, 6))
    height = 0.004 + high * rim * np.asarray(folds) / 2
    return surface(np.stack([x * wide * bent, height, z * long], -1))
