import numpy as np
import pytest

from flexdepth.synth.correspondence import (
    Camera,
    correspondence,
    other_from_this,
    parallax,
)
from flexdepth.synth.shapes import blob, quad
from flexdepth.synth.viewpoints import Viewpoint, looking

FOCAL, WIDTH, HEIGHT = 100.0, 96, 64
AHEAD = looking(0, 0, 0)
"""Looks along z; the camera's x is the world's -x, its y the world's -y."""


def camera(eye=(0, 0, 0), rotation=AHEAD):
    return Camera(Viewpoint(np.asarray(eye, float), rotation, 0.8), FOCAL, WIDTH, HEIGHT)


def facing(z, width, height, at=0.0):
    return quad((at - width / 2, -height / 2, z), (width, 0, 0), (0, height, 0))


def between(play, here, there, times=(0.0, 1.0)):
    first, second = (play.at(time) for time in times)
    sight = first.sight(here.view, here.rays(here.pixels()))
    return sight, correspondence((here, first, sight), (there, second))


def test_a_step_aside_moves_a_wall_by_focal_length_times_step_over_depth(play):
    sight, way = between(play([facing(4.0, 50, 50)]), camera(), camera((-0.2, 0, 0)))
    assert way.flow[..., 0] == pytest.approx(np.full((HEIGHT, WIDTH), -5.0), abs=1e-10)
    assert way.flow[..., 1] == pytest.approx(np.zeros((HEIGHT, WIDTH)), abs=1e-10)
    assert not way.moving.any()
    assert (way.occluded == (np.arange(WIDTH) < 4.5)).all()
    pose = other_from_this(camera().view, camera((-0.2, 0, 0)).view)
    assert parallax(sight, camera(), pose) == pytest.approx(np.full(WIDTH * HEIGHT, 5.0))


def test_a_step_forward_moves_points_away_from_the_middle(play):
    _, way = between(play([facing(4.0, 50, 50)]), camera(), camera((0, 0, 1.0)))
    place = camera().pixels().reshape(HEIGHT, WIDTH, 2) - (WIDTH / 2, HEIGHT / 2)
    assert way.flow == pytest.approx(place / 3, abs=1e-10)


def test_the_sky_moves_as_the_camera_turns_and_not_as_it_travels(play):
    turned = camera((3.0, 1.0, -2.0), looking(0.1, 0, 0))
    sight, way = between(play([facing(4.0, 1.0, 1.0)]), camera(), turned)
    sky = np.isinf(sight.depth).reshape(HEIGHT, WIDTH)
    across = np.broadcast_to(np.arange(WIDTH) + 0.5 - WIDTH / 2, (HEIGHT, WIDTH)) / FOCAL
    # Yaw goes from z to x, which is to the camera's left.
    expected = FOCAL * np.tan(np.arctan(across) + 0.1) - FOCAL * across
    assert way.flow[sky][:, 0] == pytest.approx(expected[sky], abs=1e-9)
    leaves = across * FOCAL + expected > WIDTH / 2
    assert leaves[sky].any()
    assert way.occluded[sky & leaves].all()


def test_a_mover_moves_by_its_own_motion_and_the_wall_behind_does_not(play):
    filmed = play([facing(8.0, 50, 50)], [(facing(4.0, 1.04, 1.04), (-0.4, 0, 0))])
    sight, way = between(filmed, camera(), camera())
    front = (sight.depth < 5).reshape(HEIGHT, WIDTH)
    assert front.sum() == 26 * 26
    assert (way.moving == front).all()
    assert way.flow[front] == pytest.approx(np.tile((10.0, 0.0), (front.sum(), 1)), abs=1e-10)
    assert way.motion[front] == pytest.approx(np.tile((0.4, 0, 0), (front.sum(), 1)), abs=1e-12)
    assert np.abs(way.flow[~front]).max() < 1e-12
    assert (way.motion[~front] == 0).all()
    # The square moves 10 columns to the right: so many of the wall disappear behind it.
    hidden = way.occluded & ~front
    assert (hidden.sum(1)[hidden.any(1)] == 10).all()
    assert np.flatnonzero(hidden.any(0)).min() > np.flatnonzero(front.any(0)).max()


def test_a_millionth_of_a_metre_is_what_counts_as_moving(play):
    for step, moves in ((0.9e-6, False), (1.1e-6, True)):
        filmed = play([facing(8.0, 50, 50)], [(facing(4.0, 1.0, 1.0), (-step, 0, 0))])
        assert between(filmed, camera(), camera())[1].moving.any() == moves


def test_what_comes_towards_the_camera_and_passes_it_has_no_flow(play):
    filmed = play([facing(8.0, 50, 50)], [(facing(4.0, 1.0, 1.0), (0, 0, -5.0))])
    sight, way = between(filmed, camera(), camera())
    front = (sight.depth < 5).reshape(HEIGHT, WIDTH)
    assert np.isnan(way.flow[front]).all()
    assert way.occluded[front].all()
    assert np.isfinite(way.flow[~front]).all()


def world(play):
    """Return a wall, the ground, a lump that grows and goes, and two cameras that see them."""
    lump = blob(np.random.default_rng(0), (1.2, 1.2, 1.2), 0.15)
    filmed = play(
        [facing(9.0, 60, 60), quad((-30, -1, -5), (60, 0, 0), (0, 0, 14))],
        [(lump.placed((0.2, 0, 4)), (0.15, 0.05, -0.1), 0.05)],
    )
    return filmed, camera(), camera((0.2, 0.05, 0.3), looking(0.03, -0.02, 0.01))


def test_depth_flow_and_poses_agree_by_reprojection(play):
    filmed, here, there = world(play)
    sight, way = between(filmed, here, there)
    # Project with a 4 x 4 matrix and a camera matrix, as a user of the files would.
    matrix = {}
    for name, each in (("here", here), ("there", there)):
        matrix[name] = np.eye(4)
        matrix[name][:3, :3], matrix[name][:3, 3] = each.view.world_from_camera, each.view.eye
    there_from_here = np.linalg.inv(matrix["there"]) @ matrix["here"]
    pinhole = np.array([[FOCAL, 0, WIDTH / 2], [0, FOCAL, HEIGHT / 2], [0, 0, 1]])
    pixel = np.column_stack([here.pixels(), np.ones(WIDTH * HEIGHT)])
    point = sight.depth[:, None] * (pixel @ np.linalg.inv(pinhole).T) + way.motion.reshape(-1, 3)
    image = (point @ there_from_here[:3, :3].T + there_from_here[:3, 3]) @ pinhole.T
    expected = image[:, :2] / image[:, 2:] - here.pixels()
    assert way.flow.reshape(-1, 2) == pytest.approx(expected, abs=1e-8)
    assert 0.02 < way.moving.mean() < 0.3


def test_following_the_flow_there_and_back_returns_to_the_pixel(play):
    filmed, here, there = world(play)
    sight, way = between(filmed, here, there)
    first, second = filmed.at(0.0), filmed.at(1.0)
    shown = ~way.occluded.ravel()
    arrived = (here.pixels() + way.flow.reshape(-1, 2))[shown]
    other = second.sight(there.view, there.rays(arrived))
    # What the second camera sees at the arrival is traced anew: its depth owes the flow nothing.
    same = other.triangle == sight.triangle[shown]
    assert same.mean() > 0.99
    back = np.zeros((len(arrived), 3))
    own = same & (other.triangle >= len(second.still))
    rows = other.triangle[own] - len(second.still)
    shift = first.moving[rows] - second.moving[rows]
    back[own] = (other.weights[own, :, None] * shift).sum(1)
    world_point = (
        there.view.eye + other.depth[:, None] * (other.rays @ there.view.world_from_camera.T) + back
    )
    inside = (world_point - here.view.eye) @ here.view.world_from_camera
    returned = FOCAL * inside[:, :2] / inside[:, 2:] + (WIDTH / 2, HEIGHT / 2)
    assert returned[same] == pytest.approx(here.pixels()[shown][same], abs=1e-7)
    assert own.mean() > 0.01
