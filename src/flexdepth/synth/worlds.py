"""The kinds of scenes, and how often each is rendered.

A new kind is a function from a generator to a `Scene`, and one line in a table here. Its name is
the function's.
"""

from collections.abc import Callable

from numpy.random import Generator

from flexdepth.synth.close_ups import close_up, flowers, hoop
from flexdepth.synth.landscapes import landscape
from flexdepth.synth.open_places import car_park, park, square
from flexdepth.synth.rooms import cellar, cookery, corridor, home, office, shop
from flexdepth.synth.scene import Scene
from flexdepth.synth.stairwells import stairs
from flexdepth.synth.streets import street

Make = Callable[[Generator], Scene]

INDOORS: tuple[tuple[float, Make], ...] = (
    (0.3, home),
    (0.17, office),
    (0.2, cookery),
    (0.07, shop),
    (0.06, corridor),
    (0.2, cellar),
    (0.07, stairs),
)
"""Kinds of scenes under a roof, each with its share; only the shares' ratios count."""

OUTDOORS: tuple[tuple[float, Make], ...] = (
    (0.4, street),
    (0.24, landscape),
    (0.1, park),
    (0.07, square),
    (0.03, car_park),
    (0.07, flowers),
    (0.08, close_up),
    (0.01, hoop),
)
"""Kinds of scenes under the sky, likewise."""


def drawn(rng: Generator, outdoor_share: float) -> Make:
    """Return a random kind: one of `OUTDOORS` with the given probability, else of `INDOORS`."""
    table = OUTDOORS if rng.random() < outdoor_share else INDOORS
    total = sum(share for share, _ in table)
    left = rng.random() * total
    for share, make in table:
        left -= share
        if left < 0:
            return make
    return table[-1][1]
