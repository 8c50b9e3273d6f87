"""What a rigid thing's shape and turning tell of its place."""

import cv2
import numpy as np
import pytest

from flexdepth.solvers.body import ball, tipping
from flexdepth.solvers.ground import Ground
from flexdepth.solvers.pose import Pose

FLOOR = Ground(np.array([0.0, 1 / 1.5, 0.0]), 1.0)
"""Level, 1.5 below the camera."""


CAMERA = Pose(cv2.Rodrigues(np.array([0.02, -0.05, 0.01]))[0], np.array([0.3, 0.0, 0.1]))
"""How the camera moves while things do."""


def turning(*axis):
    """Return the motion, to the camera, of what turns about an axis through (0, 0, 0)."""
    return Pose(CAMERA.rotation @ cv2.Rodrigues(np.array(axis, float))[0], np.zeros(3))


def front(middle, radius):
    """Return the points of a ball that the camera at 0 sees."""
    theta, phi = np.meshgrid(np.linspace(0.05, 3.1, 40), np.linspace(0, 6.28, 60))
    normals = np.stack(
        [np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1
    ).reshape(-1, 3)
    points = np.asarray(middle) + radius * normals
    return points[(points * normals).sum(axis=1) < 0]


@pytest.mark.parametrize("scale", [0.5, 1.0, 3.0])
def test_a_ball_lies_on_the_ground_at_one_scale(scale):
    # Its middle is 1.2 below the camera and its radius .3: together the ground's 1.5.
    points = front((0.4, 1.2, 4.0), 0.3) * scale
    assert ball(points, 0.5 * scale).at_rest(FLOOR) == pytest.approx(np.log(scale), abs=1e-6)


def test_a_box_is_no_ball():
    across, up = np.meshgrid(np.linspace(-0.3, 0.3, 20), np.linspace(-0.3, 0.3, 20))
    face = np.stack([across, up + 1.0, 4 - 0.5 * across], -1).reshape(-1, 3)
    side = np.stack([np.full_like(up, 0.3), up + 1.0, 4 + across], -1).reshape(-1, 3)
    assert ball(np.concatenate([face, side]), 0.6) is None


def test_what_is_nearly_flat_is_no_ball_as_large_as_a_house():
    across, up = np.meshgrid(np.linspace(-0.3, 0.3, 20), np.linspace(-0.3, 0.3, 20))
    deep = 40 - np.sqrt(36.0**2 - across**2 - up**2)
    assert ball(np.stack([across, up + 1.0, deep], -1).reshape(-1, 3), 0.6) is None


def test_a_ball_that_reaches_above_the_camera_alone_has_no_place_on_the_ground():
    assert ball(front((0.0, -2.0, 4.0), 0.3), 0.5).at_rest(FLOOR) is None


def test_a_ball_moves_as_its_middle_does_which_is_not_seen():
    # It turns by .4 about its middle, which goes (.12, 0, 0): X -> turn (X - C) + C + (.12, 0, 0).
    middle, turn = np.array([0.4, 1.2, 4.0]), cv2.Rodrigues(np.array([0.0, 0.0, 0.4]))[0]
    went = middle + np.array([0.12, 0.0, 0.0]) - turn @ middle
    motion = Pose(CAMERA.rotation @ turn, CAMERA.rotation @ went)
    moved = ball(front(middle, 0.3), 0.5).moved(motion, CAMERA)
    np.testing.assert_allclose(moved, [0.12, 0.0, 0.0], atol=1e-9)


def test_what_turns_about_an_upright_or_a_level_axis_does_not_tip():
    for axis in ((0, 0.3, 0), (0.3, 0, 0), (0.2, 0, -0.1)):
        assert tipping(turning(*axis), CAMERA, FLOOR) == pytest.approx(0.0, abs=1e-9)


def test_what_tumbles_tips_by_the_lesser_part_of_its_turn():
    assert tipping(turning(0.03, 0.1, 0.04), CAMERA, FLOOR) == pytest.approx(0.05, abs=1e-9)
    assert tipping(turning(0.3, 0.1, 0.4), CAMERA, FLOOR) == pytest.approx(0.1, abs=1e-9)
