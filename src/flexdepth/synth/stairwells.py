"""Stairs: flights, landings and railings in a stairwell or a hall, from homes to cellars."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.bystanders import bystander
from flexdepth.synth.ceilings import lamps
from flexdepth.synth.fixtures import bag, bicycle, board, plant, radiator
from flexdepth.synth.flights import WAIST, Build, cast, closed, cupboard, flight_parts, open_risers
from flexdepth.synth.furniture import AGAINST_WALLS, OFFICES, STORED
from flexdepth.synth.landings import Landing, Plan, open_edges
from flexdepth.synth.materials import Material, Part, material
from flexdepth.synth.parts import Maker, Parts, bounds, chosen, placed
from flexdepth.synth.railings import Fill, Railing, balusters, bars, parapet, railing, sheet, turned
from flexdepth.synth.rooms import Contents, lit, row_along_wall
from flexdepth.synth.scene import AreaLight, Scene
from flexdepth.synth.seating import chair, stool
from flexdepth.synth.shapes import Array, Mesh, box, joined, quad
from flexdepth.synth.small_things import shoes
from flexdepth.synth.spirals import spiral_parts
from flexdepth.synth.stair_plans import (
    MakePlan,
    Measures,
    dog_leg,
    l_shaped,
    open_well,
    straight,
    winding,
)
from flexdepth.synth.stair_walls import along_wall, at_wall, held_on, stair_walls
from flexdepth.synth.storage import crates, stack
from flexdepth.synth.tables import table
from flexdepth.synth.viewpoints import ON_STAIRS
from flexdepth.synth.walls import Walls

MakeBuild = Callable[[Generator, str], Build]


@dataclass(frozen=True)
class Kind:
    """What makes stairs those of a home, a public building or a cellar.

    Attributes:
        share: How often they are drawn.
        plans: What they may look like from above.
        least: Least width of a flight, height of a riser, depth of a tread, height of a storey,
            length of the floor before the first flight, metres.
        most: The most.
        storeys: Least and most number of storeys that are climbed.
        surfaces: Material kinds of walls, ceiling and floor.
        steps: How flights are built, and the material kinds of the steps.
        fills: What is between railings and floors.
        along_walls: What stands along the walls of a hall.
        about: What stands on landings.
        painted: Share whose walls are painted in another colour below.
        dark: Share with a weak lamp and hardly any other light.
        pictures: How many doors, windows and pictures a landing's wall has, on average.
    """

    share: float
    plans: tuple[MakePlan, ...]
    least: tuple[float, float, float, float, float]
    most: tuple[float, float, float, float, float]
    storeys: tuple[int, int]
    surfaces: tuple[str, str, str]
    steps: tuple[tuple[MakeBuild, tuple[str, ...]], ...]
    fills: tuple[Fill, ...]
    along_walls: tuple[Maker, ...]
    about: tuple[Maker, ...]
    painted: float
    dark: float
    pictures: float


HOME = Kind(
    0.5, (straight, straight, l_shaped, dog_leg, open_well, winding),
    (0.75, 0.165, 0.23, 2.5, 1.1), (1.1, 0.2, 0.29, 3.0, 2.4), (1, 2),
    ("wall", "ceiling", "floor"),
    ((closed, ("wood", "wood", "floor", "rug")), (open_risers, ("wood", "wood", "counter"))),
    (balusters, balusters, turned, turned, bars, sheet, parapet),
    AGAINST_WALLS, (plant, shoes, bag, chair, stool, stack, table, radiator),
    0.05, 0.15, 1.2,
)  # fmt: skip
PUBLIC = Kind(
    0.36, (dog_leg, dog_leg, open_well, straight, winding),
    (1.0, 0.15, 0.27, 2.8, 1.4), (2.0, 0.175, 0.33, 3.6, 4.0), (1, 3),
    ("wall", "ceiling", "floor"),
    ((cast, ("pavement", "floor", "counter", "rock", "splash")), (open_risers, ("metal", "wood"))),
    (balusters, balusters, bars, sheet, parapet),
    OFFICES, (plant, bicycle, bag, radiator, board, crates, chair),
    0.4, 0.15, 1.5,
)  # fmt: skip
CELLAR = Kind(
    0.14, (straight, straight, l_shaped),
    (0.7, 0.175, 0.21, 2.1, 1.1), (1.05, 0.21, 0.26, 2.6, 2.2), (1, 1),
    ("bare", "bare", "bare"),
    ((open_risers, ("wood",)), (cast, ("bare", "pavement", "wood"))),
    (balusters, bars, bars),
    STORED, (crates, bag, stack, bicycle, shoes),
    0.0, 0.5, 0.4,
)  # fmt: skip


def stairs(rng: Generator) -> Scene:
    """Return stairs of a home, of a public building or down to a cellar."""
    kinds = (HOME, PUBLIC, CELLAR)
    kind = kinds[int(rng.choice(len(kinds), p=[kind.share for kind in kinds]))]
    return stairwell(rng, kind)


def stairwell(rng: Generator, kind: Kind) -> Scene:
    """Return stairs of a kind, with cameras on floors, treads and landings."""
    make = kind.plans[int(rng.integers(len(kind.plans)))]
    asked = _measures(rng, kind)
    plan = make(rng, asked)
    rails = railing(rng, kind.fills[int(rng.integers(len(kind.fills)))])
    daylight = bool(rng.random() < 0.6)
    walls = Walls.drawn(rng, kind.surfaces[0], kind.pictures, daylight)
    paint = material(rng, kind.surfaces[0]) if rng.random() < kind.painted else None
    parts, beams = stair_walls(rng, plan, walls, paint)
    parts += _floors(rng, plan, kind)
    parts += _flights(rng, plan, kind, (walls, paint, rails))
    parts += [part for line in open_edges(plan) for part in rails.along(line)]
    things = _things(rng, plan, kind)
    parts += [part for thing in things for part in thing]
    fittings, lights = _lamps(rng, plan)
    dark = bool(rng.random() < kind.dark)
    scene = lit(rng, Contents(parts + fittings, lights, beams, []), plan.size, dark)
    places = standing(rng, plan)
    return replace(
        scene,
        carriers=ON_STAIRS,
        ceiling=asked.storey - WAIST - 0.12,
        places=places[~_within(places, things)],
        variety=9,
    )


def _measures(rng: Generator, kind: Kind) -> Measures:
    width, rise, going, storey, lead = (float(x) for x in rng.uniform(kind.least, kind.most))
    storeys = int(rng.integers(kind.storeys[0], kind.storeys[1] + 1))
    risers = 2 * round(storey / rise / 2)
    return Measures(width, rise, going, risers, storeys, lead, float(rng.uniform(2.3, 2.9)))


def _floors(rng: Generator, plan: Plan, kind: Kind) -> Parts:
    """Return the lowest floor, the ceiling, and the floors and landings between."""
    width, length, height = plan.size
    corner = (-width / 2, 0, -length / 2)
    look, plaster = material(rng, kind.surfaces[2]), material(rng, kind.surfaces[1])
    ground = quad(corner, (width, 0, 0), (0, 0, length))
    ceiling = quad((corner[0], height, corner[2]), (width, 0, 0), (0, 0, length))
    tops = [_slab(landing, -0.02, 0.0) for landing in plan.landings]
    slabs = [_slab(landing, -WAIST, -0.02) for landing in plan.landings]
    return [
        Part(ground, look),
        Part(ceiling, plaster),
        Part(joined(tops), look if rng.random() < 0.6 else material(rng, kind.surfaces[2])),
        Part(joined(slabs), plaster),
    ]


def _slab(landing: Landing, low: float, high: float) -> Mesh:
    wide, long = landing.size
    middle = np.add(landing.low, landing.high) / 2
    level = landing.level + (low + high) / 2
    # A little into walls and neighbours: a ray could slip through where edges only touch.
    return box((middle[0], level, middle[1]), (wide + 0.006, high - low, long + 0.006))


def _flights(
    rng: Generator, plan: Plan, kind: Kind, around: tuple[Walls, Material | None, Railing]
) -> Parts:
    """Return the flights, with a railing where they are open and what walls have beside them."""
    walls, paint, rails = around
    make, steps = kind.steps[int(rng.integers(len(kind.steps)))]
    build = make(rng, str(rng.choice(steps)))
    held = rng.random() < 0.6
    parts: Parts = []
    for flight in plan.flights:
        parts += flight_parts(flight, build)
        for side in (-1, 1):
            if not at_wall(plan, flight, side):
                parts += rails.along(flight.slope(side * (flight.width / 2 - 0.03)))
                continue
            parts += along_wall(rng, flight, side, walls, paint)
            parts += held_on(flight, side, rails) if held else []
    for spiral in plan.spirals:
        parts += spiral_parts(spiral, build)
        parts += [part for edge in spiral.edges() for part in rails.along(edge)]
    if plan.flights and build.riser is not None and rng.random() < 0.5:
        look = walls.shared if rng.random() < 0.5 else material(rng, "cabinet")
        parts += cupboard(plan.flights[0], look)
    return parts


def _things(rng: Generator, plan: Plan, kind: Kind) -> list[Parts]:
    """Return what stands along a wall of a hall and at the ends of landings, and somebody."""
    things: list[Parts] = []
    width, length, _ = plan.size
    for hall in plan.ground[1:]:
        above = [floor for floor in plan.landings if floor.low == hall.low]
        for floor in (hall, *above) if hall.size[0] > 1.6 else ():
            at = (width / 2, floor.level, (floor.low[1] + floor.high[1]) / 2)
            row = row_along_wall(rng, kind.along_walls, floor.size[1], 0.6)
            things += [placed(thing, at, np.pi / 2) for thing in row]
    for landing in (*plan.ground[:1], *plan.landings):
        far = landing.high[1] > length / 2 - 0.01
        near = landing.low[1] < 0.01 - length / 2
        if (far or near) and rng.random() < 0.3:
            end = 1.0 if far else -1.0
            thing = chosen(rng, kind.about)
            x = rng.uniform(landing.low[0] + 0.3, landing.high[0] - 0.3)
            z = end * (length / 2 - bounds(thing)[1][2] - 0.03)
            things.append(placed(thing, (x, landing.level, z), 0.0 if end > 0 else np.pi))
    if rng.random() < 0.25:
        spots = standing(rng, plan)
        spot = spots[rng.integers(len(spots))]
        things.append(placed(bystander(rng), tuple(spot), float(rng.uniform(0, 6.3))))
    return things


def _lamps(rng: Generator, plan: Plan) -> tuple[Parts, list[AreaLight]]:
    """Return lamps under the ceiling and under some of the floors, and their light."""
    width, length, height = plan.size
    parts: Parts = []
    lights: list[AreaLight] = []
    whole = Landing((-width / 2, -length / 2), (width / 2, length / 2), height + WAIST)
    high = [landing for landing in plan.landings if landing.level > 2.0]
    for above in (whole, *high[:: max(1, len(high) // 3)]):
        # Under so low a ceiling lamps do not hang into the way.
        fittings, below = lamps(rng, 1, (*above.size, 2.0))
        middle = np.add(above.low, above.high) / 2
        at = (float(middle[0]), above.level - WAIST - 2.0, float(middle[1]))
        parts += placed(fittings, at)
        lights += [replace(light, centre=light.centre + at) for light in below]
    return parts, lights


def standing(rng: Generator, plan: Plan) -> Array:
    """Return points where somebody could stand: on treads, landings and the lowest floor."""
    places = []
    for landing in (*plan.ground, *plan.landings):
        wide, long = landing.size
        count = int(np.clip(2 * wide * long, 4, 10))
        inset = np.minimum(0.35, 0.45 * np.array([wide, long]))
        spots = rng.uniform(landing.low + inset, landing.high - inset, (count, 2))
        places.append(np.insert(spots, 1, landing.level, axis=1))
    for flight in plan.flights:
        steps = np.array([flight.tread(k) for k in range(flight.risers - 1)])
        right = flight.point(1, 0, 0) - flight.foot
        places += [steps + s * 0.15 * flight.width * right for s in (-1, 1)]
    places += [spiral.steps() for spiral in plan.spirals]
    return np.concatenate(places)


def _within(places: Array, things: list[Parts]) -> NDArray[np.bool_]:
    """Return which places things stand on, or so near that nobody would stand there."""
    taken = np.zeros(len(places), bool)
    for thing in things:
        low, high = bounds(thing)
        near = (places > low - 0.3) & (places < high + np.array([0.3, -0.05, 0.3]))
        taken |= near.all(1)
    return taken
