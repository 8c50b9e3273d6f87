from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from flexdepth.synth.fixtures import board
from flexdepth.synth.flights import WAIST, Flight, cast, closed, flight_parts, open_risers
from flexdepth.synth.landings import Landing, Plan, open_edges
from flexdepth.synth.materials import Part, material
from flexdepth.synth.railings import balusters, bars, parapet, railing, sheet, turned
from flexdepth.synth.shapes import box
from flexdepth.synth.spirals import Spiral, spiral_parts
from flexdepth.synth.stage import Stage
from flexdepth.synth.stair_plans import Measures, dog_leg, l_shaped, open_well, straight, winding
from flexdepth.synth.stair_walls import strips
from flexdepth.synth.stairwells import CELLAR, HOME, PUBLIC, stairs, stairwell
from flexdepth.synth.viewpoints import viewpoint

ASKED = Measures(0.9, 0.18, 0.25, 14, 2, 1.4, 2.4)
PLANS = (straight, l_shaped, dog_leg, open_well, winding)
UP = np.array([0, 1.0, 0])
DOWN = -UP


def flight(yaw):
    return Flight(np.array([1.0, 2.0, 3.0]), yaw, 1.0, 4, 0.2, 0.3)


@pytest.fixture(scope="module")
def cast_into(library):
    """Return a function that gives how far rays go in a scene, +inf for ever."""

    def made(scene):
        stage = Stage.built(np.random.default_rng(0), scene, library)

        def distances(starts, ways):
            starts = np.asarray(starts, np.float32)
            ways = np.broadcast_to(ways, starts.shape).astype(np.float32)
            return stage.hits(starts, ways, 100.0)[1]

        return distances

    return made


@pytest.fixture
def empty():
    """Return a scene of which only the parts are replaced."""
    return stairwell(np.random.default_rng(0), CELLAR)


def test_treads_rise_by_a_riser_and_go_by_a_tread():
    # Towards +x: the first tread's middle is half a going ahead and one rise up.
    climbing = flight(np.pi / 2)
    np.testing.assert_allclose(climbing.tread(0), [1.15, 2.2, 3.0], atol=1e-12)
    np.testing.assert_allclose(climbing.tread(2), [1.75, 2.6, 3.0], atol=1e-12)
    np.testing.assert_allclose(climbing.top, [1.9, 2.8, 3.0], atol=1e-12)


def test_who_climbs_towards_z_has_the_right_side_at_lower_x():
    np.testing.assert_allclose(flight(0.0).point(0.4, 0, 0), [0.6, 2.0, 3.0], atol=1e-12)


@pytest.mark.parametrize("build", [closed, open_risers, cast])
def test_one_steps_on_treads_where_the_flight_says(build, cast_into, empty):
    climbing = replace(flight(1.0), risers=9)
    parts = flight_parts(climbing, build(np.random.default_rng(3), "wood"))
    treads = np.array([climbing.tread(k) for k in range(8)])
    fallen = cast_into(replace(empty, parts=parts))(treads + UP, DOWN)
    # A carpet is six millimetres thick.
    assert np.abs(fallen - 1).max() < 0.008


def test_closed_flights_have_risers_and_an_underside(cast_into, empty):
    climbing = replace(flight(0.0), risers=9)
    below = np.array([climbing.point(0, 1.2, -0.3)])
    for build, ends in ((cast, True), (open_risers, False)):
        parts = flight_parts(climbing, build(np.random.default_rng(3), "wood"))
        far = cast_into(replace(empty, parts=parts))
        # Level, against the fourth riser.
        rays = np.array([climbing.point(0.1, 0.3, 3.4 * climbing.rise)])
        assert np.isfinite(far(rays, (0, 0, 1))).all() == ends
        slope = 1.2 * climbing.rise / climbing.going - WAIST
        if ends:
            assert far(below, UP)[0] == pytest.approx(slope + 0.3, abs=1e-3)


@pytest.mark.parametrize("make", PLANS)
def test_flights_join_floors_and_landings_without_a_gap(make):
    for seed in range(12):
        plan = make(np.random.default_rng(seed), ASKED)
        width, length, _ = plan.size
        ground = Landing((-width / 2, -length / 2), (width / 2, length / 2), 0.0)
        floors = (*plan.landings, ground)
        for one in plan.flights:
            before = one.point(0, -0.05, 0)
            after = one.point(0, one.length + 0.05, one.risers * one.rise)
            for spot in (before, after):
                assert any(
                    abs(floor.level - spot[1]) < 1e-9
                    and (np.array(floor.low) < spot[[0, 2]]).all()
                    and (spot[[0, 2]] < np.array(floor.high)).all()
                    for floor in floors
                )
            assert (
                np.abs(one.slope(0.45)[:, [0, 2]]) <= np.array([width, length]) / 2 + 1e-9
            ).all()
        highest = max(floor.level for floor in plan.landings)
        storeys = 2 if make in (dog_leg, open_well) else 1
        assert highest == pytest.approx(storeys * 14 * 0.18)
        ends = [one.top[1] for one in plan.flights]
        ends += [one.risers * one.rise for one in plan.spirals]
        assert max(ends) == pytest.approx(highest)


def test_a_landing_is_open_where_neither_a_wall_nor_a_flight_is():
    # Two metres wide; the landing takes the far metre, and a flight 0.8 m wide comes up to it.
    up = Flight(np.array([-0.6, 0.0, -0.6]), 0.0, 0.8, 3, 0.2, 0.3)
    landing = Landing((-1.0, 0.0), (1.0, 1.0), 0.6)
    (line,) = open_edges(Plan((2.0, 2.0, 3.0), (up,), (landing,), ()))
    np.testing.assert_allclose(line, [[-0.2, 0.6, 0.03], [1.0, 0.6, 0.03]], atol=1e-9)


def test_what_joins_the_same_line_beyond_an_edge_does_not_lengthen_it():
    # Both are on z = 0, a metre apart.
    floors = (Landing((-2.0, 0.0), (-1.0, 1.0), 0.6), Landing((0.0, 0.0), (1.0, 1.0), 0.6))
    lines = open_edges(Plan((9.0, 9.0, 3.0), (), floors, ()))
    near = [line[:, 0].tolist() for line in lines if (line[:, 2] == 0.03).all()]
    assert near == [[-2, -1], [0, 1]]


def test_strips_of_a_wall_cover_it_and_know_the_floors_at_it():
    plan = dog_leg(np.random.default_rng(1), ASKED)
    length = plan.size[1]
    for yaw in (np.pi / 2, -np.pi / 2):
        found = strips(plan, yaw)
        assert found[0][0] == pytest.approx(-length / 2)
        assert found[-1][1] == pytest.approx(length / 2)
        assert all(a[1] == pytest.approx(b[0]) for a, b in pairwise(found))
        levels = sorted(strip[2] for strip in found)
        storey = 14 * 0.18
        assert levels[0] == ()
        assert levels[1] == pytest.approx((0, 0.5 * storey, 1.5 * storey))
        assert levels[2] == pytest.approx((0, storey, 2 * storey))


@pytest.mark.parametrize("fill", [balusters, turned, bars, sheet, parapet])
def test_a_railing_is_as_tall_as_it_says_and_stands_in_what_carries_it(fill):
    rails = railing(np.random.default_rng(1), fill)
    line = np.array([[0.0, 1.0, 0.0], [0.0, 2.0, 1.6]])
    rail, filling = (
        mesh.corners[..., 1] - (1 + mesh.corners[..., 2] / 1.6)
        for mesh in (part.mesh for part in rails.along(line)[:2])
    )
    assert rail.max() == pytest.approx(rails.tall)
    assert rail.min() == pytest.approx(rails.tall - rails.rail[1])
    assert rails.tall - 0.15 < filling.max() < rails.tall + 0.01
    assert filling.min() < 0 or fill is sheet


def test_a_spiral_climbs_evenly_to_where_it_ends():
    spiral = Spiral(np.array([1.0, 0.0, 2.0]), 0.1, 0.9, 5, 0.2, 0.0, np.pi / 2)
    # The last of its four treads is from -90 degrees to 0, to the left of z, and four rises up.
    steps = spiral.steps()
    assert np.diff(steps[:, 1]) == pytest.approx([0.2] * 3)
    assert steps[-1] == pytest.approx([1 - 0.58 / 2**0.5, 0.8, 2 + 0.58 / 2**0.5])
    assert np.hypot(*(spiral.edges()[0] - spiral.centre)[:, [0, 2]].T) == pytest.approx(0.87)


@pytest.mark.parametrize("inner", [0.05, 0.8])
def test_one_steps_on_the_treads_of_a_spiral(inner, cast_into, empty):
    spiral = Spiral(np.zeros(3), inner, inner + 0.9, 14, 0.18, 0.5, -0.4)
    parts = spiral_parts(spiral, cast(np.random.default_rng(0), "wood"))
    fallen = cast_into(replace(empty, parts=parts))(spiral.steps() + 0.5 * UP, DOWN)
    assert fallen == pytest.approx(0.5, abs=1e-4)


@pytest.mark.parametrize("kind", [HOME, PUBLIC, CELLAR])
def test_whoever_holds_a_camera_stands_on_something_and_in_nothing(kind, cast_into):
    for seed in range(4):
        scene = stairwell(np.random.default_rng([7, seed]), kind)
        distances = cast_into(scene)
        up = min(scene.ceiling, 1.9)
        assert len(scene.places) > 20
        fallen = distances(scene.places + up * UP, DOWN)
        assert fallen == pytest.approx(up, abs=0.03)
        rng = np.random.default_rng(seed)
        eyes = np.array([viewpoint(rng, scene, 4 / 3).eye for _ in range(200)])
        height = distances(eyes, DOWN)
        assert 0.25 < height.min() < 0.75
        assert 1.7 < height.max() < 2.05


def walked(distances, feet, rng, steps):
    """Return the deepest fall of people who walk about and stop before what is at their knees."""
    deepest = 0.0
    yaw = rng.uniform(0, 2 * np.pi, len(feet))
    for _ in range(steps):
        yaw = yaw + rng.normal(0, 0.4, len(feet))
        ahead = np.stack([np.sin(yaw), 0 * yaw, np.cos(yaw)], -1)
        aside = np.stack([np.cos(yaw), 0 * yaw, -np.sin(yaw)], -1)
        knees = feet + 0.5 * UP
        blocked = [distances(knees + shift * aside, ahead) < 0.4 for shift in (-0.12, 0, 0.12)]
        gone = feet + np.where(np.any(blocked, 0), 0, 0.12)[:, None] * ahead
        yaw = np.where(np.any(blocked, 0), yaw + 2, yaw)
        fallen = distances(gone + 0.5 * UP, DOWN) - 0.5
        deepest = max(deepest, fallen.max())
        feet = gone - fallen[:, None] * UP
    return deepest


@pytest.mark.parametrize("make", PLANS)
def test_nobody_who_walks_about_falls_further_than_some_steps(make, cast_into, monkeypatch):
    # Nobody can climb onto a notice board.
    monkeypatch.setattr("flexdepth.synth.stairwells.bystander", board)
    bare = replace(HOME, along_walls=(board,), about=(board,))
    kind = replace(bare, plans=(make,), fills=(parapet,), storeys=(2, 2))
    for seed in range(3):
        rng = np.random.default_rng([9, seed])
        scene = stairwell(rng, kind)
        feet = np.repeat(scene.places, 6, axis=0)
        # At the post of a spiral four steps are one.
        assert walked(cast_into(scene), feet, rng, 40) < (0.85 if make is winding else 0.45)


def test_no_ray_leaves_a_stairwell(cast_into):
    for seed in range(3):
        rng = np.random.default_rng([5, seed])
        scene = stairs(rng)
        ways = rng.normal(size=(20000, 3))
        starts = scene.places[rng.integers(len(scene.places), size=20000)] + 1.1 * UP
        assert np.isfinite(cast_into(scene)(starts, ways)).all()


def test_public_buildings_have_more_storeys_than_homes_and_cellars():
    def highest(kind):
        scenes = (stairwell(np.random.default_rng(seed), kind) for seed in range(4))
        return max(scene.places[:, 1].max() for scene in scenes)

    climbed = replace(PUBLIC, storeys=(3, 3), plans=(dog_leg,))
    assert highest(CELLAR) < 2.8 < highest(HOME) < 6.2 < 3 * 2.7 < highest(climbed)


@pytest.mark.parametrize("make", PLANS)
def test_what_stands_about_stands_on_a_floor(make, cast_into):
    look = material(np.random.default_rng(0), "wood")

    def crate(_):
        return [Part(box((0, 0.2, 0), (0.3, 0.4, 0.3)), look)]

    kind = replace(HOME, plans=(make,), along_walls=(crate,), about=(crate,))
    for seed in range(30):
        scene = stairwell(np.random.default_rng([11, seed]), kind)
        crates = [part for part in scene.parts if part.material is look]
        floors = replace(scene, parts=[part for part in scene.parts if part.material is not look])
        middles = np.array([part.mesh.corners.mean((0, 1)) for part in crates]).reshape(-1, 3)
        assert cast_into(floors)(middles, DOWN) == pytest.approx(0.2, abs=0.02)
