"""Parks, squares and car parks: level places between buildings or trees."""

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.random import Generator

from flexdepth.synth.buildings import building
from flexdepth.synth.bystanders import bird, bystander, pet
from flexdepth.synth.field_things import rock
from flexdepth.synth.flowers import bed, daisy
from flexdepth.synth.head_lights import head_lights
from flexdepth.synth.landscapes import under
from flexdepth.synth.materials import Material, Part, material
from flexdepth.synth.outdoor_things import fence, pole
from flexdepth.synth.parts import Maker, Parts, placed
from flexdepth.synth.place_things import (
    cafe,
    colonnade,
    fountain,
    playground,
    statue,
    steps,
)
from flexdepth.synth.scene import AreaLight, Scene, Spot
from flexdepth.synth.shapes import (
    Array,
    Mesh,
    blob,
    draped,
    joined,
    quad,
)
from flexdepth.synth.skies import Weather, weather
from flexdepth.synth.stock import stocked
from flexdepth.synth.street_things import (
    bench,
    bin_,
    bollards,
    bus_stop,
    hedge,
    hoarding,
    lamp_post,
    letter_box,
    stall,
)
from flexdepth.synth.trees import far_tree, shrub, tree
from flexdepth.synth.vehicles import bicycle, vehicle

_FAR = 600.0

Crowd = tuple[tuple[float, Maker], ...]


_PARK: Crowd = (
    (14.0, tree), (8.0, shrub), (3.0, bench), (1.5, bin_), (5.0, bystander), (1.5, pet),
    (1.0, bicycle), (1.2, hedge), (1.2, playground), (0.4, statue), (0.5, fountain), (1.0, fence),
    (0.6, rock), (0.5, bird), (0.4, hoarding), (0.4, steps),
)  # fmt: skip
_SQUARE: Crowd = (
    (14.0, bystander), (2.0, tree), (2.0, bench), (1.5, bin_), (3.0, stall), (4.0, cafe),
    (1.0, bollards), (0.7, statue), (0.6, fountain), (1.0, pole), (1.5, bicycle), (0.8, bus_stop),
    (0.8, hoarding), (0.6, letter_box), (0.8, vehicle), (0.6, colonnade), (0.6, steps), (0.5, pet),
    (0.5, bird), (0.6, hedge),
)  # fmt: skip


def park(rng: Generator) -> Scene:
    """Return a park or a garden with lawns, paths, trees and people."""
    above = weather(rng)
    lawn = material(rng, "grass" if rng.random() < 0.85 else str(rng.choice(["soil", "snow"])))
    parts = _plane(lawn, rng.uniform(10, 40))
    look = material(rng, str(rng.choice(["gravel", "pavement", "asphalt", "soil"])))
    parts += [Part(_walk(rng), look) for _ in range(int(rng.integers(1, 4)))]
    parts += _scattered(rng, _PARK, (2.5, 60))
    if rng.random() < 0.5:
        middle = rng.uniform(-12, 12, 3) * (1, 0, 1)
        around = rng.normal(0, 1.5, (int(rng.integers(20, 120)), 3)) * (1, 0, 1)
        parts += bed(rng, daisy, middle + around)
    parts += _around(rng, above.dark, rng.random() < 0.5)
    return _lit(rng, parts, above)


def square(rng: Generator) -> Scene:
    """Return a square with people, stalls and tables between houses, or a yard."""
    above = weather(rng)
    parts = _plane(material(rng, "pavement"), 1.0)
    parts += _scattered(rng, _SQUARE, (2.5, 28))
    parts += _around(rng, above.dark, True, float(rng.uniform(14, 45)))
    return _lit(rng, parts, above)


def car_park(rng: Generator) -> Scene:
    """Return rows of parked cars, with some people between them."""
    above = weather(rng)
    parts = _plane(material(rng, "asphalt"), 4.0)
    cars, moving = stocked(vehicle, 12), stocked(partial(vehicle, lit=above.dark), 3)
    apart, row = rng.uniform(2.4, 3.2), rng.uniform(9, 14)
    marks = []
    spots: list[Spot] = []
    for z in np.arange(-3, 4) * row + row / 2:
        full = rng.uniform(0.3, 1)
        for x in np.arange(-45, 45, apart):
            marks.append(quad((x, 0.006, z - 2.4), (0.1, 0, 0), (0, 0, 4.8)))
            if rng.random() < full and np.hypot(x, z) > 4:
                facing = np.pi * int(rng.integers(2)) + rng.normal(0, 0.03)
                spot = (x + apart / 2, 0, z + rng.normal(0, 0.2))
                make = moving if rng.random() < 0.06 else cars
                made = make(rng)
                parts += placed(made, spot, facing)
                spots += head_lights(made, spot, facing)
    parts.append(Part(joined(marks), material(rng, "paint")))
    crowd: Crowd = ((3.0, bystander), (3.0, pole), (2.0, tree), (1.0, bin_), (1.0, hedge))
    parts += _scattered(rng, crowd, (3, 40))
    parts += _around(rng, above.dark, rng.random() < 0.7, float(rng.uniform(45, 70)))
    return replace(_lit(rng, parts, above), spots=tuple(spots), dark=above.dark)


def _plane(look: Material, grown: float) -> Parts:
    """Return level ground, its pattern larger farther off."""
    far = replace(look, size=(look.size[0] * grown, look.size[1] * grown))
    outer = quad((-_FAR, -0.02, -_FAR), (2 * _FAR, 0, 0), (0, 0, 2 * _FAR))
    return [
        Part(quad((-25, 0, -25), (50, 0, 0), (0, 0, 50)), look),
        Part(outer, far),
    ]


def _walk(rng: Generator) -> Mesh:
    """Return a path that winds over level ground."""
    s = np.linspace(-60, 60, 60)
    yaw, wave, half = rng.uniform((0, 15, 0.6), (6.3, 80, 2.5))
    aside = rng.uniform(-8, 8) + rng.uniform(0, 6) * np.sin(6.3 * s / wave)
    rows = [
        np.stack(
            [s * np.cos(yaw) - x * np.sin(yaw), 0 * s + 0.01, s * np.sin(yaw) + x * np.cos(yaw)], -1
        )
        for x in (aside - half, aside + half)
    ]
    return draped(np.stack(rows))


def _scattered(rng: Generator, crowd: Crowd, reach: tuple[float, float]) -> Parts:
    """Return so many of each on average, thicker near the middle."""
    parts: Parts = []
    for often, make in crowd:
        one = stocked(make, 5)
        # Nobody stands in a crown.
        nearest = 5.0 if make in (tree, hedge, colonnade, vehicle) else reach[0]
        for x, z in _spots(rng, int(rng.poisson(often)), (nearest, reach[1])):
            parts += placed(one(rng), (x, 0, z), rng.uniform(0, 6.3))
    return parts


def _spots(rng: Generator, count: int, reach: tuple[float, float]) -> Array:
    away = reach[0] + (reach[1] - reach[0]) * rng.random(count) ** 1.3
    yaw = rng.uniform(0, 2 * np.pi, count)
    return np.stack([away * np.sin(yaw), away * np.cos(yaw)], 1)


def _around(rng: Generator, dark: bool, built: bool, away: float = 75.0) -> Parts:
    """Return what surrounds a place: houses on some sides, trees, hills."""
    parts: Parts = []
    lit = float(rng.uniform(0.15, 0.7)) if dark else 0.0
    for yaw in np.arange(4) * np.pi / 2:
        if built and rng.random() < 0.75:
            x = -away
            while x < away:
                wide = float(rng.uniform(8, 22))
                front = np.array([np.sin(yaw), 0, np.cos(yaw)]) * away
                along = np.array([np.cos(yaw), 0, -np.sin(yaw)]) * (x + wide / 2)
                parts += placed(building(rng, wide, lit), tuple(front + along), float(yaw))
                x += wide + (0.0 if rng.random() < 0.6 else rng.exponential(8))
    woods = stocked(far_tree, 3)
    for x, z in _spots(rng, int(rng.integers(0, 60)), (away + 20, away + 200)):
        parts += placed(woods(rng), (x, 0, z), 0.0)
    for _ in range(int(rng.integers(0, 4))):
        size, yaw = rng.uniform((100, 20, 60), (400, 90, 150)), rng.uniform(0, 6.3)
        spot = rng.uniform(250, 450) * np.array([np.sin(yaw), 0, np.cos(yaw)])
        parts.append(Part(blob(rng, size, 0.05, 20).placed(spot), material(rng, "wood far")))
    return parts


def _lit(rng: Generator, parts: Parts, above: Weather) -> Scene:
    """Return a place under the weather, with lamps where it is dark."""
    lamps = []
    if rng.random() < (0.9 if above.dark else 0.4):
        model, light = lamp_post(rng, above.dark)
        tint = np.array([1.0, rng.uniform(0.6, 1.0), rng.uniform(0.3, 1.0)])
        strength = rng.uniform(4, 14)
        for x, z in _spots(rng, int(rng.integers(2, 6)), (4, 25)):
            parts = parts + placed(model, (x, 0, z))
            if above.dark:
                at = np.array([x + light[0], light[1], z])
                lamps.append(AreaLight(at, 0.3, tint * strength * light[1]))
    return replace(under(rng, parts, above), lamps=lamps, variety=5)
