import pytest
import torch
from torch.autograd import gradcheck
from torch.testing import assert_close

from flexdepth.losses.motion_boundaries import motion_boundaries, motion_boundaries_as_written


def test_the_written_form_by_hand():
    # Channel one: |rise| 1, 2, 3, 10, 9; the .5 quantile is 3, below it lie 1 and 2: 3 / 5.
    # Channel two: 0, 0, 0, 0, 4: nothing lies below 0.
    rise = torch.tensor([[[1.0, -2.0, 3.0, 10.0, -9.0]], [[0.0, 0.0, 0.0, 0.0, 4.0]]])
    assert motion_boundaries_as_written(rise, 0.5).item() == pytest.approx((3 / 5 + 0) / 2)
    # Between the fourth and the fifth of five, at 9.4: 1 + 2 + 3 + 9; and at 1.6: 0.
    assert motion_boundaries_as_written(rise, 0.85).item() == pytest.approx((15 / 5 + 0) / 2)


def test_the_shared_form_by_hand():
    # |e| is 5, 0, 10; its median s = 5: mean of 5·25/50, 0, 5·100/125.
    rise = torch.tensor([[[3.0, 0.0, 6.0]], [[4.0, 0.0, -8.0]]])
    assert motion_boundaries(rise, 0.5).item() == pytest.approx((2.5 + 0 + 4) / 3)


def test_what_rises_most_is_let_go():
    rise = torch.full((6, 10, 10), 0.1, dtype=torch.float64)
    rise[:, 5, 5] = 1e3
    rise.requires_grad_(True)
    for loss in (motion_boundaries, motion_boundaries_as_written):
        (gradient,) = torch.autograd.grad(loss(rise, 0.9), rise)
        assert gradient[:, 5, 5].abs().max() < 1e-6
    (gradient,) = torch.autograd.grad(motion_boundaries(rise, 0.9), rise)
    assert gradient[:, 0, 0].min() > 1e-4


def test_a_component_alone_has_no_border_of_its_own():
    # A border in n alone: the shared form lets go of t there too, the written one does not.
    rise = torch.full((2, 8, 8), 0.1, dtype=torch.float64)
    rise[0, 4, :] = 100.0
    rise.requires_grad_(True)
    (shared,) = torch.autograd.grad(motion_boundaries(rise, 0.8), rise)
    assert shared[1, 4, 0] < 1e-3 * shared[1, 0, 0]
    noisy = rise.detach() * (1 + 0.01 * torch.rand(2, 8, 8, dtype=torch.float64))
    noisy.requires_grad_(True)
    (written,) = torch.autograd.grad(motion_boundaries_as_written(noisy, 0.8), noisy)
    assert written[1, 4].max() > 0


@pytest.mark.parametrize("loss", [motion_boundaries, motion_boundaries_as_written])
def test_a_constant_field_costs_nothing_and_pulls_nowhere(loss):
    rise = torch.zeros(2, 6, 7, 9, requires_grad=True)
    assert_close(loss(rise, 0.9), torch.zeros(2))
    (gradient,) = torch.autograd.grad(loss(rise, 0.9).sum(), rise)
    assert not gradient.any()


def test_the_border_s_height_takes_no_gradient():
    rise = torch.rand(2, 3, 4, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    square = rise.square().sum(0)
    scale = square.flatten().quantile(0.7)

    def fixed(each: torch.Tensor) -> torch.Tensor:
        of = each.square().sum(0)
        return (scale.sqrt() * of / (scale + of)).mean()

    rise.requires_grad_(True)
    (expected,) = torch.autograd.grad(fixed(rise), rise)
    (got,) = torch.autograd.grad(motion_boundaries(rise, 0.7), rise)
    assert_close(got, expected)
    assert gradcheck(fixed, rise)


@pytest.mark.parametrize("loss", [motion_boundaries, motion_boundaries_as_written])
def test_batches_are_singles(loss):
    rise = torch.randn(2, 3, 6, 5, 4, generator=torch.Generator().manual_seed(1))
    together = loss(rise, 0.9)
    assert together.shape == (2, 3)
    assert_close(together[1, 2], loss(rise[1, 2], 0.9))
