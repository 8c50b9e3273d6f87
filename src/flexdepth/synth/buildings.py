"""Buildings. Each stands with its front in the plane z = 0, facing -z, and is `width` wide."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.fronts import Front
from flexdepth.synth.materials import Part, fitted, glowing, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import Mesh, box, joined, prism, quad, tube
from flexdepth.synth.shop_fronts import shop_front


def building(rng: Generator, width: float, lit: float) -> Parts:
    """A house, a block of flats, an office, a shed or a shop with what is on its front."""
    make = (_house, _house, _house, _block, _block, _office, _shed)[int(rng.integers(7))]
    return make(rng, width, lit)


def _house(rng: Generator, width: float, lit: float) -> Parts:
    """One or two floors under a pitched roof, with a chimney or a dormer."""
    storeys = int(rng.integers(1, 4))
    front = Front(width, rng.uniform(2.6, 3.2), storeys, max(1, round(width / 3.2)), lit)
    depth, eave = rng.uniform(6, 11), rng.uniform(0.15, 0.6)
    parts = _walls(rng, front, depth) + _windows(rng, front, 0 if rng.random() < 0.8 else 1)
    parts += _door(rng, front)
    top = front.height
    rise = rng.uniform(0.3, 0.9) * depth / 2
    if rng.random() < 0.35:
        rise = rng.uniform(0.3, 0.8) * width / 2
        gable = [(-width / 2 - eave, top - 0.1), (0, top + rise), (width / 2 + eave, top - 0.1)]
        roof = prism(gable, depth + 2 * eave).placed((0, 0, depth / 2), np.pi / 2)
    else:
        gable = [(-eave, top - 0.1), (depth / 2, top + rise), (depth + eave, top - 0.1)]
        roof = prism(gable, width + 2 * eave)
    parts.append(Part(roof, material(rng, "roof")))
    if rng.random() < 0.6:
        x, z = rng.uniform((-0.4 * width, 0.3 * depth), (0.4 * width, 0.7 * depth))
        stack = box((x, top + 0.8 * rise, z), (0.6, 1.8, 0.6))
        parts.append(Part(stack, material(rng, "brickwork")))
    gutter = tube((-width / 2, top - 0.05, -eave), (width / 2, top - 0.05, -eave), (0.06, 0.06), 6)
    pipe = tube((0.47 * width, 0, -0.08), (0.47 * width, top, -0.08), (0.045, 0.045), 6)
    return [*parts, Part(joined([gutter, pipe]), material(rng, "metal"))]


def _block(rng: Generator, width: float, lit: float) -> Parts:
    """Several floors, with shops below, balconies, cornices and bands."""
    bays = max(2, round(width / rng.uniform(2.2, 3.6)))
    front = Front(width, rng.uniform(2.8, 3.8), int(rng.integers(3, 8)), bays, lit)
    shops = rng.random() < 0.6
    inside = float(rng.uniform(1.2, 4.0)) if shops else 0.0
    parts = _walls(rng, front, rng.uniform(8, 14), inside=inside)
    parts += shop_front(rng, front, inside) if shops else _door(rng, front)
    parts += _windows(rng, front, 1 if shops else 0)
    parts += _bands(rng, front)
    if rng.random() < 0.4:
        parts += _balconies(rng, front)
    if rng.random() < 0.4:
        top = front.height
        gable = [(-0.2, top), (1.8, top + 2.4), (7, top + 3.0), (9, top)]
        parts.append(Part(prism(gable, width), material(rng, "roof")))
    return parts


def _office(rng: Generator, width: float, lit: float) -> Parts:
    """Glass from side to side, floor by floor; some are towers."""
    storeys = int(rng.integers(2, 8)) if rng.random() < 0.7 else int(rng.integers(8, 22))
    front = Front(width, rng.uniform(3.0, 4.2), storeys, max(2, round(width / 2)), lit)
    depth = rng.uniform(10, 18)
    shops = rng.random() < 0.5
    inside = float(rng.uniform(1.5, 5.0)) if shops else 0.0
    parts = _walls(rng, front, depth, inside=inside)
    glass = material(rng, "glass")
    floors = [
        box((0, (k + 0.55) * front.storey, depth / 2),
            (width + 0.06, front.storey * 0.62, depth + 0.06))
        for k in range(int(shops), storeys)
    ]  # fmt: skip
    low = front.storey if shops else 0.0
    bars = [
        box((front.middle(bay), (front.height + low) / 2, -0.06), (0.1, front.height - low, 0.14))
        for bay in range(front.bays)
    ]
    parts += [Part(joined(floors), glass), Part(joined(bars), material(rng, "metal"))]
    return parts + (shop_front(rng, front, inside) if shops else [])


def _shed(rng: Generator, width: float, lit: float) -> Parts:
    """A garage, a hall or a warehouse with a large gate."""
    front = Front(width, rng.uniform(3.0, 6.0), 1, max(1, round(width / 5)), lit)
    parts = _walls(rng, front, rng.uniform(8, 20), "roof" if rng.random() < 0.5 else "brickwork")
    gates = [
        quad((front.middle(bay) - 1.4, 0, -0.04), (2.8, 0, 0), (0, 2.6, 0))
        for bay in range(front.bays)
        if rng.random() < 0.7
    ]
    if gates:
        parts.append(
            Part(joined(gates), material(rng, str(rng.choice(["cabinet", "metal", "wood"]))))
        )
    edge = box((0, front.height, 0), (width + 0.3, 0.35, 0.3))
    return [*parts, Part(edge, material(rng, "paint"))]


def _walls(
    rng: Generator, front: Front, depth: float, kind: str = "brickwork", inside: float = 0.0
) -> Parts:
    """Return the body, its ground floor hollow for so many metres behind the front."""
    low, wide = front.storey if inside else 0.0, front.width
    body = [box((0, (front.height + low) / 2, depth / 2), (wide, front.height - low, depth))]
    if inside:
        body.append(box((0, low / 2, (depth + inside) / 2), (wide, low, depth - inside)))
        body += [
            box((s * (wide / 2 - 0.1), low / 2, inside / 2), (0.2, low, inside)) for s in (-1, 1)
        ]
    return [Part(joined(body), material(rng, kind))]


def _windows(rng: Generator, front: Front, above: int) -> Parts:
    """Return windows from a floor up: panes deep in their frames, with sills and some shutters."""
    pitch = front.width / front.bays
    wide, tall = pitch * rng.uniform(0.3, 0.6), front.storey * rng.uniform(0.4, 0.62)
    sill, deep = front.storey * rng.uniform(0.2, 0.32), rng.uniform(0.06, 0.2)
    bars = int(rng.integers(0, 3))
    shutters = rng.random() < 0.2
    panes: tuple[list[Mesh], list[Mesh]] = ([], [])
    frames, leaves = [], []
    for floor in range(above, front.storeys):
        for bay in range(front.bays):
            x, y = front.middle(bay), floor * front.storey + sill
            if floor == 0 and bay == front.bays // 2:
                continue
            pane = quad((x - wide / 2, y, -0.012), (wide, 0, 0), (0, tall, 0))
            panes[int(rng.random() < front.lit)].append(pane)
            frames.append(_casement(x, y, (wide, tall, deep), bars))
            if shutters:
                leaves += [
                    box((x + s * (wide * 0.78), y + tall / 2, -0.04), (wide * 0.5, tall, 0.05))
                    for s in (-1, 1)
                ]
    parts = [Part(joined(frames), material(rng, "paint"))] if frames else []
    glass = fitted(rng, "facade", wide, tall) if rng.random() < 0.25 else material(rng, "glass")
    for group, look in (
        (panes[0], glass),
        (panes[1], glowing(rng, "mottled", rng.uniform(0.5, 4))),
    ):
        if group:
            parts.append(Part(joined(group), look))
    if leaves:
        parts.append(Part(joined(leaves), material(rng, str(rng.choice(["wood", "thing"])))))
    return parts


def _casement(x: float, y: float, size: tuple[float, float, float], bars: int) -> Mesh:
    """Return a window's frame, its bars and its sill."""
    wide, tall, deep = size
    bar = 0.07
    pieces = [box((x + s * wide / 2, y + tall / 2, -deep / 2), (bar, tall, deep)) for s in (-1, 1)]
    pieces.append(box((x, y + tall, -deep / 2), (wide + bar, bar, deep)))
    pieces.append(box((x, y - 0.03, -deep / 2 - 0.05), (wide + 0.2, 0.08, deep + 0.1)))
    if bars > 0:
        pieces.append(box((x, y + tall / 2, -0.03), (0.05, tall, 0.04)))
    if bars > 1:
        pieces.append(box((x, y + tall * 0.6, -0.03), (wide, 0.05, 0.04)))
    return joined(pieces)


def _door(rng: Generator, front: Front) -> Parts:
    """Return a front door with its steps, and some a porch."""
    x = front.middle(front.bays // 2)
    wide, tall = rng.uniform((0.9, 2.0), (1.5, 2.4))
    steps = [box((x, 0.09 * k, -0.35 * (3 - k) - 0.1), (wide + 0.6, 0.18, 0.36)) for k in range(3)]
    leaf = quad((x - wide / 2, 0.2, -0.03), (wide, 0, 0), (0, tall, 0))
    sides = [box((x + s * wide / 2, 0.2 + tall / 2, -0.05), (0.12, tall, 0.14)) for s in (-1, 1)]
    sides.append(box((x, 0.25 + tall, -0.05), (wide + 0.2, 0.14, 0.16)))
    parts = [
        Part(leaf, fitted(rng, "cabinet", wide, tall)),
        Part(joined(sides), material(rng, "paint")),
        Part(joined(steps), material(rng, "pavement")),
    ]
    if rng.random() < 0.3:
        roof = box((x, tall + 0.6, -0.7), (wide + 1.2, 0.12, 1.5))
        posts = [
            tube((x + out, 0, -1.3), (x + out, tall + 0.6, -1.3), (0.08, 0.08))
            for out in (-wide / 2 - 0.4, wide / 2 + 0.4)
        ]
        parts.append(Part(joined([roof, *posts]), material(rng, "paint")))
    return parts


def _bands(rng: Generator, front: Front) -> Parts:
    """Return a cornice and bands between the floors."""
    out = rng.uniform(0.08, 0.4)
    levels = [front.height] + ([front.storey] if rng.random() < 0.6 else [])
    if rng.random() < 0.3:
        levels += [k * front.storey for k in range(2, front.storeys)]
    bands = [box((0, y, 0), (front.width + 0.1, rng.uniform(0.12, 0.35), 2 * out)) for y in levels]
    return [Part(joined(bands), material(rng, "paint"))]


def _balconies(rng: Generator, front: Front) -> Parts:
    """Return balconies with railings or panes before some of the windows."""
    slabs, rails, panes = [], [], []
    glazed = rng.random() < 0.35
    pitch, out = front.width / front.bays, rng.uniform(0.5, 1.4)
    chosen = rng.random(front.bays) < 0.6
    for floor in range(1, front.storeys):
        for bay in np.flatnonzero(chosen):
            x, y = front.middle(int(bay)), floor * front.storey + 0.1
            wide = 0.85 * pitch
            slabs.append(box((x, y, -out / 2), (wide, 0.14, out)))
            rails.append(box((x, y + 1.0, -out), (wide, 0.05, 0.05)))
            panes += [
                quad((x - wide / 2, y, -out), (wide, 0, 0), (0, 1, 0)),
                *(quad((x + s * wide / 2, y, -out), (0, 0, out), (0, 1, 0)) for s in (-1, 1)),
            ]
            posts = np.linspace(-wide / 2, wide / 2, 2 if glazed else int(wide / 0.14))
            rails += [box((x + at, y + 0.5, -out), (0.02, 1.0, 0.02)) for at in posts]
    if not slabs:
        return []
    return [
        *([Part(joined(panes), material(rng, "pane"))] if glazed else []),
        Part(joined(slabs), material(rng, "paint")),
        Part(joined(rails), material(rng, "metal")),
    ]
