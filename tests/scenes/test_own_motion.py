import cv2
import numpy as np

from flexdepth.scenes.own_motion import own_motion, own_ways, turned

QUARTER = np.array([0.0, np.pi / 2, 0.0])
TURN = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
"""The same as a matrix."""


def test_points_turn_as_opencv_turns_them():
    rng = np.random.default_rng(0)
    points, twists = rng.normal(size=(2, 20, 3))
    twists[0], twists[1] = 0.0, (1e-9, 0, 0)
    each = [cv2.Rodrigues(n)[0] @ x for n, x in zip(twists, points, strict=True)]
    np.testing.assert_allclose(turned(points, twists), each, atol=1e-12)


def test_a_point_that_stays_in_the_world_has_no_motion_of_its_own():
    way = np.array([0.3, -0.2, 1.0])
    points = np.array([[1.0, 2, 5], [-1, 0, 3]])
    same = np.tile(QUARTER, (2, 1)), np.tile(way, (2, 1))
    np.testing.assert_allclose(own_motion(points, same, (TURN, way)), 0, atol=1e-12)


def test_own_motion_is_told_along_the_axes_of_the_key_camera():
    points, steps = np.array([[1.0, 2, 5]]), np.array([[0.5, 0.0, -0.25]])
    moved = QUARTER[None], steps @ TURN.T  # R (X + step) = R X + R step
    found = own_motion(points, moved, (TURN, np.zeros(3)))
    np.testing.assert_allclose(found, steps, atol=1e-12)


def test_the_square_goes_up_and_lies_where_its_depth_says(solution):
    here, ways = own_ways(solution, solution.found.moving)
    np.testing.assert_allclose(here[:, 2], 3)
    np.testing.assert_allclose(ways, np.tile([0, -0.5, 0], (len(ways), 1)), atol=1e-12)
