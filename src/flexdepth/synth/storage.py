"""Shelves, cupboards, racks and what is piled up."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.clutter import IN_SHELVES, clutter
from flexdepth.synth.materials import Part, fitted, material
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.seating import legs
from flexdepth.synth.shapes import Mesh, blob, box, cushion, joined, quad, tube, turn


def shelf(rng: Generator) -> Parts:
    """A shelf with books and things, open or behind glass doors."""
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
                clutter(rng, (width, 0.7 * depth), 2 * count, 0.8 * pitch, IN_SHELVES),
                (0, k * pitch + 0.012, 0),
            )
    return parts + (_doors(rng, (width, height, depth)) if rng.random() < 0.3 else [])


def _doors(rng: Generator, size: tuple[float, float, float]) -> Parts:
    """Return glass doors with thin frames before a shelf."""
    width, height, depth = size
    bar, front = float(rng.choice([0.012, 0.04])), -depth / 2 - 0.012
    x = np.linspace(-width / 2, width / 2, 1 + max(1, round(width / rng.uniform(0.4, 0.8))))
    posts = [box((at, height / 2, front), (bar, height, 0.02)) for at in x]
    rails = [box((0, y, front), (width, bar, 0.02)) for y in (bar / 2, height - bar / 2)]
    pane = quad((-width / 2, 0, front), (width, 0, 0), (0, height, 0))
    frame = material(rng, str(rng.choice(["wood", "metal", "metal"])))
    return [Part(joined(posts + rails), frame), Part(pane, material(rng, "pane"))]


def _books(rng: Generator, width: float, height: float, depth: float) -> Parts:
    looks = [material(rng, str(rng.choice(["packet", "thing"]))) for _ in range(6)]
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


def cabinet(rng: Generator) -> Parts:
    """A wardrobe, chest, fridge or box, with doors on its front."""
    width, height, depth = rng.uniform((0.35, 0.4, 0.35), (1.4, 2.2, 0.7))
    look = fitted(rng, "cabinet", width, height)
    body = Part(box((0, height / 2, 0), (width, height, depth)), look)
    return [body, *placed(clutter(rng, (width, depth), int(rng.integers(0, 6))), (0, height, 0))]


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
        parts.append(Part(block, material(rng, str(rng.choice(["card", "card", "thing", "wood"])))))
        floor += size[1]
        size = size * rng.uniform(0.6, 1, 3)
    return parts


def heap(rng: Generator) -> Parts:
    """Things piled on the floor: boxes, bags, bottles, cloth, boards that lean."""
    width, depth, height = rng.uniform((0.5, 0.4, 0.2), (1.6, 1.2, 0.9))
    parts = clutter(rng, (width, depth), int(rng.integers(5, 20)), height, IN_SHELVES)
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
    frame = joined([*boards, legs(width, depth, height, rng.uniform(0.02, 0.05))])
    parts = [Part(frame, material(rng, str(rng.choice(["metal", "wood"]))))]
    for k in range(levels):
        things = clutter(rng, (width, depth), int(rng.integers(2, 12)), 0.8 * pitch, IN_SHELVES)
        parts += placed(things, (0, (k + 0.6) * pitch + 0.01, 0))
    return parts


def goods(rng: Generator) -> Parts:
    """A shop's shelf, open or with glass doors: rows of the same packet beside the next."""
    width, height, depth = rng.uniform((0.9, 1.3, 0.3), (2.4, 2.2, 0.5))
    levels = int(rng.integers(3, 7))
    pitch = height / levels
    boards = [box((0, k * pitch + 0.08, 0), (width, 0.03, depth)) for k in range(levels)]
    back = box((0, height / 2, depth / 2), (width, height, 0.02))
    sides = [box((s * width / 2, height / 2, 0), (0.03, height, depth)) for s in (-1, 1)]
    parts = [
        Part(joined([*boards, back, *sides]), material(rng, str(rng.choice(["metal", "paint"]))))
    ]
    for k in range(levels):
        x = -width / 2 + 0.03
        while x < width / 2 - 0.1:
            size = rng.uniform((0.05, 0.3, 0.05), (0.2, 0.85, 0.2)) * (1, pitch, 1)
            look = fitted(rng, "packet", size[0], size[1])
            count = min(int(rng.integers(2, 7)), int((width / 2 - 0.02 - x) / size[0]))
            round_ones = rng.random() < 0.4
            row: list[Mesh] = []
            for c in range(count):
                if rng.random() < 0.06:
                    continue
                place = (x + (c + 0.5) * size[0], k * pitch + 0.095 + size[1] / 2,
                         -depth / 2 + size[2] / 2 + 0.02 + rng.exponential(0.02))  # fmt: skip
                inner = (0.92 * size[0], size[1], size[2])
                row.append(cushion(place, inner, 0.9, 8) if round_ones else box(place, inner))
            if row:
                parts.append(Part(joined(row), look))
            x += max(count, 1) * size[0] + 0.01
        tag = box((0, k * pitch + 0.08, -depth / 2 - 0.004), (width, 0.035, 0.004))
        parts.append(Part(tag, material(rng, "paper")))
    return parts + (_doors(rng, (width, height, depth + 0.02)) if rng.random() < 0.2 else [])


def crates(rng: Generator) -> Parts:
    """Plastic tubs with lids, stacked."""
    size = rng.uniform((0.35, 0.2, 0.3), (0.6, 0.35, 0.45))
    parts: Parts = []
    for k in range(int(rng.integers(1, 5))):
        base = k * (size[1] + 0.03)
        tub = cushion((0, base + size[1] / 2, 0), size, 0.12, 10)
        lid = cushion((0, base + size[1], 0), (size[0] + 0.04, 0.05, size[2] + 0.04), 0.15, 8)
        yaw = float(rng.normal(0, 0.1))
        look = material(rng, "plastic")
        parts += placed([Part(tub, look), Part(lid, material(rng, "plastic"))], (0, 0, 0), yaw)
    return parts


def boards(rng: Generator) -> Parts:
    """Planks, ladders, brooms and pictures that lean against the wall behind."""
    parts: Parts = []
    for _ in range(int(rng.integers(2, 7))):
        wide, tall = rng.uniform((0.03, 0.5), (0.9, 2.0))
        lean = rng.uniform(0.1, 0.35)
        up = np.array([0, np.cos(lean), np.sin(lean)]) * tall
        shift = rng.uniform(-0.5, 0.5)
        foot = -tall * np.sin(lean) - rng.uniform(0, 0.2)
        look = fitted(
            rng, str(rng.choice(["wood", "wood", "picture", "thing", "metal"])), wide, tall
        )
        plank = box((0, 0, 0), (wide, tall, 0.02)).turned(
            np.array([[1, 0, 0], [0, np.cos(lean), -np.sin(lean)], [0, np.sin(lean), np.cos(lean)]])
        )
        middle = up / 2 + np.array([shift, 0.01, foot])
        parts.append(Part(plank.placed(middle), look))
    return parts
