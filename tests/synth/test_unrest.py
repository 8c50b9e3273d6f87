from dataclasses import replace

import numpy as np
import pytest

from flexdepth.synth.render import Rendering
from flexdepth.synth.shapes import box
from flexdepth.synth.unrest import (
    DRIVING,
    ROLLING,
    STANDING,
    WALKING,
    Gait,
    Unrest,
    blurred,
    gait_of,
    unsteady,
)
from flexdepth.synth.viewpoints import Viewpoint, looking

WIDTH, HEIGHT, FOCAL = 80, 60, 70.0
VIEW = Viewpoint(np.array([0.3, 1.6, -2.0]), looking(0.4, -0.1, 0.05), FOCAL / 100)
EVENLY = np.linspace(-1, 1, 13)[:, None]


def unrest(turned=(0, 0, 0), gone=(0, 0, 0)):
    """Return a camera that goes evenly, so far to either side of the middle."""
    return Unrest(EVENLY * turned, EVENLY * gone)


def halves(near, far):
    """A bright half on the left, as near as is said, before a dark one."""
    light, depth = np.zeros((HEIGHT, WIDTH, 3), np.float32), np.full((HEIGHT, WIDTH), far)
    light[:, : WIDTH // 2], depth[:, : WIDTH // 2] = 1, near
    return Rendering(light, depth.astype(np.float32), FOCAL)


def width_of_edge(row):
    """Return the width of a step as a box that blurs it has it, from the spread of its slope."""
    slope = np.abs(np.diff(row))
    place = np.arange(len(slope))
    mean = (slope * place).sum() / slope.sum()
    return np.sqrt(12 * (slope * (place - mean) ** 2).sum() / slope.sum())


def middle_of_edge(row):
    """Return where a step would stand that leaves as much light."""
    return row.sum()


def test_a_camera_that_goes_nowhere_leaves_the_light_alone():
    seen = halves(2.0, 5.0)
    assert blurred(seen, VIEW, unrest()) is seen.light


@pytest.mark.parametrize("depth", [1.0, 30.0, np.inf])
def test_turning_blurs_all_depths_alike(depth):
    # About the camera's y the middle of the picture goes by focal * tan(0.05) to either side.
    row = blurred(halves(depth, depth), VIEW, unrest(turned=(0, 0.05, 0)))[30, :, 0]
    assert width_of_edge(row) == pytest.approx(2 * FOCAL * np.tan(0.05), abs=0.9)
    assert middle_of_edge(row) == pytest.approx(40, abs=0.2)


def test_going_sideways_blurs_by_focal_over_depth():
    # 70 pixels * 0.1 m / 1 m: 7 pixels to either side; at 4 m a quarter, at infinity nothing.
    widths = [
        width_of_edge(blurred(halves(z, z), VIEW, unrest(gone=(0.1, 0, 0)))[30, :, 0])
        for z in (1.0, 4.0)
    ]
    assert widths == pytest.approx([14, 3.5], abs=0.9)
    sky = halves(np.inf, np.inf)
    assert np.array_equal(blurred(sky, VIEW, unrest(gone=(0.1, 0, 0))), sky.light)


def test_going_ahead_blurs_away_from_the_middle_and_more_of_what_is_near():
    ring = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    ring[:, 60:] = ring[:, :20] = 1
    widths = []
    for z in (1.0, 3.0):
        seen = Rendering(ring, np.full((HEIGHT, WIDTH), z, np.float32), FOCAL)
        row = blurred(seen, VIEW, unrest(gone=(0, 0, 0.1)))[30, :, 0]
        widths.append((width_of_edge(row[:40]), width_of_edge(row[40:])))
    # The edges, 20 pixels from the middle, go from 20 z / (z + .1) to 20 z / (z - .1).
    assert widths[0] == pytest.approx([4.0, 4.0], abs=0.9)
    assert widths[1] == pytest.approx([1.3, 1.3], abs=0.9)


@pytest.mark.parametrize("gone", [(0.1, 0, 0), (-0.1, 0, 0), (0.07, 0.05, 0.02)])
def test_the_blurred_edge_of_a_near_thing_is_centred_on_the_edge_of_its_depth(gone):
    row = blurred(halves(1.0, 8.0), VIEW, unrest(gone=gone))[30, :, 0]
    assert width_of_edge(row) > 7
    assert middle_of_edge(row) == pytest.approx(40, abs=0.5)


def card_before_a_wall(view):
    """Return what a camera sees of a striped card before a striped wall, by rays and planes."""
    row, column = np.mgrid[:HEIGHT, :WIDTH]
    ray = np.stack(
        [(column + 0.5 - WIDTH / 2) / FOCAL, (row + 0.5 - HEIGHT / 2) / FOCAL, np.ones_like(row)],
        -1,
    )
    ray = ray @ view.world_from_camera.T
    depth, light = np.full((HEIGHT, WIDTH), np.inf), np.zeros((HEIGHT, WIDTH))
    for plane, (left, right), number in ((6.0, (-99, 99), 3.0), (1.5, (-0.3, 0.25), 20.0)):
        z = (plane - view.eye[2]) / ray[..., 2]
        place = view.eye + z[..., None] * ray
        on = (left < place[..., 0]) & (place[..., 0] < right)
        shade = 0.5 + 0.4 * np.sin(number * place[..., 0]) * np.cos(number * place[..., 1])
        depth, light = np.where(on, z, depth), np.where(on, shade, light)
    shown = np.repeat(light[..., None], 3, -1).astype(np.float32)
    return Rendering(shown, depth.astype(np.float32), FOCAL)


@pytest.mark.parametrize(
    "way",
    [
        unrest(turned=(0.02, 0.06, 0.05)),
        unrest(gone=(0.08, 0.02, 0.0)),
        unrest(turned=(0.0, -0.03, 0.0), gone=(0.08, 0.0, 0.3)),
        Unrest(0.04 * np.cos(2 * EVENLY) * [1, 0, 0], 0.08 * EVENLY**3 * [1, 0, 0]),
    ],
    ids=["turning", "sideways", "ahead", "bent"],
)
def test_the_blur_is_the_mean_of_what_is_seen_on_the_way(way):
    view = Viewpoint(np.zeros(3), np.eye(3), FOCAL / 100)
    sharp = card_before_a_wall(view)
    times = np.linspace(-1, 1, 101)
    truth = np.mean([card_before_a_wall(way.at(view, time)).light for time in times], 0)
    inside = slice(10, -10), slice(10, -10)
    error, before = (
        np.abs(light - truth)[inside].mean() for light in (blurred(sharp, view, way), sharp.light)
    )
    assert before > 0.03
    assert error < 0.25 * before


def test_the_truth_is_that_of_the_mean_place():
    way = Unrest.drawn(np.random.default_rng(0), Gait(0.1, 0.4, (1, 2), 0.1), np.eye(3)[2], 0.1)
    assert np.abs(way.turned.mean(0)).max() < 1e-12
    assert np.abs(way.gone.mean(0)).max() < 1e-12
    # At 1 to 2 m/s it gets from one end of 0.1 s to the other, but for what sways.
    assert 0.07 < way.gone[-1, 2] - way.gone[0, 2] < 0.23


@pytest.fixture
def scene(play):
    return play([box((0, 0, 0), (1, 1, 1))]).stage.scene


def stills(scene, brightness, count=200):
    """Return the light of many stills of a textured wall, and what it is at rest."""
    light = np.random.default_rng(0).random((HEIGHT, WIDTH, 3)).astype(np.float32) + 0.5
    seen = replace(halves(2.0, 2.0), light=light * np.float32(brightness), focal=200.0)
    rng = np.random.default_rng(1)
    return [unsteady(rng, scene, VIEW, seen) for _ in range(count)], seen.light


def test_one_still_in_five_is_blurred(scene):
    taken, light = stills(scene, 1.0)
    moved = sum(one is not light for one in taken)
    # Some of those that move do so by less than a quarter of a pixel.
    assert 0.1 * len(taken) < moved < 0.25 * len(taken)


def test_where_there_is_less_light_stills_are_blurred_more(scene):
    def lost(brightness):
        taken, light = stills(scene, brightness)
        return np.mean([1 - one.std() / light.std() for one in taken if one is not light])

    assert lost(0.02) > 1.2 * lost(1.0)


def gaits(scene, view):
    rng = np.random.default_rng(0)
    return {gait_of(rng, scene, view) for _ in range(60)}


def test_who_looks_along_a_road_may_drive_and_nobody_else_does(scene):
    road = replace(scene, road=3.0)
    along = replace(VIEW, world_from_camera=looking(0.05, 0.0, 0.0))
    assert gaits(road, along) == {DRIVING, WALKING, STANDING}
    beside = replace(along, eye=np.array([9.0, 1.6, 0.0]))
    aside = replace(VIEW, world_from_camera=looking(1.3, 0.0, 0.0))
    for view, where in ((beside, road), (aside, road), (along, scene)):
        assert gaits(where, view) == {WALKING, STANDING}


def test_what_is_low_and_looks_ahead_may_be_a_robot(scene):
    low = replace(VIEW, eye=np.array([0.0, 0.4, 0.0]), world_from_camera=looking(1.3, 0.0, 0.0))
    assert gaits(scene, low) == {ROLLING, WALKING, STANDING}
