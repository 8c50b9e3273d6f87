from math import cos, pi, sin

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.autograd import gradcheck, gradgradcheck
from torch.testing import assert_close

from flexdepth.geometry.pose import cross_matrix, rotated, rotation_exp, rotation_log

THRESHOLD = 0.5
ANGLES = [0.0, 1e-8, 1e-4, THRESHOLD - 1e-6, THRESHOLD + 1e-6, 3.0, 30.0]

at_every_angle = pytest.mark.parametrize("angle", ANGLES)
numbers = st.tuples(*[st.floats(-3, 3)] * 3)


def vector(angle: float) -> torch.Tensor:
    return angle * torch.tensor([2.0, -1.0, 2.0], dtype=torch.float64) / 3


def test_a_quarter_turn_about_z_takes_x_to_y():
    n = torch.tensor([0.0, 0.0, pi / 2], dtype=torch.float64)
    x, y = torch.eye(3, dtype=torch.float64)[:2]
    assert_close(rotation_exp(n) @ x, y)
    assert_close(rotated(n, x), y)


@at_every_angle
def test_it_is_the_matrix_exponential(angle):
    n = vector(angle)
    assert_close(rotation_exp(n), torch.linalg.matrix_exp(cross_matrix(n)), rtol=0, atol=1e-13)


@given(numbers, numbers)
def test_turning_a_vector_is_the_matrix_times_it(n, v):
    n, v = (torch.tensor(x, dtype=torch.float64) for x in (n, v))
    assert_close(rotated(n, v), rotation_exp(n) @ v)


@at_every_angle
def test_first_and_second_derivatives_are_those_of_finite_differences(angle):
    n = vector(angle).requires_grad_(True)
    assert gradcheck(rotation_exp, n)
    assert gradgradcheck(rotation_exp, n)
    v = torch.tensor([0.3, -0.7, 1.1], dtype=torch.float64, requires_grad=True)
    assert gradcheck(rotated, (n, v))
    assert gradgradcheck(rotated, (n, v))


def test_the_derivative_at_no_rotation_is_the_cross_product():
    n = torch.zeros(3, dtype=torch.float64)
    got = torch.autograd.functional.jacobian(rotation_exp, n)
    generators = torch.stack([cross_matrix(axis) for axis in torch.eye(3, dtype=torch.float64)], -1)
    assert_close(got, generators)


@pytest.mark.parametrize("exponent", range(-12, 1))
def test_single_precision_is_as_exact_as_it_can_be_at_every_angle(exponent):
    n = vector(10.0**exponent)
    exact = rotation_exp(n).float()
    assert_close(rotation_exp(n.float()), exact, rtol=0, atol=3e-7)


@pytest.mark.parametrize("angle", [1e-4, 1e-3, 1e-2])
def test_single_precision_keeps_the_second_order_near_no_rotation(angle):
    # R_xy + R_yx = n_x n_y: in float32, (1 - cos 1e-4) / 1e-8 would be 0 and not 1/2.
    n = vector(angle).float()
    rotation = rotation_exp(n)
    assert (rotation[0, 1] + rotation[1, 0]).item() == pytest.approx(-2 / 9 * angle**2, rel=0.01)


@given(numbers)
def test_the_logarithm_undoes_it_below_half_a_turn(n):
    n = torch.tensor(n, dtype=torch.float64)
    n = n * torch.clamp(3.1 / n.norm().clamp(min=1e-300), max=1.0)
    assert_close(rotation_log(rotation_exp(n)), n, rtol=0, atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-8, 1e-4, 1e-3, 1.0, 3.0])
def test_the_logarithm_is_differentiable(angle):
    n = vector(angle).requires_grad_(True)
    assert gradcheck(lambda each: rotation_log(rotation_exp(each)), n)


def test_half_a_turn_has_a_logarithm():
    half = torch.diag(torch.tensor([1.0, -1.0, -1.0], dtype=torch.float64))
    assert_close(rotation_log(half).abs(), torch.tensor([pi, 0, 0], dtype=torch.float64))


def test_batches_are_singles():
    n = torch.stack([vector(angle) for angle in ANGLES]).reshape(7, 1, 3)
    assert rotation_exp(n).shape == (7, 1, 3, 3)
    for k, angle in enumerate(ANGLES):
        assert_close(rotation_exp(n)[k, 0], rotation_exp(vector(angle)))
        assert_close(rotation_log(rotation_exp(n))[k, 0], rotation_log(rotation_exp(vector(angle))))


def test_a_turn_about_y_is_the_one_that_is_written_out():
    c, s = cos(0.4), sin(0.4)
    expected = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    n = torch.tensor([0.0, 0.4, 0.0], dtype=torch.float64)
    assert np.abs(rotation_exp(n).numpy() - expected).max() < 1e-15
