"""Shop fronts: windows with a room and goods behind, signs, awnings, goods on the pavement."""

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from flexdepth.synth.fronts import Front
from flexdepth.synth.materials import Material, Part, fitted, glowing, material
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.shapes import Mesh, box, joined, quad, revolved
from flexdepth.synth.stock import stocked


def shop_front(rng: Generator, front: Front, inside: float) -> Parts:
    """Return shop windows, signs, awnings and goods, and rooms so many metres deep behind.

    A window shows the room, lit or not, or is papered over or dark.
    """
    shops = max(1, int(rng.integers(1, front.bays + 1)))
    span = front.width / shops
    top = min(front.storey - 0.7, 2.9)
    shine = front.lit > 0.1 and rng.random() < 0.8
    parts = _masonry(rng, front, shops, top)
    rooms = stocked(partial(_room, size=(span, front.storey, inside)), 2)
    for k in range(shops):
        x = (k + 0.5) * span - front.width / 2
        wide = span - rng.uniform(0.3, 0.8)
        pane = quad((x - wide / 2, 0.45, -0.03), (wide, 0, 0), (0, top - 0.45, 0))
        clear = rng.random() < 0.7
        look = material(rng, "pane") if clear else _covered(rng, (wide, top), shine)
        sill = box((x, 0.22, -0.06), (wide, 0.45, 0.16))
        bars = [
            box((x + s * wide / 2, top / 2, -0.08), (0.12, top, 0.18)) for s in (-0.98, 0.2, 0.98)
        ]
        sign = box((x, top + 0.32, -0.1), (wide, 0.55, 0.2))
        letters = "print_lines" if rng.random() < 0.6 else "collage"
        board = fitted(rng, "poster", wide, 0.55)
        parts += [
            Part(pane, look),
            Part(joined([sill, *bars]), material(rng, str(rng.choice(["wood", "paint", "thing"])))),
            Part(sign, glowing(rng, letters, 1.5) if shine else board),
        ]
        if clear:
            light = float(rng.uniform(0.1, 0.9)) if shine else 0.0
            room = [Part(part.mesh, _lit(part.material, light)) for part in rooms(rng)]
            parts += placed(room, (x, 0, 0))
        if rng.random() < 0.4:
            parts += _awning(rng, (x, top + 0.05), wide)
        if rng.random() < 0.25:
            parts += _goods(rng, x, wide)
    return parts


def _masonry(rng: Generator, front: Front, shops: int, top: float) -> Parts:
    """Return the wall above the windows and the piers between them."""
    lintel = box((0, (top + front.storey) / 2, 0.1), (front.width, front.storey - top, 0.2))
    edges = np.linspace(-front.width / 2 + 0.4, front.width / 2 - 0.4, shops + 1)
    piers = [box((x, top / 2, 0.1), (0.82, top, 0.2)) for x in edges]
    return [Part(joined([lintel, *piers]), material(rng, "brickwork"))]


def _covered(rng: Generator, size: tuple[float, float], shine: bool) -> Material:
    """Return what a window looks like that shows no room."""
    if shine:
        return glowing(rng, "collage", rng.uniform(0.6, 3))
    if rng.random() < 0.5:
        return fitted(rng, "poster", size[0] / 2, size[1])
    return material(rng, "glass")


def _lit(look: Material, light: float) -> Material:
    """Return what a thing looks like in so much light from all sides; 0 leaves it as it is."""
    return replace(look, glow=light, gloss=0.0) if light else look


def _room(rng: Generator, size: tuple[float, float, float]) -> Parts:
    """Return a room behind z = 0 with shelves along its walls and goods near its window."""
    wide, tall, deep = size
    left, right, back = -wide / 2 + 0.02, wide / 2 - 0.02, deep - 0.02
    walls = [
        quad((left, 0, back), (2 * right, 0, 0), (0, tall, 0)),
        *(quad((x, 0, 0), (0, 0, back), (0, tall, 0)) for x in (left, right)),
    ]
    strips = [box((x, tall - 0.06, 0.6 * deep), (0.12, 0.05, 0.5 * deep)) for x in
              np.arange(left + 0.6, right, 1.6)]  # fmt: skip
    parts = [
        Part(joined(walls), material(rng, "wall")),
        Part(quad((left, 0.02, 0), (2 * right, 0, 0), (0, 0, back)), material(rng, "floor")),
        Part(quad((left, tall - 0.02, 0), (2 * right, 0, 0), (0, 0, back)), material(rng, "paint")),
        Part(joined(strips), glowing(rng, "plain", 2.0)),
    ]
    shelf = _stand(rng, (0.9 * wide, min(2.2, 0.7 * tall), 0.35))
    parts += placed(shelf, (0, 0, back - 0.25))
    stand = stocked(partial(_stand, size=rng.uniform(0.4, 1.1, 3)), 2)
    for _ in range(int(rng.integers(1, 3 + int(wide)))):
        thing = _dummy(rng) if rng.random() < 0.35 else stand(rng)
        at = (rng.uniform(left + 0.6, right - 0.6), 0.0, rng.uniform(0.35, max(0.4, 0.7 * deep)))
        parts += placed(thing, at, float(rng.normal(0, 0.4)))
    return parts


def _stand(rng: Generator, size: ArrayLike) -> Parts:
    """Return boards one above the other with packets on them."""
    wide, tall, deep = np.asarray(size, float)
    levels = max(1, int(tall / 0.38))
    pitch = tall / levels
    boards = [box((0, (k + 0.5) * pitch, 0), (wide, 0.03, deep)) for k in range(levels)]
    boards += [box((s * wide / 2, tall / 2, 0), (0.03, tall, deep)) for s in (-1, 1)]
    looks = [material(rng, str(rng.choice(["packet", "thing", "plastic"]))) for _ in range(3)]
    parts = [Part(joined(boards), material(rng, str(rng.choice(["wood", "paint", "metal"]))))]
    rows: list[list[Mesh]] = [[], [], []]
    for k in range(levels):
        x = -wide / 2
        while x < wide / 2 - 0.2:
            w, h, d = rng.uniform((0.08, 0.4, 0.4), (0.3, 0.9, 0.9)) * (1, pitch, deep)
            place = (x + w / 2 + 0.02, (k + 0.5) * pitch + h / 2 + 0.015, 0)
            rows[int(rng.integers(3))].append(box(place, (w, min(h, 0.4), d)))
            x += w + 0.03
    return parts + [Part(joined(r), look) for r, look in zip(rows, looks, strict=True) if r]


def _dummy(rng: Generator) -> Parts:
    """Return a dress on a tailor's dummy."""
    tall, hem = rng.uniform((1.45, 0.25), (1.75, 0.9))
    outline = [(0.3, hem), (0.17, 0.62 * tall), (0.13, 0.7 * tall), (0.17, 0.82 * tall),
               (0.16, 0.9 * tall), (0.05, 0.93 * tall), (0.05, tall), (0, tall)]  # fmt: skip
    foot = revolved([(0.02, hem), (0.02, 0.03), (0.18, 0.02), (0.18, 0)], 10)
    cloth = revolved(outline, 14).scaled((1, 1, 0.65))
    return [Part(cloth, material(rng, "fabric")), Part(foot, material(rng, "metal"))]


def _awning(rng: Generator, at: tuple[float, float], wide: float) -> Parts:
    x, y = at
    out, drop = rng.uniform((0.8, 0.2), (1.8, 0.7))
    cloth = quad((x - wide / 2, y - drop, -out), (wide, 0, 0), (0, drop, out))
    hem = quad((x - wide / 2, y - drop - 0.22, -out), (wide, 0, 0), (0, 0.22, 0))
    return [Part(joined([cloth, hem]), material(rng, "fabric"))]


def _goods(rng: Generator, x: float, wide: float) -> Parts:
    """Return crates, boards, or small tables on the pavement."""
    parts: Parts = []
    for _ in range(int(rng.integers(2, 7))):
        at = (x + rng.uniform(-0.45, 0.45) * wide, 0.0, -rng.uniform(0.5, 1.1))
        if rng.random() < 0.6:
            size = rng.uniform((0.3, 0.25, 0.3), (0.7, 1.1, 0.5))
            piece = box((0, size[1] / 2, 0), size)
        else:
            piece = revolved([(0.25, 0), (0.03, 0.04), (0.03, 0.72), (0.35, 0.72), (0, 0.75)], 14)
        look = material(rng, str(rng.choice(["thing", "wood", "poster", "autumn"])))
        parts += placed([Part(piece, look)], at, rng.normal(0, 0.3))
    return parts
