import numpy as np
import pytest

from flexdepth.solvers.pose import Pose, angle, turned
from flexdepth.solvers.transfer import Planar, Transfer, Turning, first_rotation, plane_motions

WALL = np.array([0.05, 0.1, 0.15])


def transfer(seen):
    return Transfer(*seen.rays(), seen.focal, seen.noise)


def test_the_residual_is_said_minus_seen_over_the_noise():
    seen = Transfer(
        np.array([[0.0, 0, 1]]), np.array([[0.01, 0, 1]]), np.array([500.0, 520.0]), np.array([2.0])
    )
    np.testing.assert_allclose(seen.residuals(np.eye(3)), [[-2.5, 0]])


@pytest.mark.parametrize("kind", [Turning, Planar])
def test_jacobians_are_those_of_finite_differences(see, rotation, kind):
    seen = kind(transfer(see(rotation, (0.2, 0, 0), count=30)))
    state = rotation / np.linalg.norm(rotation) if kind is Planar else rotation
    jacobian = seen.jacobian(state)
    small = 1e-7
    for column, step in enumerate(small * np.eye(jacobian.shape[2])):
        ahead, behind = (seen.residuals(seen.moved(state, sign * step)) for sign in (1, -1))
        slope = (ahead - behind) / (2 * small)
        np.testing.assert_allclose(jacobian[:, :, column], slope, atol=1e-6 * np.abs(slope).max())


def test_a_first_rotation_is_found_among_points_that_move_by_themselves(see, rotation):
    found = first_rotation(transfer(see(rotation, noise=0.3, movers=0.3)))
    assert angle(found @ rotation.T) < 1e-3


@pytest.mark.parametrize("length", [0.5, 0.01, 1e-4])
def test_a_plane_gives_its_motion_back_among_at_most_two(see, rotation, length):
    away = np.array([0.6, 0, -0.8])
    homography = rotation + length * np.outer(away, WALL)
    key, _ = see(rotation, plane=WALL).rays()
    for factor in (1, -2.5):
        found = plane_motions(factor * homography, key)
        assert 1 <= len(found) <= 2
        off = [
            angle(pose.rotation @ rotation.T)
            + np.linalg.norm(pose.translation - away)
            + np.linalg.norm(normal - WALL / np.linalg.norm(WALL))
            for pose, normal in found
        ]
        assert min(off) < 1e-9 / length
        for pose, normal in found:
            again = pose.rotation + length * np.linalg.norm(WALL) * np.outer(
                pose.translation, normal
            )
            np.testing.assert_allclose(again, homography, atol=1e-9)


@pytest.mark.parametrize("twist", [(0.01, 0.02, 0), (0, 0, 0)])
def test_a_homography_of_a_turn_alone_gives_the_turn(twist):
    turn = turned(np.eye(3), np.array(twist, float))
    key = np.column_stack([np.random.default_rng(0).uniform(-0.5, 0.5, (20, 2)), np.ones(20)])
    for pose, normal in plane_motions(turn, key):
        assert isinstance(pose, Pose)
        assert angle(pose.rotation @ turn.T) < 1e-6
        assert np.linalg.norm(pose.translation) == pytest.approx(1)
        assert np.linalg.norm(normal) == pytest.approx(1)
