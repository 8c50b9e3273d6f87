import numpy as np
import pytest

from flexdepth.synth.skins import limb, skin


def test_a_straight_skin_is_an_elliptic_cylinder():
    line = np.stack([np.zeros(5), np.linspace(0, 2, 5), np.zeros(5)], 1)
    mesh = skin(line, (1.0, 0, 0), np.tile((0.3, 0.1), (5, 1)), 24)
    points = mesh.corners.reshape(-1, 3)
    rim = points[np.hypot(points[:, 0], points[:, 2]) > 1e-9]
    assert np.hypot(rim[:, 0] / 0.3, rim[:, 2] / 0.1) == pytest.approx(np.ones(len(rim)))
    assert points[:, 1].min() == 0
    assert points[:, 1].max() == 2


def test_bending_moves_corners_and_keeps_triangles():
    straight = limb([(0, 0, 0), (0, -1, 0), (0, -2, 0)], np.array([1.0, 0, 0]), (0.1, 0.1))
    crooked = limb([(0, 0, 0), (0, -1, 0), (0, -1, 1)], np.array([1.0, 0, 0]), (0.1, 0.1))
    assert straight.corners.shape == crooked.corners.shape
    assert crooked.corners[..., 2].max() == pytest.approx(1.08, abs=0.01)


def test_a_limb_is_rounded_beyond_its_ends():
    mesh = limb([(0, 0, 0), (0, -1, 0)], np.array([1.0, 0, 0]), (0.1, 0.05))
    assert mesh.corners[..., 1].max() == pytest.approx(0.08)
    assert mesh.corners[..., 1].min() == pytest.approx(-1.04)
