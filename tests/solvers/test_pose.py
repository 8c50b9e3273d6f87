import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.solvers.pose import angle, cross, tangents, turned

numbers = st.tuples(*[st.floats(-3, 3)] * 3).map(np.array)


@given(numbers, numbers)
def test_the_cross_matrix_multiplies_as_the_cross_product(one, other):
    np.testing.assert_allclose(cross(one) @ other, np.cross(one, other), atol=1e-14)


def test_a_quarter_turn_about_z_takes_right_to_down():
    quarter = turned(np.eye(3), np.array([0, 0, np.pi / 2]))
    np.testing.assert_allclose(quarter @ (1, 0, 0), (0, 1, 0), atol=1e-15)
    half = turned(quarter, np.array([0, 0, np.pi / 2]))
    np.testing.assert_allclose(half @ (1, 0, 0), (-1, 0, 0), atol=1e-15)
    # The new turn is the outer one.
    tipped = turned(quarter, np.array([np.pi / 2, 0, 0]))
    np.testing.assert_allclose(tipped @ (1, 0, 0), (0, 0, 1), atol=1e-15)


@pytest.mark.parametrize("radians", [0.0, 1e-12, 1e-9, 1e-5, 0.1, 3.0, np.pi - 1e-6, np.pi])
def test_the_angle_of_a_turn_is_exact_from_nothing_to_a_half(radians):
    axis = np.array([2.0, -1, 2]) / 3
    assert angle(turned(np.eye(3), radians * axis)) == pytest.approx(radians, abs=1e-15, rel=1e-9)


@given(numbers.filter(lambda each: np.linalg.norm(each) > 0.1))
def test_tangents_are_orthonormal_and_orthogonal_to_the_vector(vector):
    unit = vector / np.linalg.norm(vector)
    frame = np.vstack([unit, tangents(unit)])
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
