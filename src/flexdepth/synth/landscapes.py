"""Open ground under the sky: meadows, fields, woods, shores, deserts, mountains and snow."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from flexdepth.synth.bystanders import animal, bird, bystander
from flexdepth.synth.field_things import bale, barn, log, rock
from flexdepth.synth.flowers import bed, daisy, grass, herb
from flexdepth.synth.materials import Part, material
from flexdepth.synth.outdoor_things import fence, pole
from flexdepth.synth.parts import Parts, placed
from flexdepth.synth.scene import Scene
from flexdepth.synth.shapes import Array, Mesh, draped, quad
from flexdepth.synth.skies import Weather, weather
from flexdepth.synth.stock import stocked
from flexdepth.synth.terrain import Terrain
from flexdepth.synth.trees import far_tree, shrub, tree
from flexdepth.synth.viewpoints import ON_FOOT

Make = Callable[[Generator], Parts]

_FAR = 1500.0
"""Metres to where the land ends."""


@dataclass(frozen=True)
class Land:
    """What makes open ground a meadow or a desert.

    Attributes:
        share: How often it is made.
        ground: Materials of the land near by, each as likely.
        afar: Materials of the land from some hundred metres on.
        relief: Least and most height of its swell, metres.
        peaks: Least and most height of what closes the view, metres.
        water: How often there is a lake or a sea.
        near: What stands within sixty metres: how many of each, on average.
        woods: Least and most trees that are far away.
        blades: Least and most blades of grass near by, and their greatest height in metres.
    """

    share: float
    ground: tuple[str, ...]
    afar: tuple[str, ...]
    relief: tuple[float, float]
    peaks: tuple[float, float]
    water: float
    near: tuple[tuple[float, Make], ...]
    woods: tuple[int, int]
    blades: tuple[int, int, float]


_GREEN: tuple[tuple[float, Make], ...] = (
    (4.0, tree), (5.0, shrub), (0.8, rock), (1.2, bystander), (1.0, animal), (1.6, fence),
    (0.6, barn), (0.6, pole), (0.3, bird), (0.3, log),
)  # fmt: skip
_LANDS: dict[str, Land] = {
    "meadow": Land(
        0.27,
        ("grass", "grass", "straw"),
        ("grass", "wood far", "grass"),
        (2, 14),
        (0, 90),
        0.12,
        _GREEN,
        (20, 140),
        (1000, 9000, 0.5),
    ),
    "farmland": Land(
        0.14,
        ("straw", "soil", "grass"),
        ("grass", "straw", "soil"),
        (1, 8),
        (0, 60),
        0.05,
        (
            (6.0, bale),
            (2.0, tree),
            (2.5, shrub),
            (0.7, bystander),
            (1.5, pole),
            (1.2, barn),
            (1.2, fence),
        ),
        (10, 100),
        (0, 7000, 0.6),
    ),
    "woods": Land(
        0.16,
        ("soil", "grass", "autumn"),
        ("wood far",),
        (1, 10),
        (0, 120),
        0.08,
        ((26.0, tree), (9.0, shrub), (1.5, log), (1.5, rock), (0.8, bystander), (0.4, animal)),
        (80, 240),
        (0, 3000, 0.3),
    ),
    "shore": Land(
        0.17,
        ("sand", "gravel", "grass", "rock"),
        ("grass", "wood far", "sand"),
        (1, 8),
        (0, 160),
        1.0,
        ((1.0, tree), (2.0, shrub), (4.0, rock), (1.6, bystander), (0.6, bird), (0.8, log)),
        (0, 120),
        (0, 2500, 0.6),
    ),
    "desert": Land(
        0.08,
        ("sand", "soil", "gravel"),
        ("sand", "rock"),
        (3, 30),
        (0, 150),
        0.0,
        ((5.0, rock), (4.0, shrub), (0.5, bystander), (0.5, pole), (0.3, animal)),
        (0, 4),
        (0, 600, 0.3),
    ),
    "mountains": Land(
        0.12,
        ("grass", "rock", "gravel"),
        ("rock", "wood far", "snow"),
        (4, 40),
        (150, 520),
        0.25,
        ((7.0, rock), (2.0, tree), (3.0, shrub), (0.8, bystander), (0.5, animal), (0.2, barn)),
        (10, 140),
        (0, 5000, 0.3),
    ),
    "snow": Land(
        0.06,
        ("snow",),
        ("snow", "wood far"),
        (2, 15),
        (0, 300),
        0.05,
        ((2.5, tree), (1.0, rock), (1.0, bystander), (0.6, fence), (0.4, barn), (0.4, pole)),
        (10, 140),
        (0, 200, 0.2),
    ),
}


def landscape(rng: Generator) -> Scene:
    """Return open ground with sky, hills and what grows and stands there."""
    shares = np.array([land.share for land in _LANDS.values()])
    land = list(_LANDS.values())[int(rng.choice(len(shares), p=shares / shares.sum()))]
    ground = _terrain(rng, land)
    parts = _surface(rng, land, ground)
    parts += _growing(rng, land, ground)
    parts += _standing(rng, land, ground)
    if rng.random() < 0.4:
        parts.append(_path(rng, ground))
    return under(rng, parts, weather(rng))


def under(rng: Generator, parts: Parts, above: Weather) -> Scene:
    """Return a scene of the parts under the weather, with walkers' cameras in the middle."""
    return Scene(
        parts=parts,
        lamps=[],
        sun=above.sun,
        ambient=above.ambient,
        occlusion_reach=float(rng.uniform(0.5, 4)),
        horizon=above.horizon,
        zenith=above.zenith,
        clouds=above.clouds,
        eyes=(np.array([-3.0, 1.2, -3.0]), np.array([3.0, 1.8, 3.0])),
        outdoors=True,
        gloom=above.gloom,
        haze=above.haze,
        carriers=ON_FOOT,
        variety=3,
    )


def _terrain(rng: Generator, land: Land) -> Terrain:
    peaks = float(rng.uniform(*land.peaks)) if rng.random() < 0.75 else 0.0
    bare = Terrain.drawn(rng, float(rng.uniform(*land.relief)), peaks, float(rng.uniform(3.5, 20)))
    if rng.random() > land.water:
        return bare
    wide = float(rng.choice([3000.0, rng.uniform(40, 400)]))
    shore = float(bare.level + rng.exponential(8))
    return replace(bare, basin=(float(rng.uniform(0, 6.3)), shore, wide, 6.0))


def _surface(rng: Generator, land: Land, ground: Terrain) -> Parts:
    """Return the land's surface in patches of several materials, and the water."""
    looks = [material(rng, str(rng.choice(land.ground))) for _ in range(2)]
    patches = _patches(rng)
    beyond = [material(rng, str(rng.choice(land.afar))) for _ in range(3)]
    near, middle = rng.uniform((8, 40), (20, 150))
    parts: Parts = []
    # The same ground is seen with ever larger patterns, lest one repeats a hundred times.
    for mesh, kinds, grown in (
        (ground.mesh(0.0, near), looks, 1.0),
        (ground.mesh(near, middle), looks, rng.uniform(3, 6)),
        (ground.mesh(middle, _FAR), beyond, rng.uniform(8, 20)),
    ):
        label = patches(mesh)
        for number in np.unique(label):
            own = label == number
            look = kinds[int(number) % len(kinds)]
            size = look.size[0] * grown, look.size[1] * grown
            parts.append(Part(Mesh(mesh.corners[own], mesh.uv[own]), replace(look, size=size)))
    if ground.basin[3]:
        sea = quad((-_FAR, -0.45, -_FAR), (2 * _FAR, 0, 0), (0, 0, 2 * _FAR))
        parts.append(Part(sea, material(rng, "lake")))
    return parts


def _patches(rng: Generator) -> Callable[[Mesh], Array]:
    """Return a map of what the ground is: islands, or fields with straight edges."""
    if rng.random() < 0.3:
        yaw, wide = rng.uniform(0, 3.2), rng.uniform(15, 120)

        def fields(mesh: Mesh) -> Array:
            x, z = mesh.corners[:, :, [0, 2]].mean(1).T
            along, across = x * np.cos(yaw) + z * np.sin(yaw), z * np.cos(yaw) - x * np.sin(yaw)
            return np.asarray((np.floor(along / wide) * 7 + np.floor(across / wide / 2) * 3) % 6)

        return fields
    yaws, phases = rng.uniform(0, 6.3, (2, 5))
    numbers = 6.3 / rng.uniform(8, 200, 5)
    level = rng.uniform(0.2, 0.7)

    def islands(mesh: Mesh) -> Array:
        x, z = mesh.corners[:, :, [0, 2]].mean(1).T
        place = x[:, None] * np.cos(yaws) + z[:, None] * np.sin(yaws)
        noise = np.sin(place * numbers + phases).mean(1)
        return np.asarray(np.clip(np.floor((noise + level) * 3), 0, 2))

    return islands


def _growing(rng: Generator, land: Land, ground: Terrain) -> Parts:
    """Return woods far away, and grass and flowers near by."""
    parts: Parts = []
    count = int(rng.integers(land.woods[0], land.woods[1] + 1))
    spots = _dry(ground, ground.spots(rng, count, (70, 900)))
    if rng.random() < 0.6 and count:
        spots = np.concatenate([spots, _treeline(rng, ground)])
    parts += bed(rng, far_tree, spots, 4)
    low, high, tall = land.blades
    blades = int(rng.integers(low, high + 1)) if rng.random() < 0.6 else 0
    if blades:
        lawn = grass(rng, _dry(ground, ground.spots(rng, blades, (0.8, 14))), tall * rng.random())
        parts.append(Part(lawn, material(rng, str(rng.choice(["leaf", "leaf", "straw"])))))
    if blades and rng.random() < 0.4:
        make = daisy if rng.random() < 0.7 else herb
        parts += bed(rng, make, _dry(ground, ground.spots(rng, int(rng.integers(20, 90)), (1, 12))))
    return parts


def _treeline(rng: Generator, ground: Terrain) -> Array:
    """Return spots of trees in a row that crosses the view."""
    count = int(rng.integers(20, 80))
    yaw, away = rng.uniform(0, 6.3), rng.uniform(60, 350)
    along = np.cumsum(rng.exponential(5, count)) - 2.5 * count
    x = away * np.sin(yaw) + along * np.cos(yaw) + rng.normal(0, 3, count)
    z = away * np.cos(yaw) - along * np.sin(yaw) + rng.normal(0, 3, count)
    return _dry(ground, np.stack([x, ground.height(x, z), z], 1))


def _dry(ground: Terrain, spots: Array) -> Array:
    return spots[spots[:, 1] > -0.35] if ground.basin[3] else spots


def _standing(rng: Generator, land: Land, ground: Terrain) -> Parts:
    """Return what stands within sixty metres, and farther off where it is large."""
    parts: Parts = []
    for often, make in land.near:
        # Nobody stands inside a house, or in a crown.
        nearest = 30.0 if make is barn else 5.0 if make is tree else 2.5
        reach = nearest, 180.0 if make is barn else 60.0
        several = stocked(make, 6)
        for at in _dry(ground, ground.spots(rng, int(rng.poisson(often)), reach)):
            parts += placed(several(rng), tuple(at), rng.uniform(0, 6.3))
    return parts


def _path(rng: Generator, ground: Terrain) -> Part:
    """Return a path or a track that winds through the middle."""
    s = np.linspace(-70, 70, 90)
    yaw, wave = rng.uniform(0, 6.3), rng.uniform(20, 90)
    aside = rng.uniform(0, 8) * np.sin(6.3 * s / wave + rng.uniform(0, 6.3))
    half = rng.uniform(0.4, 2.2)
    rows = []
    for edge in (-half, 0, half):
        x = s * np.cos(yaw) - (aside + edge) * np.sin(yaw)
        z = s * np.sin(yaw) + (aside + edge) * np.cos(yaw)
        rows.append(np.stack([x, ground.height(x, z) + 0.015, z], -1))
    return Part(
        draped(np.stack(rows)), material(rng, str(rng.choice(["soil", "gravel", "asphalt"])))
    )
