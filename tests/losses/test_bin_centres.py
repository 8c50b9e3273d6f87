import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.testing import assert_close

from flexdepth.losses.bin_centres import chamfer, nearest

DOUBLE = torch.float64


def some(seed: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(seed)
    centres = 10 * torch.rand(3, 7, generator=generator, dtype=DOUBLE)
    truth = 10 * torch.rand(3, 4, 5, generator=generator, dtype=DOUBLE)
    return centres, truth, torch.rand(3, 4, 5, generator=generator) < 0.6


def test_two_bins_and_three_depths_worked_by_hand():
    # Depths 1, 2, 6 lie 1, 0 and 1 from the bins 2 and 7; the bins 0 and 1 from the depths.
    truth = torch.tensor([[[6.0, 1.0, 2.0]]])
    everywhere = torch.ones(1, 1, 3, dtype=torch.bool)
    loss = chamfer(torch.tensor([[2.0, 7.0]]), truth, everywhere)
    assert loss.item() == pytest.approx((1 + 0 + 1) / 3 + (0 + 1) / 2)


@given(st.integers(0, 40))
def test_it_is_the_mean_over_all_pairs_least_distances(seed):
    centres, truth, valid = some(seed)
    for got, c, x, known in zip(chamfer(centres, truth, valid), centres, truth, valid, strict=True):
        apart = (x[known][:, None] - c).square()
        assert_close(got, apart.min(1).values.mean() + apart.min(0).values.mean())


@given(st.lists(st.floats(-5, 5), min_size=1, max_size=6), st.floats(-6, 6))
def test_the_nearest_of_an_ordered_row_is_found(numbers, wanted):
    ordered = torch.tensor(sorted(numbers), dtype=DOUBLE)[None]
    at = torch.tensor([[wanted]], dtype=DOUBLE)
    found = nearest(at, ordered, torch.tensor([len(numbers)]))
    assert (found - wanted).abs().item() == min(abs(x - wanted) for x in numbers)


def test_the_order_of_bins_and_pixels_means_nothing():
    centres, truth, valid = some(1)
    turned = chamfer(centres.flip(1), truth.flip(1), valid.flip(1))
    assert_close(turned, chamfer(centres, truth, valid))


def test_bins_on_every_depth_and_depths_in_every_bin_cost_nothing():
    truth = torch.tensor([[[1.0, 2.0], [2.0, 5.0]]])
    everywhere = torch.ones(1, 2, 2, dtype=torch.bool)
    assert chamfer(torch.tensor([[5.0, 1.0, 2.0]]), truth, everywhere).item() == 0


def test_gradients_are_those_of_finite_differences():
    centres, truth, valid = some(2)
    assert torch.autograd.gradcheck(
        lambda c: chamfer(c, truth, valid), centres.requires_grad_(True)
    )


@pytest.mark.parametrize("rubbish", [0.0, -1.0, torch.nan, torch.inf])
def test_unknown_depth_is_no_depth(rubbish):
    centres, truth, valid = some(3)
    valid[1] = False
    spoilt = truth.where(valid, rubbish)
    centres.requires_grad_(True)
    got, wanted = (chamfer(centres, x, valid) for x in (spoilt, truth))
    assert_close(got, wanted)
    assert got[1] == 0
    (gradient,) = torch.autograd.grad(got.sum(), centres)
    assert gradient.isfinite().all()
    assert not gradient[1].any()
