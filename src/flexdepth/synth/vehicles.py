"""Cars, vans, buses, lorries and two-wheelers. All stand on y = 0 and drive towards -z."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from flexdepth.synth.car_parts import interior, lamps
from flexdepth.synth.materials import Material, Part, colour, glowing, material
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import Array, Mesh, box, joined, revolved, rods, surface, tube, wire

_SIDES = (-1, 1)

Stations = tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class _Shape:
    """The outline of a kind of car: rows from front to back of z, width and height.

    Attributes:
        share: How often it is seen.
        hull: Of the body up to the windows; width as a share of the greatest, metres else.
        cabin: Of what is above.
        width: Greatest half width, metres.
        wheels: z of the axles, and the wheels' radius.
        boxy: How sharp the edges are, 0 to 1.
        glazed: Where glass begins and ends along the cabin: shares of its stations.
    """

    share: float
    hull: Stations
    cabin: Stations
    width: float
    wheels: tuple[float, float, float]
    boxy: float
    glazed: tuple[float, float] = (0.0, 1.0)


_SHAPES = (
    _Shape(
        0.3,
        ((-2.25, 0.6, 0.4), (-2.2, 0.86, 0.6), (-1.85, 0.96, 0.73), (-1.0, 1, 0.93), (0.9, 1, 0.98),
         (1.75, 0.98, 0.98), (2.15, 0.9, 0.9), (2.25, 0.7, 0.5)),
        ((-1.1, 0.84, 0.9), (-0.4, 0.82, 1.33), (0.1, 0.82, 1.43), (0.75, 0.8, 1.42),
         (1.75, 0.78, 0.96)),
        0.89, (-1.4, 1.35, 0.32), 0.45,
    ),
    _Shape(
        0.3,
        ((-1.95, 0.6, 0.42), (-1.9, 0.86, 0.66), (-1.6, 0.96, 0.8), (-0.9, 1, 0.98), (1.5, 1, 1.02),
         (1.85, 0.92, 0.95), (1.9, 0.75, 0.5)),
        ((-1.1, 0.85, 0.93), (-0.4, 0.84, 1.4), (0.2, 0.83, 1.5), (1.3, 0.81, 1.47),
         (1.8, 0.8, 0.95)),
        0.86, (-1.25, 1.2, 0.31), 0.42,
    ),
    _Shape(
        0.16,
        ((-2.3, 0.65, 0.5), (-2.25, 0.9, 0.8), (-1.9, 0.98, 0.98), (-1.0, 1, 1.1), (1.8, 1, 1.12),
         (2.2, 0.95, 1.0), (2.3, 0.8, 0.55)),
        ((-1.15, 0.9, 1.05), (-0.55, 0.9, 1.62), (0.2, 0.89, 1.74), (1.8, 0.87, 1.7),
         (2.2, 0.86, 1.05)),
        0.94, (-1.4, 1.4, 0.38), 0.35,
    ),
    _Shape(
        0.16,
        ((-2.55, 0.75, 0.5), (-2.5, 0.93, 0.95), (-2.2, 0.98, 1.1), (-1.9, 1, 1.2), (2.5, 1, 1.2),
         (2.6, 0.97, 0.6)),
        ((-2.15, 0.95, 1.1), (-1.5, 0.96, 1.9), (-1.0, 0.97, 2.0), (2.5, 0.97, 2.02),
         (2.6, 0.96, 1.1)),
        0.97, (-1.6, 1.6, 0.34), 0.22, (0.0, 0.42),
    ),
    _Shape(
        0.08,
        ((-2.6, 0.7, 0.5), (-2.55, 0.92, 0.85), (-2.1, 0.98, 1.0), (-1.2, 1, 1.1), (2.5, 1, 1.1),
         (2.6, 0.95, 0.6)),
        ((-1.3, 0.9, 1.05), (-0.7, 0.9, 1.65), (-0.2, 0.89, 1.75), (0.5, 0.88, 1.73),
         (0.75, 0.87, 1.05)),
        0.93, (-1.6, 1.6, 0.38), 0.3,
    ),
)  # fmt: skip
"""Saloon, hatchback, off-roader, van and pickup."""


def _loft(stations: Stations, width: float, low: float, boxy: float, grown: float = 1.0) -> Array:
    """Return sections along z, each a rounded arch from `low` up: stations by points by 3."""
    z, wide, top = np.array(stations).T
    fine = np.linspace(0, len(z) - 1, 2 * len(z) + 3)
    z, wide, top = (np.interp(fine, np.arange(len(z)), row) for row in (z, wide, top))
    angle = np.linspace(0, np.pi, 15)

    def power(x: Array) -> Array:
        return np.sign(x) * np.abs(x) ** boxy

    x = grown * width * wide[:, None] * power(np.cos(angle))
    y = low + grown * (top - low)[:, None] * power(np.sin(angle))
    return np.stack(np.broadcast_arrays(x, y, z[:, None]), -1)


def _capped(grid: Array) -> Mesh:
    """Return the surface through sections, closed at both ends."""
    ends = [np.broadcast_to(grid[k].mean(0), grid[k].shape)[None] for k in (0, -1)]
    return surface(np.concatenate([ends[0], grid, ends[1]]))


def _paint(rng: Generator) -> Material:
    """Return the paint of a car: mostly white, black, grey or silver, and it shines."""
    shade = colour(rng, 1.0, (0.01, 0.8)) if rng.random() < 0.45 else np.full(
        3, rng.choice([0.015, 0.05, 0.2, 0.45, 0.75]) * rng.uniform(0.8, 1.1)
    )  # fmt: skip
    gloss = float(rng.uniform(0.02, 0.07))
    return Material("plain", np.stack([shade, 0.85 * shade, 0.7 * shade]), (3.0, 3.0), gloss=gloss)


def wheels(width: float, axles: tuple[float, ...], radius: float) -> tuple[Mesh, Mesh]:
    """Return tyres and rims, one on each side of each axle, `width` apart outside."""
    outline = [(0, -0.1), (0.8, -0.1), (1, -0.07), (1, 0.07), (0.8, 0.1), (0, 0.1)]
    lying = revolved([(r * radius, y) for r, y in outline], 14)
    cap = revolved([(0.62 * radius, -0.104), (0.5 * radius, -0.09), (0, -0.108)], 9)
    cap = joined([cap, cap.scaled((1, -1, 1))])
    upright = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    places = [(side * (width - 0.09), radius, z) for side in (-1, 1) for z in axles]
    tyres, rims = (
        joined([mesh.turned(upright).placed(at) for at in places]) for mesh in (lying, cap)
    )
    return tyres, rims


def car(rng: Generator, lit: bool) -> Parts:
    """A car, a van or a pickup, with or without its lamps on."""
    shares = np.array([shape.share for shape in _SHAPES])
    shape = _SHAPES[int(rng.choice(len(shares), p=shares / shares.sum()))]
    paint = _paint(rng)
    glass = material(rng, str(rng.choice(["pane", "smoked", "smoked", "glass"])))
    low = 0.28
    hull = _loft(shape.hull, shape.width, low, shape.boxy)
    cabin = _loft(shape.cabin, shape.width, shape.hull[3][2] - 0.08, 0.55)
    shell = _loft(shape.cabin, shape.width, shape.hull[3][2] - 0.08, 0.55, 1.008)
    rows = len(shell)
    solid = [shell[int(0.25 * rows) : int(0.88 * rows), 5:10]]
    begin, end = (int(share * (rows - 1)) for share in shape.glazed)
    solid += [shell[max(k - 1, 0) : k + 1] for k in (int(0.28 * rows), rows // 2, int(0.82 * rows))]
    if end < rows - 1:
        solid.append(shell[end:])
    tyres, rims = wheels(shape.width, shape.wheels[:2], shape.wheels[2])
    front, back = shape.hull[1][0], shape.hull[-2][0]
    heads = [box((s * 0.66 * shape.width, 0.66, front + 0.03), (0.3, 0.13, 0.16)) for s in (-1, 1)]
    rear = [box((s * 0.74 * shape.width, 0.78, back), (0.2, 0.2, 0.12)) for s in (-1, 1)]
    dark = [box((0, 0.4, z), (1.5 * shape.width, 0.2, 0.1)) for z in (front - 0.03, back + 0.03)]
    plates = [box((0, 0.5, z), (0.5, 0.11, 0.02)) for z in (front - 0.09, back + 0.09)]
    covered = _loft(shape.hull, shape.width, low, shape.boxy, 1.006)[:, 4:11]
    under = (covered[:, 3, 2] > shape.cabin[0][0]) & (covered[:, 3, 2] < shape.cabin[-1][0])
    dark.append(surface(covered[under]))
    parts = [
        Part(joined([_capped(hull), *map(surface, solid)]), paint),
        Part(_capped(cabin[begin : end + 1]), glass),
        Part(tyres, material(rng, "tyre")),
        Part(joined([rims, *plates]), material(rng, "metal")),
        Part(joined(dark), material(rng, "tyre")),
        *lamps(rng, joined(heads), joined(rear), lit),
    ]
    if glass.clear:
        roof = shape.cabin[2][2]
        parts += interior(rng, shape.width, shape.hull[3][2], (roof, shape.cabin[1][0] + 0.45))
    stretch = rng.uniform((0.95, 0.92, 0.9), (1.06, 1.1, 1.1))
    return [Part(part.mesh.scaled(stretch), part.material) for part in parts]


def bus(rng: Generator, lit: bool) -> Parts:
    """A bus or a tram, with one floor or two."""
    length, width, height = rng.uniform((8, 1.2, 2.8), (14, 1.3, 3.2))
    decks = 2 if rng.random() < 0.2 else 1
    tall = height * (1 if decks == 1 else 1.42)
    ends = ((-length / 2, 0.9, 0.92 * tall), (-length / 2 + 0.25, 1, tall), (0, 1, tall),
            (length / 2 - 0.1, 1, tall), (length / 2, 0.95, 0.95 * tall))  # fmt: skip
    body = _capped(_loft(ends, width, 0.3, 0.12))
    panes, gaps = [], int(length // 1.5)
    for deck in range(decks):
        y = (1.5 + 0.42 * height * deck, 0.95)
        for k in range(gaps):
            z = -length / 2 + 0.9 + (length - 1.2) * (k + 0.5) / gaps
            span = (length - 1.2) / gaps - 0.12
            panes += [box((s * width, y[0] + 0.3, z), (0.03, y[1], span)) for s in (-1, 1)]
        for end in (-1, 1):
            panes.append(box((0, y[0] + 0.35, end * length / 2), (1.7 * width, 1.2, 0.16)))
    tyres, rims = wheels(width, (-0.33 * length, 0.27 * length), 0.48)
    sign = box((0, tall - 0.25, -length / 2 - 0.02), (1.2 * width, 0.28, 0.1))
    return [
        Part(body, _paint(rng)),
        Part(joined(panes), material(rng, "glass")),
        Part(tyres, material(rng, "tyre")),
        Part(rims, material(rng, "metal")),
        Part(sign, glowing(rng, "print_lines", 1.0)),
        *_corner_lamps(rng, (0.78 * width, 0.75), (-length / 2, length / 2), lit),
    ]


def lorry(rng: Generator, lit: bool) -> Parts:
    """A lorry with a closed box, a tank or a tarpaulin."""
    length, width, height = rng.uniform((4, 1.1, 2.2), (10, 1.28, 2.9))
    cab = _capped(_loft(
        ((-1.0, 0.92, 2.3), (-0.85, 1, 2.7), (0.7, 1, 2.8), (0.8, 0.98, 2.7)), width, 0.45, 0.18
    ))  # fmt: skip
    screen = box((0, 1.95, -0.99), (1.8 * width, 0.8, 0.12))
    sides = [box((s * width, 1.95, -0.35), (0.04, 0.7, 0.8)) for s in (-1, 1)]
    if rng.random() < 0.2:
        radius = 0.9 * width
        load = tube((0, 1 + radius, 1.4), (0, 1 + radius, length + 0.4), (radius, radius), 24)
    else:
        load = box((0, 1.0 + height / 2, 0.9 + length / 2), (2 * width, height, length))
    frame = box((0, 0.85, length / 2), (0.9, 0.25, length + 1.4))
    axles = (-0.2, length - 0.6, length + 0.5)
    tyres, rims = wheels(width, axles, 0.5)
    side = material(rng, str(rng.choice(["poster", "thing", "metal", "paint"])))
    side = Material(side.pattern, side.colours, (length, height), gloss=side.gloss)
    return [
        Part(cab, _paint(rng)),
        Part(joined([screen, *sides]), material(rng, "glass")),
        Part(load, side),
        Part(joined([tyres, frame]), material(rng, "tyre")),
        Part(rims, material(rng, "metal")),
        *_corner_lamps(rng, (0.75 * width, 0.8), (-1.0, length + 0.9), lit),
    ]


def _corner_lamps(
    rng: Generator, at: tuple[float, float], ends: tuple[float, float], lit: bool
) -> Parts:
    """Return a lamp at each lower corner: at so far out and up, at the front and the back."""
    front, back = (
        joined([box((s * at[0], at[1], z), (0.26, 0.16, 0.12)) for s in _SIDES]) for z in ends
    )
    return lamps(rng, front, back, lit)


def bicycle(rng: Generator) -> Parts:
    """A bicycle along z, with spokes, that leans a little."""
    angle = np.linspace(0, 2 * np.pi, 25)
    radius = float(rng.uniform(0.28, 0.36))
    hubs = [np.array([0, radius, z]) for z in (-0.52, 0.52)]
    ring = np.stack([0 * angle, np.sin(angle), np.cos(angle)], 1)
    tyres = [wire(hub + radius * ring, 0.018) for hub in hubs]
    start = np.concatenate(
        [hub + np.array([s * 0.03, 0, 0]) + 0 * ring[::2] for hub in hubs for s in _SIDES]
    )
    end = np.concatenate([hub + 0.97 * radius * ring[::2] for hub in hubs for _ in _SIDES])
    spokes = rods(start, end, 0.003)
    seat, pedal, head = np.array([(0, 0.92, 0.2), (0, 0.3, 0.05), (0, 0.88, -0.36)])
    pairs = ((seat, pedal), (pedal, head), (head, hubs[0]), (seat, hubs[1]), (pedal, hubs[1]),
             (seat - np.array([0, 0.1, 0]), head - np.array([0, 0.08, 0])))  # fmt: skip
    frame = [tube(a, b, (0.017, 0.017), 6) for a, b in pairs]
    bar = wire(head + np.array([(-0.3, 0.12, 0.16), (-0.27, 0.16, 0), (0, 0.14, -0.04),
                                (0.27, 0.16, 0), (0.3, 0.12, 0.16)]), 0.013)  # fmt: skip
    saddle = tube(
        seat + np.array([0, 0.06, 0.1]), seat + np.array([0, 0.05, -0.12]), (0.07, 0.025), 6
    )
    guards = [wire(hub + (radius + 0.04) * ring[2:12], 0.014) for hub in hubs]
    crank = revolved([(0, -0.01), (0.09, -0.01), (0.09, 0.01), (0, 0.01)], 16).turned(
        np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    ).placed(pedal + np.array([0.05, 0, 0]))  # fmt: skip
    shine = _paint(rng)
    parts = [
        Part(joined([*tyres, saddle]), material(rng, "tyre")),
        Part(joined([spokes, bar, crank]), material(rng, "metal")),
        Part(joined(frame + (guards if rng.random() < 0.5 else [])), shine),
    ]
    lean = rng.normal(0, 0.08)
    tipped = np.array([[1, lean, 0], [-lean, 1, 0], [0, 0, 1]]) / np.hypot(1, lean)
    return [Part(part.mesh.turned(tipped), part.material) for part in parts]


_ALL: tuple[tuple[float, Callable[[Generator, bool], Parts]], ...] = (
    (0.88, car),
    (0.06, bus),
    (0.06, lorry),
)


def vehicle(rng: Generator, lit: bool = False) -> Parts:
    """A car, van, bus or lorry, with or without its lamps on."""
    choice, left = _ALL[0][1], rng.random()
    for share, make in _ALL:
        if left < share:
            return make(rng, lit)
        left -= share
    return choice(rng, lit)
