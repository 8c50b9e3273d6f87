from dataclasses import replace

import numpy as np
import pytest

from flexdepth.synth.library import Library
from flexdepth.synth.lighting import irradiance, mirrored
from flexdepth.synth.materials import Material, Part
from flexdepth.synth.render import render
from flexdepth.synth.scene import Beam, Scene, Spot
from flexdepth.synth.shapes import quad
from flexdepth.synth.skylight import Dome
from flexdepth.synth.stage import Stage
from flexdepth.synth.viewpoints import Viewpoint, looking

GREY = Material("plain", np.full((3, 3), 0.5), (1.0, 1.0))
RED = Material("plain", np.tile((1.0, 0.0, 0.0), (3, 1)), (1.0, 1.0), glow=2.0)
MIRROR = Material("plain", np.zeros((3, 3)), (1.0, 1.0), gloss=1.0)
VIEW = Viewpoint(np.array([0, 1.0, 0]), looking(0, 0, 0), 0.6)


def scene(parts, beams=(), spots=()):
    return Scene(
        parts=parts,
        lamps=[],
        sun=None,
        ambient=np.zeros(3),
        occlusion_reach=1.0,
        horizon=np.zeros(3),
        zenith=np.zeros(3),
        clouds=0.0,
        eyes=(np.zeros(3), np.ones(3)),
        outdoors=False,
        beams=beams,
        spots=spots,
    )


@pytest.fixture(scope="module")
def library():
    return Library.made(np.random.default_rng(0), 1)


@pytest.fixture(scope="module")
def seen(library):
    def made(world):
        rng = np.random.default_rng(0)
        return render(rng, Stage.built(rng, world, library), VIEW, 64, 48)

    return made


def wall(z, look):
    return Part(quad((-50, -50, z), (100, 0, 0), (0, 100, 0)), look)


def test_a_mirror_shows_what_is_behind_the_camera_and_has_its_own_depth(seen):
    image = seen(scene([wall(2.0, MIRROR), wall(-3.0, RED)]))
    assert image.light == pytest.approx(np.broadcast_to((2.0, 0, 0), image.light.shape), abs=0.02)
    assert image.depth == pytest.approx(np.full(image.depth.shape, 2.0), abs=1e-5)


def test_a_varnished_floor_mirrors_more_the_flatter_the_look(seen):
    black = Material("plain", np.zeros((3, 3)), (1.0, 1.0), gloss=0.04)
    floor = Part(quad((-50, 0, -50), (100, 0, 0), (0, 0, 100)), black)
    image = seen(scene([floor, wall(40.0, RED)]))
    column = image.light[:, 32, 0]
    below = np.flatnonzero(image.depth[:, 32] < 39)
    assert (np.diff(column[below]) < 1e-6).all()
    # Schlick's formula at the lowest row, where the angle is known.
    cosine = 1 / np.hypot(1, image.depth[-1, 32])
    expected = 2 * (0.04 + 0.96 * (1 - cosine) ** 5)
    assert column[-1] == pytest.approx(expected, rel=0.05)


def test_a_dull_surface_mirrors_nothing(seen):
    assert not seen(scene([wall(2.0, GREY), wall(-3.0, RED)])).light.any()


def test_sunlight_through_a_window_makes_a_patch_of_its_size_on_the_wall_behind(seen):
    corner, along, up = np.array([-1.0, 0.5, -1.0]), np.array([2.0, 0, 0]), np.array([0, 1.0, 0])
    towards = np.array([0.0, 0.0, -1.0])
    beam = Beam(corner, along, up, 1, towards, np.full(3, 3.0))
    image = seen(scene([wall(2.0, GREY)], (beam,)))
    lit = image.light[..., 0] > 0.5
    across, down = (np.flatnonzero(lit.any(axis)) for axis in (0, 1))
    pixels = image.focal / 2.0
    assert len(across) == pytest.approx(2.0 * pixels, abs=2)
    assert len(down) == pytest.approx(1.0 * pixels, abs=2)
    assert image.light[lit].mean() == pytest.approx(0.5 * 3.0, rel=0.2)


def test_what_stands_in_a_beam_casts_a_shadow(seen):
    beam = Beam(
        np.array([-1.0, 0.5, -1.0]), np.array([2.0, 0, 0]), np.array([0, 1.0, 0]), 1,
        np.array([0.0, 0.0, -1.0]), np.full(3, 3.0),
    )  # fmt: skip
    blocker = Part(quad((-1.1, 0, -0.5), (1.1, 0, 0), (0, 3, 0)), GREY)
    bare, blocked = (
        seen(scene([wall(2.0, GREY)], (beam,))),
        seen(scene([wall(2.0, GREY), blocker], (beam,))),
    )
    assert blocked.light.sum() == pytest.approx(bare.light.sum() / 2, rel=0.1)


def test_a_shining_lamp_keeps_its_colour_without_any_light(seen):
    dim = replace(RED, glow=0.3)
    image = seen(scene([wall(2.0, dim)]))
    assert image.light[..., 0] == pytest.approx(np.full((48, 64), 0.3), rel=0.01)


SPOT = Spot(np.array([0, 1.0, 0]), np.array([0, 0, 1.0]), 0.3, np.array([6.0, 4.0, 2.0]))


def on_wall(stage, distance, across):
    """Return points of a wall so far ahead of the spot light, each so far to its right."""
    origins = np.array([(x, 1, distance - 0.5) for x in across], np.float32)
    rays = np.broadcast_to(np.float32((0, 0, 1)), origins.shape).copy()
    return stage.hits(origins, rays, 100.0)[0]


@pytest.fixture(scope="module")
def lit(library):
    """Return a function: what a spot light throws on points of a wall, with what is before it."""

    def made(spot, distance, across, *before):
        rng = np.random.default_rng(0)
        world = scene([wall(distance, GREY), *before], spots=(spot,))
        stage = Stage.built(rng, world, library)
        return irradiance(rng, stage, on_wall(stage, distance, across))

    return made


@pytest.mark.parametrize("distance", [1.0, 2.0, 7.0])
def test_light_in_the_middle_of_a_cone_falls_with_the_square_of_distance(lit, distance):
    expected = np.array([[6.0, 4.0, 2.0]]) / (distance**2 + 0.15)
    assert lit(SPOT, distance, [0.0]) == pytest.approx(expected, rel=0.005)


def test_a_cone_fades_to_its_rim_and_lights_nothing_outside(lit):
    angle = np.linspace(0, 0.6, 61)
    arriving = lit(SPOT, 2.0, 2 * np.tan(angle))[:, 0]
    inside = angle < 0.299
    assert (np.diff(arriving[inside]) < 0).all()
    assert arriving[inside][-1] < 0.02 * arriving[0]
    assert not arriving[angle > 0.301].any()


def test_a_quarter_of_the_way_from_the_rim_five_parts_in_32_are_left(lit):
    cosine = (1 + 3 * np.cos(0.3)) / 4
    way = 2 / cosine
    (there,) = lit(SPOT, 2.0, [np.sqrt(way**2 - 4)])[:, 0]
    assert there == pytest.approx(5 / 32 * 6.0 * cosine / (way**2 + 0.15), rel=0.01)


def test_a_spot_light_lights_nothing_behind_it(lit):
    assert not lit(replace(SPOT, ahead=-SPOT.ahead), 2.0, [0.0, 0.2]).any()


def test_what_stands_before_a_spot_light_throws_a_shadow(lit):
    across = np.array([-0.3, -0.1, 0.1, 0.3])
    board = Part(quad((-1, 0, 1.0), (1, 0, 0), (0, 3, 0)), GREY)
    bare, blocked = lit(SPOT, 2.0, across), lit(SPOT, 2.0, across, board)
    assert blocked == pytest.approx(np.where(across[:, None] < 0, 0, bare))
    assert (bare > 0.3).all()


def test_a_tinted_pane_takes_its_share_of_a_spot_light(lit):
    glass = Material("plain", np.tile((0.8, 0.5, 0.5), (3, 1)), (1.0, 1.0), clear=0.9)
    pane = Part(quad((-1, 0, 1.0), (2, 0, 0), (0, 3, 0)), glass)
    passed = lit(SPOT, 2.0, [0.1], pane) / lit(SPOT, 2.0, [0.1])
    assert passed == pytest.approx(0.9 * np.array([[0.8, 0.5, 0.5]]), rel=0.01)


def test_a_mirror_shows_what_a_spot_light_lights(library):
    away = replace(SPOT, ahead=np.array([0, 0, -1.0]))
    world = scene([wall(2.0, MIRROR), wall(-3.0, GREY)], spots=(away,))
    stage = Stage.built(np.random.default_rng(0), world, library)
    dome = Dome.drawn(np.random.default_rng(0), world, library.skies)
    _, light = mirrored(stage, dome, on_wall(stage, 2.0, [0.0, 1.5]))
    middle = 0.5 * 0.7 * away.power / (9 + 0.15)
    assert light == pytest.approx(np.stack([middle, 0 * middle]), rel=0.02)
