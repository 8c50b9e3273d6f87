"""Chairs, sofas, stools and beds."""

from math import pi

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Part, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import Mesh, blob, box, cushion, joined, revolved, surface, tube
from flexdepth.synth.skins import skin


def legs(width: float, depth: float, height: float, thickness: float) -> Mesh:
    """Return four legs at the corners of a rectangle."""
    x, z = width / 2 - thickness, depth / 2 - thickness
    posts = [
        box((i * x, height / 2, j * z), (thickness, height, thickness))
        for i in (-1, 1)
        for j in (-1, 1)
    ]
    return joined(posts)


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
        stand = legs(width, width, seat, rng.uniform(0.02, 0.045))
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


def slatted(rng: Generator) -> Parts:
    """A wooden chair with a back of slats and a padded seat."""
    seat, width, back = rng.uniform((0.42, 0.38, 0.35), (0.48, 0.46, 0.6))
    post = rng.uniform(0.025, 0.045)
    wood, pad = material(rng, "wood"), material(rng, str(rng.choice(["leather", "fabric", "wood"])))
    count = int(rng.integers(1, 7))
    upright = rng.random() < 0.4
    slats = []
    for a in np.linspace(0.2, 1, count):
        if upright:
            x = (a - 0.6) * 1.9 * width / 2
            slats.append(box((x, seat + back / 2, width / 2), (post, back, post / 2)))
        else:
            slats.append(
                box((0, seat + a * back, width / 2), (width, back / (2.2 * count), post / 2))
            )
    posts = [
        box((i * width / 2, (seat + back) / 2, width / 2), (post, seat + back, post))
        for i in (-1, 1)
    ]
    rails = [
        box((0, seat - 0.06, 0), (width, 0.05, width)),
        box((0, seat + back, width / 2), (width, 0.06, post)),
    ]
    frame = joined([*slats, *posts, *rails, legs(width, width, seat, post)])
    thick = rng.uniform(0.02, 0.06)
    return [Part(frame, wood), Part(cushion((0, seat, 0), (width, thick, width), 0.3), pad)]


def office_chair(rng: Generator) -> Parts:
    """A swivel chair with a curved back, arms and castors."""
    seat, width, back = rng.uniform((0.42, 0.44, 0.4), (0.55, 0.55, 0.7))
    cloth, frame = material(rng, str(rng.choice(["fabric", "leather"]))), material(rng, "plastic")
    u, v = np.meshgrid(np.linspace(-1, 1, 11), np.linspace(0, 1, 9))
    bow = 0.1 * u**2 - 0.05 * np.sin(pi * v) + 0.12 * v
    half = width / 2 * (1 - 0.25 * v**3)
    shell = np.stack([u * half, seat + 0.1 + v * back, width / 2 - bow + 0.02], -1)
    behind = surface(shell + np.array([0, 0, 0.05]))
    spokes = []
    for a in 2 * pi * np.arange(5) / 5 + rng.uniform(0, 1):
        tip = (0.3 * np.cos(a), 0.06, 0.3 * np.sin(a))
        spokes.append(tube((0, 0.1, 0), tip, (0.025, 0.015)))
        spokes.append(blob(rng, (0.05, 0.06, 0.05), 0.0, 8).placed((tip[0], 0.03, tip[2])))
    stand = [tube((0, 0.1, 0), (0, seat, 0), (0.025, 0.025)), *spokes]
    stand.append(box((0, seat + 0.08, width / 2 + 0.05), (0.06, 0.3, 0.03)))
    if rng.random() < 0.7:
        for s in (-1, 1):
            arm = [(s * width / 2, seat, 0.1), (s * (width / 2 + 0.06), seat + 0.1, 0.1),
                   (s * (width / 2 + 0.06), seat + 0.2, 0.05),
                   (s * (width / 2 + 0.05), seat + 0.22, -0.15)]  # fmt: skip
            stand.append(skin(arm, (1, 0, 0), np.full((4, 2), 0.02), 6))
    pad = cushion((0, seat + 0.03, 0), (width, 0.1, width), 0.35, 12)
    return [Part(joined([surface(shell), behind, pad]), cloth), Part(joined(stand), frame)]


def stool(rng: Generator) -> Parts:
    """A stool, a pouffe or a bench."""
    height, radius = rng.uniform((0.3, 0.15), (0.8, 0.25))
    if rng.random() < 0.3:
        soft = cushion((0, 0.2, 0), (2 * radius, 0.4, 2 * radius), rng.uniform(0.3, 0.7), 12)
        return [Part(soft, material(rng, str(rng.choice(["fabric", "leather"]))))]
    top = revolved(
        [(0, height), (radius, height), (radius * 1.02, height - 0.03), (0, height - 0.04)], 24
    )
    turns = 2 * pi * np.arange(int(rng.integers(3, 5))) / 4
    stand = [
        tube((0.6 * radius * np.cos(a), height - 0.03, 0.6 * radius * np.sin(a)),
             (1.1 * radius * np.cos(a), 0, 1.1 * radius * np.sin(a)), (0.016, 0.013))
        for a in turns
    ]  # fmt: skip
    return [Part(top, material(rng, "wood")), Part(joined(stand), material(rng, "metal"))]


def sofa(rng: Generator) -> Parts:
    """A sofa or an armchair with cushions."""
    width, depth, seat = rng.uniform((0.7, 0.75, 0.35), (2.4, 1.0, 0.5))
    cloth = material(rng, str(rng.choice(["fabric", "fabric", "leather"])))
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
    if rng.random() < 0.4:
        throw = draped(rng, (rng.uniform(0.5, 0.9), depth * 0.9), seat + 0.14, 0.25)
        at = (rng.uniform(-0.3, 0.3) * width, 0.0, -0.12)
        parts.append(Part(throw.placed(at), material(rng, "fabric")))
    return parts


def draped(rng: Generator, size: tuple[float, float], level: float, fall: float) -> Mesh:
    """Return a blanket over something of the given width and depth with its top at `level`.

    It lies in folds and hangs down by `fall` on all sides.
    """
    wide, long = size[0] / 2 + fall, size[1] / 2 + fall
    x, z = np.meshgrid(np.linspace(-wide, wide, 34), np.linspace(-long, long, 34))
    over = np.maximum(np.abs(x) - size[0] / 2, 0) + np.maximum(np.abs(z) - size[1] / 2, 0)
    waves = rng.normal(0, (9, 9, 3), (5, 3))
    folds = sum(np.sin(x * a + z * b + c) / (k + 2) for k, (a, b, c) in enumerate(waves))
    height = level + 0.02 * np.asarray(folds) - np.minimum(over, 1.2 * fall)
    inward = 1 - 0.7 * np.minimum(over, fall) / np.maximum(np.hypot(x, z), 0.1)
    ripple = 1 + 0.02 * np.minimum(over / fall, 1) * np.sin(16 * (x + z) / size[0])
    grid = np.stack([x * inward * ripple, np.maximum(height, 0.01), z * inward * ripple], -1)
    return surface(grid)


def bed(rng: Generator) -> Parts:
    """A bed with a headboard, a blanket and pillows."""
    width, length, height = rng.uniform((0.9, 1.9, 0.35), (1.8, 2.15, 0.6))
    parts = [
        Part(box((0, height / 2 - 0.1, 0), (width, height - 0.15, length)), material(rng, "wood")),
        Part(cushion((0, height, 0), (width, 0.22, length), 0.25), material(rng, "fabric")),
        Part(
            draped(rng, (width, length * 0.65), height + 0.15, rng.uniform(0.1, 0.4)).placed(
                (0, 0, -0.17 * length)
            ),
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
