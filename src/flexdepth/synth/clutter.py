"""Small things strewn over surfaces."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.devices import keyboard, laptop, monitor
from flexdepth.synth.materials import Part
from flexdepth.synth.parts import Maker, Parts, bounds, chosen, placed
from flexdepth.synth.small_things import (
    block,
    book,
    bottle,
    cable,
    cloth,
    cup,
    framed,
    fruit,
    gadget,
    jar,
    packet,
    pens,
    plate,
    sheets,
    shoes,
    tin,
)

ON_TABLES: tuple[Maker, ...] = (
    cup, cup, cup, bottle, bottle, tin, plate, fruit, sheets, sheets, sheets, book, book, packet,
    packet, framed, pens, gadget, gadget, cable, cloth, jar, laptop, block,
)  # fmt: skip
ON_DESKS: tuple[Maker, ...] = (
    monitor, monitor, laptop, keyboard, keyboard, sheets, sheets, sheets, book, cup, pens, gadget,
    cable, cable, bottle, framed, packet,
)  # fmt: skip
IN_KITCHENS: tuple[Maker, ...] = (
    cup, cup, bottle, bottle, plate, plate, fruit, packet, packet, packet, tin, jar, gadget, cloth,
    pens, sheets, framed, block,
)  # fmt: skip
IN_SHELVES: tuple[Maker, ...] = (
    packet, packet, tin, tin, bottle, jar, book, book, gadget, framed, cloth, block, block,
)  # fmt: skip

ON_FLOORS: tuple[Maker, ...] = (
    packet, bottle, sheets, book, gadget, cable, cable, cloth, cloth, fruit, tin, block, shoes,
    shoes,
)  # fmt: skip


def clutter(
    rng: Generator,
    size: tuple[float, float],
    count: int,
    tallest: float = 0.4,
    things: tuple[Maker, ...] = ON_TABLES,
) -> Parts:
    """Small things on a surface of the given width and depth at y = 0, none over `tallest`."""
    parts: Parts = []
    for _ in range(count):
        thing = chosen(rng, things)
        low, high = bounds(thing)
        if high[1] > tallest:
            thing = [Part(p.mesh.scaled((tallest / high[1],) * 3), p.material) for p in thing]
        room = np.maximum(np.asarray(size) - 0.8 * (high - low)[[0, 2]], 0.02)
        x, z = rng.uniform(-0.5, 0.5, 2) * room
        parts += placed(thing, (float(x), 0.0, float(z)), float(rng.normal(0, 0.35)))
    return parts
