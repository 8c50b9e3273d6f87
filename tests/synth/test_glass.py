import numpy as np
import pytest

from flexdepth.synth.glass import passed, unblocked
from flexdepth.synth.library import Library
from flexdepth.synth.materials import Material, Part
from flexdepth.synth.render import render
from flexdepth.synth.scene import AreaLight, Beam, Scene, Sun
from flexdepth.synth.shapes import box, quad
from flexdepth.synth.stage import Stage
from flexdepth.synth.viewpoints import Viewpoint, looking

VIEW = Viewpoint(np.array([0, 1.0, 0]), looking(0, 0, 0), 0.6)
MIDDLE = (24, 32)
TINT = np.array([0.9, 0.5, 0.25])
CLEAR = 0.8


def material(colour, **kept):
    return Material("plain", np.tile(colour, (3, 1)), (1.0, 1.0), **kept)


def pane(gloss=0.0):
    return material(TINT, gloss=gloss, clear=CLEAR)


GREY, RED = material((0.5,) * 3), material((1.0, 1.0, 1.0), glow=2.0)
BLUE = material((0.0, 0.0, 1.0), glow=3.0)
OPAQUE = material((0.0, 0.0, 0.0))


def scene(parts, **light):
    dark = {
        "lamps": [], "sun": None, "ambient": np.zeros(3), "horizon": np.zeros(3),
        "zenith": np.zeros(3), "beams": (),
    }  # fmt: skip
    return Scene(
        parts=parts,
        occlusion_reach=1.0,
        clouds=0.0,
        eyes=(np.zeros(3), np.ones(3)),
        outdoors=False,
        **(dark | light),
    )


@pytest.fixture(scope="module")
def stage():
    library = Library.made(np.random.default_rng(0), 1)
    return lambda world: Stage.built(np.random.default_rng(0), world, library)


@pytest.fixture(scope="module")
def seen(stage):
    return lambda world: render(np.random.default_rng(0), stage(world), VIEW, 64, 48)


def wall(z, look):
    return Part(quad((-50, -50, z), (100, 0, 0), (0, 100, 0)), look)


def test_a_pane_shows_what_is_behind_in_its_colour_at_its_own_depth(seen):
    image = seen(scene([wall(2.0, pane()), wall(5.0, RED)]))
    assert image.light == pytest.approx(np.broadcast_to(CLEAR * TINT * 2, (48, 64, 3)), rel=1e-4)
    assert image.depth == pytest.approx(np.full((48, 64), 2.0), abs=1e-5)


def test_a_pane_mirrors_its_share_and_lets_the_rest_pass(seen):
    image = seen(scene([wall(2.0, pane(gloss=0.04)), wall(5.0, RED), wall(-3.0, BLUE)]))
    shown, away = (0.96 * CLEAR * TINT * 2, 0.04 * np.array([0, 0, 3.0]))
    assert image.light[MIDDLE] == pytest.approx(shown + away, rel=1e-3)
    # Schlick's formula in the corner, where the ray to the pixel's centre is known.
    slant = 1 / np.sqrt(1 + (31.5**2 + 23.5**2) / image.focal**2)
    share = 0.04 + 0.96 * (1 - slant) ** 5
    shown, away = ((1 - share) * CLEAR * TINT * 2, share * np.array([0, 0, 3.0]))
    assert image.light[0, 0] == pytest.approx(shown + away, rel=1e-3)


@pytest.mark.parametrize("panes", [2, 4])
def test_panes_in_a_row_multiply(seen, panes):
    row = [wall(2.0 + 0.05 * k, pane()) for k in range(panes)]
    image = seen(scene([*row, wall(5.0, RED)]))
    assert image.light[MIDDLE] == pytest.approx((CLEAR * TINT) ** panes * 2, rel=1e-4)
    assert image.depth[MIDDLE] == pytest.approx(2.0)


def test_a_box_of_glass_has_two_sides(seen):
    image = seen(scene([Part(box((0, 1, 3.0), (9, 9, 0.01)), pane()), wall(5.0, RED)]))
    assert image.light[MIDDLE] == pytest.approx((CLEAR * TINT) ** 2 * 2, rel=1e-4)


def test_what_is_opaque_shows_nothing_of_what_is_behind(seen):
    assert not seen(scene([wall(2.0, OPAQUE), wall(5.0, RED)])).light.any()
    assert not seen(scene([wall(2.0, pane()), wall(3.0, OPAQUE), wall(5.0, RED)])).light.any()


def test_beside_a_pane_and_behind_a_part_of_it_there_is_what_there_is(seen):
    half = Part(quad((0, -50, 2.0), (50, 0, 0), (0, 100, 0)), pane())
    low = Part(quad((-50, 1.0, 5.0), (100, 0, 0), (0, 50, 0)), RED)
    image = seen(scene([half, low]))
    shown = np.zeros((48, 64, 3))
    shown[:24] = 2
    shown[:, :32] *= CLEAR * TINT
    assert image.light == pytest.approx(shown, rel=1e-4)
    depth = np.full((48, 64), np.inf)
    depth[:24] = 5
    depth[:, :32] = 2
    assert image.depth == pytest.approx(depth)


def test_the_sky_is_seen_through_a_pane(seen):
    sky = np.array([0.2, 0.4, 0.8])
    image = seen(scene([wall(2.0, pane())], horizon=sky, zenith=sky))
    assert image.light[MIDDLE] == pytest.approx(CLEAR * TINT * sky, rel=1e-4)
    assert np.isfinite(image.depth).all()


def test_dust_on_a_pane_scatters_back_what_does_not_pass(seen):
    image = seen(scene([wall(2.0, pane())], ambient=np.ones(3)))
    # Light without shadows is 0.7 of the ambient light.
    assert image.light[MIDDLE] == pytest.approx((1 - CLEAR) * TINT * 0.7, rel=1e-4)


def test_air_before_a_pane_and_behind_it_is_counted_once(seen):
    air, haze = np.full(3, 0.5), 0.1
    world = scene([wall(2.0, pane()), wall(5.0, RED)], horizon=air, zenith=air, haze=haze)
    behind = np.exp(-3 * haze) * 2 + (1 - np.exp(-3 * haze)) * air
    before = np.exp(-2 * haze) * CLEAR * TINT * behind + (1 - np.exp(-2 * haze)) * air
    assert seen(world).light[MIDDLE] == pytest.approx(before, rel=5e-3)


def test_a_mirror_shows_what_is_behind_a_pane(seen):
    mirror = material((0.0,) * 3, gloss=1.0)
    image = seen(scene([wall(2.0, mirror), wall(-3.0, pane()), wall(-5.0, RED)]))
    assert image.light[MIDDLE] == pytest.approx(CLEAR * TINT * 2, rel=1e-4)


LIGHTS = {
    "sun": {"sun": Sun(np.array([0.0, 0.0, -1.0]), np.full(3, 2.0))},
    "lamp": {"lamps": [AreaLight(np.array([0.0, 1.0, -3.0]), 0.1, np.full(3, 90.0))]},
    "beam": {
        "beams": (
            Beam(
                np.array([-9.0, -9.0, -4.0]), np.array([18.0, 0, 0]), np.array([0, 18.0, 0]), 1,
                np.array([0.0, 0.0, -1.0]), np.full(3, 2.0),
            ),
        )
    },
    "ambient": {"ambient": np.full(3, 1.0)},
}  # fmt: skip


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS)
def test_light_on_a_thing_behind_a_pane_has_passed_it_as_well(seen, light):
    bare = seen(scene([wall(3.0, GREY)], **light)).light[MIDDLE]
    behind = seen(scene([wall(2.9, material(TINT, clear=1.0)), wall(3.0, GREY)], **light))
    assert bare.min() > 0.3
    assert behind.light[MIDDLE] == pytest.approx(TINT**2 * bare, rel=0.03)
    blocked = scene([Part(quad((-50, -50, 2.9), (100, 0, 0), (0, 100, 0)), OPAQUE)], **light)
    assert not seen(blocked).light.any()


def test_a_pane_behind_a_lamp_takes_nothing_from_it(seen):
    bare = scene([wall(3.0, GREY)], **LIGHTS["lamp"])
    before = scene([wall(3.0, GREY), wall(-4.0, pane())], **LIGHTS["lamp"])
    assert seen(before).light == pytest.approx(seen(bare).light)


def test_paths_go_on_as_far_as_the_first_thing_that_no_light_passes(stage):
    world = stage(scene([wall(1.0, pane()), wall(2.0, pane()), wall(5.0, GREY)]))
    start = np.zeros((2, 3), np.float32)
    paths = np.array([(0, 0, 2.0), (0, 0, -2.0)], np.float32)
    distance, share = unblocked(world, start, paths)
    assert distance[0] == pytest.approx(2.5, rel=1e-4)
    assert distance[1] > 1e30
    assert share[0] == pytest.approx((CLEAR * TINT) ** 2)
    assert share[1] == pytest.approx(np.ones(3))


def test_textures_behind_a_pane_are_as_coarse_as_without_it(stage):
    checks = material((0.5,) * 3)
    plain, glazed = (
        stage(scene([*before, wall(8.0, checks)])) for before in ([], [wall(2.0, pane())])
    )
    origin = np.array([[0, 1.0, 0]], np.float32)
    ahead = np.array([[0.1, 0.2, 1.0]], np.float32)
    sizes = [
        passed(each, *each.hits(origin, ahead, 50.0), ahead, 50.0)[0].footprint[0]
        for each in (plain, glazed)
    ]
    assert sizes[1] == pytest.approx(sizes[0], rel=1e-3)
