"""Streets: a road along z between pavements, houses, gardens, trees and parked cars."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.random import Generator

from flexdepth.synth.buildings import building
from flexdepth.synth.bystanders import bystander
from flexdepth.synth.head_lights import head_lights
from flexdepth.synth.landscapes import under
from flexdepth.synth.materials import Part, material
from flexdepth.synth.outdoor_things import fence, pole
from flexdepth.synth.parts import Maker, Parts, placed
from flexdepth.synth.scene import AreaLight, Scene, Spot
from flexdepth.synth.shapes import Mesh, blob, box, joined, quad
from flexdepth.synth.skies import weather
from flexdepth.synth.stock import stocked
from flexdepth.synth.street_things import (
    bench,
    bin_,
    bollards,
    bus_stop,
    cables,
    hedge,
    hoarding,
    lamp_post,
    letter_box,
    stall,
)
from flexdepth.synth.trees import far_tree, shrub, tree
from flexdepth.synth.vehicles import bicycle, vehicle
from flexdepth.synth.viewpoints import ON_ROADS

_REACH = 140.0
"""Metres of street in front of and behind the middle."""


_WAITING = 0.12
"""Share of the vehicles at the kerb whose driver has only stopped."""


@dataclass(frozen=True)
class _Cast:
    """What a street is filled with: a few individuals of each kind."""

    tree: Maker
    shrub: Maker
    hedge: Maker
    parked: Maker
    driven: Maker
    bicycle: Maker
    person: Maker
    furniture: Maker

    @classmethod
    def drawn(cls, dark: bool) -> "_Cast":
        """Return a cast that is made as it is called for; what drives in the dark is lit."""
        parked = stocked(vehicle, 10)
        return cls(
            tree=stocked(tree, 5),
            shrub=stocked(shrub, 4),
            hedge=stocked(hedge, 2),
            parked=parked,
            driven=stocked(partial(vehicle, lit=True), 8) if dark else parked,
            bicycle=stocked(bicycle, 2),
            person=stocked(bystander, 7),
            furniture=stocked(_furniture, 6),
        )


def street(rng: Generator) -> Scene:
    """Return a street, a country road or a yard, with the camera on the road or the pavement."""
    half_road = rng.uniform(2.2, 8.0)
    pavement = rng.uniform(0.0, 4.0) if rng.random() < 0.8 else 0.0
    above = weather(rng)
    lit = float(rng.uniform(0.15, 0.7)) if above.dark else 0.0
    parts = _ground(rng, half_road, pavement)
    cast = _Cast.drawn(above.dark)
    spots: list[Spot] = []
    for side in (-1, 1):
        parts += _roadside(rng, cast, side, (half_road, pavement), lit)
        stopped, ahead = _parked(rng, cast, side, half_road)
        parts, spots = parts + stopped, spots + ahead
    moving, ahead = _traffic(rng, cast, half_road)
    parts, spots = parts + moving, spots + ahead
    if rng.random() < 0.25:
        parts += cables(rng, _REACH, half_road + pavement + 0.3)
    parts += _far(rng)
    posts, lamps = _lamp_posts(rng, half_road, above.dark)
    parts += posts
    x = half_road + pavement * 0.7
    scene = under(rng, parts, above)
    return replace(
        scene,
        lamps=lamps,
        eyes=(np.array([-x, 1.0, -25.0]), np.array([x, 2.0, 25.0])),
        carriers=ON_ROADS,
        variety=6,
        road=half_road,
        spots=tuple(spots),
        dark=above.dark,
    )


def _ground(rng: Generator, half_road: float, pavement: float) -> Parts:
    """Return land to the horizon, road, lane marks, kerbs and pavements."""
    far = 600.0
    land = material(rng, str(rng.choice(["grass", "pavement", "asphalt"])))
    parts = [Part(quad((-far, -0.03, -far), (2 * far, 0, 0), (0, 0, 2 * far)), land)]
    road = quad((-half_road, 0, -far), (2 * half_road, 0, 0), (0, 0, 2 * far))
    parts.append(Part(road, material(rng, "asphalt")))
    if rng.random() < 0.7:
        parts.append(Part(_marks(rng, half_road), material(rng, "paint")))
    if pavement > 0.5:
        stone = material(rng, "pavement")
        kerb = rng.uniform(0.06, 0.16)
        for side in (-1, 1):
            middle = side * (half_road + pavement / 2)
            slab = box((middle, kerb / 2, 0), (pavement, kerb, 2 * _REACH))
            parts.append(Part(slab, stone))
    return parts


def _marks(rng: Generator, half_road: float) -> Mesh:
    """Return dashes in the middle and lines at the edges of the road."""
    dash, gap, wide = rng.uniform((1.5, 1.5, 0.08), (6, 8, 0.2))
    lanes = [0.0] if half_road < 5 else [-half_road / 2, 0.0, half_road / 2]
    starts = np.arange(-_REACH, _REACH, dash + gap)
    marks = [
        quad((x - wide / 2, 0.006, z), (wide, 0, 0), (0, 0, dash)) for x in lanes for z in starts
    ]
    if rng.random() < 0.5:
        edge = half_road - 0.3
        marks += [
            quad((s * edge - wide / 2, 0.006, -_REACH), (wide, 0, 0), (0, 0, 2 * _REACH))
            for s in (-1, 1)
        ]
    return joined(marks)


def _lamp_posts(rng: Generator, half_road: float, dark: bool) -> tuple[Parts, list[AreaLight]]:
    """Return a row of street lamps; in the dark those near the cameras light the street."""
    if rng.random() < (0.1 if dark else 0.55):
        return [], []
    parts: Parts = []
    lamps = []
    model, light = lamp_post(rng, dark)
    tint = np.array([1.0, rng.uniform(0.6, 1.0), rng.uniform(0.25, 1.0)])
    apart, strength = rng.uniform(18, 40), rng.uniform(6, 25)
    for k, z in enumerate(np.arange(-_REACH, _REACH, apart)):
        side = 1 if k % 2 else -1
        spot, yaw = (side * (half_road + 0.4), 0.0, z), 0.0 if side < 0 else np.pi
        parts += placed(model, spot, yaw)
        if dark and abs(z) < 45:
            at = np.array([spot[0] - side * light[0], light[1], z])
            lamps.append(AreaLight(at, 0.3, tint * strength * light[1]))
    return parts, lamps


def _roadside(
    rng: Generator, cast: _Cast, side: int, widths: tuple[float, float], lit: float
) -> Parts:
    """Return what lines one side of the road: houses, gardens, trees, poles, cars, people."""
    half_road, pavement = widths
    kerb = half_road + pavement
    setback = kerb + (rng.exponential(1.5) if rng.random() < 0.5 else rng.uniform(3, 15))
    built = rng.choice([0.15, 0.6, 0.95])
    yaw = side * np.pi / 2
    parts: Parts = []
    z = -_REACH
    while z < _REACH:
        width = rng.uniform(6, 22)
        if rng.random() < built:
            parts += placed(building(rng, width, lit), (side * setback, 0, z + width / 2), yaw)
        elif rng.random() < 0.5:
            for _ in range(int(rng.integers(1, 4))):
                spot = (side * (setback + rng.exponential(8)), 0, z + rng.uniform(0, width))
                parts += placed((cast.tree if rng.random() < 0.6 else cast.shrub)(rng), spot)
        z += width + (0.05 if rng.random() < 0.5 else rng.exponential(6))
    things: tuple[tuple[Maker, float, float, float], ...] = (
        (cast.tree, kerb - 0.6 + 0.3 * (setback - kerb), rng.choice([0, 0.02, 0.08]), 0),
        (pole, kerb - 0.3 * pavement, 0.04, yaw - np.pi / 2),
        (cast.shrub, (kerb + setback) / 2, rng.choice([0, 0.06]), yaw),
        (fence, setback - 0.4, rng.choice([0, 0.03]), yaw),
        (cast.person, kerb - 0.5 * pavement, rng.choice([0.01, 0.05]), 0),
        (cast.bicycle, kerb - 0.4 * pavement, rng.choice([0.005, 0.03]), 0),
        (cast.hedge, setback - 0.6, rng.choice([0, 0.015]), yaw),
        (cast.furniture, kerb - 0.3 * pavement, rng.choice([0.01, 0.04]), yaw),
    )
    for make, x, density, heading in things:
        for _ in range(int(rng.poisson(density * 2 * _REACH))):
            spot = (side * (x + rng.normal(0, 0.4)), 0, rng.uniform(-_REACH, _REACH))
            parts += placed(make(rng), spot, heading + rng.normal(0, 0.15))
    return parts


_FURNITURE = (bench, bin_, bin_, letter_box, bollards, bus_stop, hoarding, stall)


def _furniture(rng: Generator) -> Parts:
    return _FURNITURE[int(rng.integers(len(_FURNITURE)))](rng)


def _parked(rng: Generator, cast: _Cast, side: int, half_road: float) -> tuple[Parts, list[Spot]]:
    """Return the vehicles at one kerb, and the light of those that have only stopped."""
    density = rng.choice([0.0, 0.3, 0.8])
    parts: Parts = []
    spots: list[Spot] = []
    z = -_REACH
    while half_road > 2.8 and z < _REACH:
        if rng.random() < density:
            yaw = (0 if side > 0 else np.pi) + rng.normal(0, 0.04)
            make = cast.driven if rng.random() < _WAITING else cast.parked
            made, at = make(rng), (side * (half_road - 1.0), 0, z)
            parts += placed(made, at, yaw)
            spots += head_lights(made, at, yaw)
        z += rng.uniform(5, 8)
    return parts, spots


def _traffic(rng: Generator, cast: _Cast, half_road: float) -> tuple[Parts, list[Spot]]:
    """Return vehicles and people on the road, and the light of the vehicles."""
    parts: Parts = []
    spots: list[Spot] = []
    for _ in range(int(rng.poisson(rng.choice([0, 3, 10])))):
        side = int(rng.choice([-1, 1]))
        x = side * half_road * rng.uniform(0.25, 0.55)
        yaw = (0 if side > 0 else np.pi) + rng.normal(0, 0.08)
        made, at = cast.driven(rng), (x, 0, rng.uniform(-_REACH, _REACH))
        parts += placed(made, at, yaw)
        spots += head_lights(made, at, yaw)
    for _ in range(int(rng.poisson(0.8))):
        spot = (rng.uniform(-half_road, half_road), 0, rng.uniform(-40, 40))
        parts += placed(
            (cast.person if rng.random() < 0.7 else cast.bicycle)(rng), spot, rng.uniform(0, 6.3)
        )
    return parts, spots


def _far(rng: Generator) -> Parts:
    """Return what closes the view: hills, a wood, or a row of buildings."""
    woods = stocked(far_tree, 3)
    parts: Parts = []
    for end in (-1, 1):
        kind = rng.random()
        if kind < 0.4:
            for _ in range(int(rng.integers(2, 5))):
                size = rng.uniform((100, 20, 60), (400, 90, 150))
                spot = (rng.uniform(-200, 200), 0, end * rng.uniform(250, 450))
                parts.append(Part(blob(rng, size, 0.05, 20).placed(spot), material(rng, "grass")))
        elif kind < 0.7:
            yaw = 0.0 if end > 0 else np.pi
            for x in range(-60, 60, 16):
                parts += placed(
                    building(rng, 15, 0.0), (x, 0, end * (_REACH + rng.uniform(2, 10))), yaw
                )
        for _ in range(int(rng.integers(0, 12))):
            spot = (rng.normal(0, 40), 0, end * (_REACH + rng.uniform(0, 60)))
            parts += placed(woods(rng), spot)
    return parts
