import numpy as np
import pytest

from flexdepth.synth.library import Library
from flexdepth.synth.materials import Material, Part
from flexdepth.synth.render import render
from flexdepth.synth.scene import AreaLight, Scene, Sun
from flexdepth.synth.shapes import box, quad
from flexdepth.synth.stage import Stage
from flexdepth.synth.viewpoints import Viewpoint, looking

GREY = Material("plain", np.full((3, 3), 0.5), (1.0, 1.0))
WIDTH, HEIGHT = 64, 48


@pytest.fixture(scope="module")
def library():
    return Library.made(np.random.default_rng(0), 1)


def scene(parts, lamps=(), sun=None, ambient=0.0):
    return Scene(
        parts=parts,
        lamps=list(lamps),
        sun=sun,
        ambient=np.full(3, ambient),
        occlusion_reach=1.0,
        horizon=np.ones(3),
        zenith=np.ones(3),
        clouds=0.0,
        eyes=(np.zeros(3), np.ones(3)),
        outdoors=True,
    )


def seen(library, world, view):
    rng = np.random.default_rng(0)
    return render(rng, Stage.built(rng, world, library), view, WIDTH, HEIGHT)


def wall(z, size=100.0):
    return Part(quad((-size / 2, -size / 2, z), (size, 0, 0), (0, size, 0)), GREY)


def test_a_wall_that_faces_the_camera_has_one_depth(library):
    image = seen(library, scene([wall(3.0)]), Viewpoint(np.zeros(3), looking(0, 0, 0), 0.6))
    assert image.depth == pytest.approx(np.full((HEIGHT, WIDTH), 3.0), abs=1e-5)


def test_the_ground_is_as_deep_as_its_row_says(library):
    ground = Part(quad((-500, 0, -500), (1000, 0, 0), (0, 0, 1000)), GREY)
    image = seen(library, scene([ground]), Viewpoint(np.array([0, 1.5, 0]), looking(0, 0, 0), 0.6))
    rows = np.arange(HEIGHT) + 0.5 - HEIGHT / 2
    below = rows > 2
    expected = 1.5 * image.focal / rows[below]
    assert image.depth[below] == pytest.approx(np.repeat(expected[:, None], WIDTH, 1), rel=1e-4)
    assert np.isinf(image.depth[rows < 0]).all()


def test_the_focal_length_is_in_image_diagonals(library):
    image = seen(library, scene([wall(3.0)]), Viewpoint(np.zeros(3), looking(0, 0, 0), 0.6))
    assert image.focal == pytest.approx(0.6 * 80)


def test_what_stands_to_the_right_is_seen_on_the_right(library):
    eye, view = np.zeros(3), looking(0, 0, 0)
    right = view[:, 0]
    world = scene([wall(9.0), Part(box(tuple(3 * view[:, 2] + right), (0.5, 0.5, 0.5)), GREY)])
    image = seen(library, world, Viewpoint(eye, view, 0.6))
    columns = np.flatnonzero((image.depth < 5).any(0))
    assert columns.min() > WIDTH / 2


def test_looking_up_shows_what_is_above_lower_in_the_image():
    up = looking(0, 0.3, 0)
    assert up[1, 2] > 0
    assert up[1, 1] < 0


@pytest.mark.parametrize("angles", [(0, 0, 0), (1, 0.3, 0.2), (-2, -0.5, 0.7)])
def test_a_camera_is_a_proper_rotation(angles):
    rotation = looking(*angles)
    assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1)


def test_a_surface_lit_by_the_sun_has_albedo_times_cosine(library):
    sun = Sun(np.array([0.0, np.sin(0.5), -np.cos(0.5)]), np.full(3, 2.0))
    image = seen(
        library, scene([wall(3.0)], sun=sun), Viewpoint(np.zeros(3), looking(0, 0, 0), 0.6)
    )
    assert np.median(image.light) == pytest.approx(0.5 * 2 * np.cos(0.5), rel=0.05)


def test_what_is_between_a_surface_and_the_sun_casts_a_shadow(library):
    sun = Sun(np.array([0.0, 0.0, -1.0]), np.ones(3))
    blocker = Part(quad((-50, -50, -1), (50, 0, 0), (0, 100, 0)), GREY)
    world = scene([wall(3.0), blocker], sun=sun)
    image = seen(library, world, Viewpoint(np.zeros(3), looking(0, 0, 0), 0.6))
    left, right = image.light[:, 40:].mean(), image.light[:, :24].mean()
    assert min(left, right) < 0.05 * max(left, right)


def test_ambient_light_reaches_an_open_wall_whole(library):
    world = scene([wall(3.0)], ambient=0.8)
    image = seen(library, world, Viewpoint(np.zeros(3), looking(0, 0, 0), 0.6))
    assert np.median(image.light) == pytest.approx(0.4, rel=0.05)


def test_a_lamp_lights_the_near_more_than_the_far(library):
    floor = Part(quad((-50, 0, -50), (100, 0, 0), (0, 0, 100)), GREY)
    lamp = AreaLight(np.array([0.0, 2.0, 3.0]), 0.1, np.ones(3))
    view = Viewpoint(np.array([0, 1.0, 0]), looking(0, -0.3, 0), 0.6)
    image = seen(library, scene([floor], lamps=[lamp]), view)
    below_lamp = image.light[np.abs(image.depth - 3) < 0.3].mean()
    far = image.light[(image.depth > 8) & np.isfinite(image.depth)].mean()
    assert below_lamp > 5 * far
