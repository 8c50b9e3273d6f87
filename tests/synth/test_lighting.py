from dataclasses import replace

import numpy as np
import pytest

from flexdepth.synth.library import Library
from flexdepth.synth.materials import Material, Part
from flexdepth.synth.render import render
from flexdepth.synth.scene import Beam, Scene
from flexdepth.synth.shapes import quad
from flexdepth.synth.stage import Stage
from flexdepth.synth.viewpoints import Viewpoint, looking

GREY = Material("plain", np.full((3, 3), 0.5), (1.0, 1.0))
RED = Material("plain", np.tile((1.0, 0.0, 0.0), (3, 1)), (1.0, 1.0), glow=2.0)
MIRROR = Material("plain", np.zeros((3, 3)), (1.0, 1.0), gloss=1.0)
VIEW = Viewpoint(np.array([0, 1.0, 0]), looking(0, 0, 0), 0.6)


def scene(parts, beams=()):
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
    )


@pytest.fixture(scope="module")
def seen():
    library = Library.made(np.random.default_rng(0), 1)

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
