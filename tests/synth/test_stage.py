import numpy as np
import pytest

from flexdepth.synth.shapes import box, quad, revolved
from flexdepth.synth.stage import dot, smooth_normals, unit


def test_a_box_keeps_flat_faces():
    normals = smooth_normals([box((1, 2, 3), (1, 2, 0.5))])
    assert np.abs(normals).max(-1) == pytest.approx(np.ones((12, 3)), abs=1e-6)


def test_a_cylinder_is_round():
    tube = revolved([(1.0, 0.0), (1.0, 2.0)], 24)
    normals = smooth_normals([tube]).reshape(-1, 3)
    outward = tube.corners.reshape(-1, 3) * (1, 0, 1)
    assert np.abs((normals * outward).sum(1)) == pytest.approx(np.ones(len(normals)), abs=0.01)


def test_things_that_touch_are_not_shaded_as_one():
    floor = quad((0, 0, 0), (1, 0, 0), (0, 0, 1))
    slope = quad((0, 0, 1), (1, 0, 0), (0, 0.3, 1))
    apart = smooth_normals([floor, slope])
    assert np.abs(apart[:2]) == pytest.approx(np.tile((0, 1, 0), (2, 3, 1)), abs=1e-6)


def test_no_mesh_has_no_normals():
    assert smooth_normals([]).shape == (0, 3, 3)


def test_unit_and_dot_are_what_they_say():
    rows = np.array([[3, 0, 4], [0, 2, 0]], np.float32)
    assert unit(rows) == pytest.approx(np.array([[0.6, 0, 0.8], [0, 1, 0]]))
    assert dot(rows, rows) == pytest.approx([25, 4])
