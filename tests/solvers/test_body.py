"""What a thing's own shape tells of its scale."""

import numpy as np
import pytest

from flexdepth.solvers.body import ball_at_rest
from flexdepth.solvers.ground import Ground

FLOOR = Ground(np.array([0.0, 1 / 1.5, 0.0]), 1.0)
"""Level, 1.5 below the camera."""


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
    assert ball_at_rest(points, 0.5 * scale, FLOOR) == pytest.approx(np.log(scale), abs=1e-6)


def test_a_box_is_no_ball():
    across, up = np.meshgrid(np.linspace(-0.3, 0.3, 20), np.linspace(-0.3, 0.3, 20))
    face = np.stack([across, up + 1.0, 4 - 0.5 * across], -1).reshape(-1, 3)
    side = np.stack([np.full_like(up, 0.3), up + 1.0, 4 + across], -1).reshape(-1, 3)
    assert ball_at_rest(np.concatenate([face, side]), 0.6, FLOOR) is None


def test_what_is_nearly_flat_is_no_ball_as_large_as_a_house():
    across, up = np.meshgrid(np.linspace(-0.3, 0.3, 20), np.linspace(-0.3, 0.3, 20))
    deep = 40 - np.sqrt(36.0**2 - across**2 - up**2)
    assert ball_at_rest(np.stack([across, up + 1.0, deep], -1).reshape(-1, 3), 0.6, FLOOR) is None


def test_a_ball_that_reaches_above_the_camera_alone_has_no_place_on_the_ground():
    assert ball_at_rest(front((0.0, -2.0, 4.0), 0.3), 0.5, FLOOR) is None
