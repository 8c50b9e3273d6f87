import numpy as np
import pytest

from flexdepth.solvers.epipolar import Epipolar, essential, poses
from flexdepth.solvers.pose import Pose

AWAY = np.array([0.6, -0.0, 0.8])


def problem(seen):
    return Epipolar(*seen.rays(), seen.focal, seen.noise)


def test_exact_points_lie_on_their_epipolar_lines(see, rotation):
    seen = see(rotation, 0.7 * AWAY)
    pixels = problem(seen).residuals(Pose(rotation, AWAY)) * seen.noise[:, None]
    assert np.abs(pixels).max() < 1e-9


def test_the_residual_is_in_pixels_across_the_line():
    # The camera goes right: all lines are level. The point has gone down by 3 pixels of noise 2.
    ray, seen_at = np.array([[0.1, 0.2, 1]]), np.array([[-0.1, 0.2 + 3 / 500, 1]])
    focal, right = np.array([500.0, 500.0]), Pose(np.eye(3), np.array([1.0, 0, 0]))
    found = Epipolar(ray, seen_at, focal, np.array([2.0])).residuals(right)
    assert abs(found.item()) == pytest.approx(1.5)


def test_residuals_scatter_by_one_where_the_noise_is_what_it_is_said_to_be(see, rotation):
    for away, close in (((1.0, 0, 0), 0.03), ((0, 0, -1.0), 0.15)):
        # Going forward, what is near grows, and lines are not as steep in both frames.
        seen = see(rotation, np.array(away), count=5000, noise=0.3)
        found = problem(seen).residuals(Pose(rotation, np.array(away)))
        assert found.std() == pytest.approx(1, abs=close)


@pytest.mark.parametrize("away", [AWAY, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)])
def test_the_jacobian_is_that_of_finite_differences(see, rotation, away):
    seen = problem(see(rotation, (0.3, 0.1, -1), count=40, noise=2.0))
    state = Pose(rotation, np.array(away))
    small = 1e-6
    for column, step in enumerate(small * np.eye(5)):
        ahead, behind = (seen.residuals(seen.moved(state, sign * step)) for sign in (1, -1))
        slope = (ahead - behind) / (2 * small)
        found = seen.jacobian(state)[:, :, column]
        np.testing.assert_allclose(found, slope, rtol=1e-5, atol=1e-5 * np.abs(slope).max())


def test_a_step_stays_on_the_rotations_and_the_unit_sphere(see, rotation):
    moved = problem(see(rotation)).moved(Pose(rotation, AWAY), np.array([0.3, -0.2, 0.1, 0.5, -2]))
    np.testing.assert_allclose(moved.rotation @ moved.rotation.T, np.eye(3), atol=1e-14)
    assert np.linalg.norm(moved.translation) == pytest.approx(1)


def test_the_motion_is_among_the_four_of_its_essential_matrix(rotation):
    for sign in (1, -3):
        found = poses(sign * essential(Pose(rotation, AWAY)))
        assert len(found) == 4
        assert any(
            np.allclose(each.rotation, rotation) and np.allclose(each.translation, AWAY)
            for each in found
        )
        assert all(np.linalg.det(each.rotation) == pytest.approx(1) for each in found)


def test_a_camera_that_stays_has_finite_residuals(see):
    seen = problem(see(np.eye(3)))
    nowhere = Pose(np.eye(3), np.array([0.0, 0, 1]))
    assert np.isfinite(seen.residuals(nowhere)).all()
    assert np.isfinite(seen.jacobian(nowhere)).all()
