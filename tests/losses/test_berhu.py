import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.testing import assert_close

from flexdepth.losses.berhu import berhu, mean_berhu

EVERYWHERE = torch.ones(1, 1, 4, dtype=torch.bool)


def test_four_errors_worked_by_hand():
    # The largest error is 10, so c = 2: |−1| and 2 as they are, (9 + 4) / 4 and (100 + 4) / 4.
    depth = torch.tensor([[[0.0, 3.0, 4.0, 11.0]]])
    loss = mean_berhu(depth, torch.ones(1, 1, 4), EVERYWHERE, 0.2)
    assert loss.item() == pytest.approx((1 + 2 + 3.25 + 26) / 4)


@pytest.mark.parametrize(
    ("error", "expected"), [(0.0, 0.0), (-1.5, 1.5), (2.0, 2.0), (4.0, 5.0), (-6.0, 10.0)]
)
def test_linear_up_to_the_threshold_of_two_and_quadratic_beyond(error, expected):
    assert berhu(torch.tensor(error), torch.tensor(2.0)).item() == pytest.approx(expected)


def test_both_pieces_meet_with_slope_one():
    c = torch.tensor(0.7, dtype=torch.float64)
    x = torch.tensor([0.7 - 1e-9, 0.7 + 1e-9], dtype=torch.float64, requires_grad=True)
    value = berhu(x, c)
    assert_close(value[0], value[1], atol=1e-8, rtol=0)
    (slope,) = torch.autograd.grad(value.sum(), x)
    assert_close(slope, torch.ones(2, dtype=torch.float64), atol=1e-8, rtol=0)


@given(st.floats(0.01, 100))
def test_errors_so_many_times_larger_cost_so_many_times_more(factor):
    generator = torch.Generator().manual_seed(5)
    depth, truth = torch.rand(2, 2, 3, 4, generator=generator, dtype=torch.float64)
    valid = torch.rand(2, 3, 4, generator=generator) < 0.7
    whole = mean_berhu(depth, truth, valid, 0.2)
    assert_close(mean_berhu(factor * depth, factor * truth, valid, 0.2), factor * whole)


def test_the_threshold_is_that_of_the_whole_batch():
    # Alone, an error of 1 has c = 0.2 and costs 2.6; beside one of 10 it costs 1.
    depth = torch.tensor([[[1.0]], [[10.0]]])
    loss = mean_berhu(depth, torch.zeros(2, 1, 1), torch.ones(2, 1, 1, dtype=torch.bool), 0.2)
    assert loss.item() == pytest.approx((1 + 26) / 2)


def test_without_an_error_there_is_neither_loss_nor_gradient():
    depth = torch.full((1, 1, 4), 3.0, requires_grad=True)
    loss = mean_berhu(depth, depth.detach(), EVERYWHERE, 0.2)
    assert loss.item() == 0
    assert not torch.autograd.grad(loss, depth)[0].any()


def test_gradients_are_those_of_finite_differences_at_a_fixed_threshold():
    x = torch.tensor([-3.0, -0.4, 0.3, 0.9, 2.0], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(lambda x: berhu(x, x.new_tensor(0.6)), x)


def test_the_threshold_is_no_reason_to_make_the_largest_error_larger():
    # At c = 2 the slope is 10 / 2 there; through c it would be less.
    depth = torch.tensor([[[10.0, 1.0]]], requires_grad=True)
    both = torch.ones(1, 1, 2, dtype=torch.bool)
    loss = mean_berhu(depth, torch.zeros(1, 1, 2), both, 0.2)
    (slope,) = torch.autograd.grad(loss, depth)
    assert_close(slope, torch.tensor([[[2.5, 0.5]]]))
