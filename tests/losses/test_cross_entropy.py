from math import log

import pytest
import torch
from torch.testing import assert_close

from flexdepth.losses.cross_entropy import information_gain, weighted_cross_entropy

DOUBLE = torch.zeros((), dtype=torch.float64)
ONE = torch.ones(1, 1, 1, dtype=torch.bool)


def at(logits: torch.Tensor, label: int) -> float:
    label_map = torch.full((1, 1, 1), label)
    return weighted_cross_entropy(logits[None, :, None, None], label_map, ONE, 0.2).item()


def test_three_bins_worked_by_hand():
    # Falloff ln 2: the middle row is 1/2, 1, 1/2, divided by 2; the first 1, 1/2, 1/16 by 25/16.
    rows = information_gain(3, log(2), DOUBLE)
    assert_close(rows[1], DOUBLE.new_tensor([0.25, 0.5, 0.25]))
    assert_close(rows[0], DOUBLE.new_tensor([0.64, 0.32, 0.04]))
    logits = DOUBLE.new_tensor([0.5, 0.25, 0.25]).log()[None, :, None, None]
    loss = weighted_cross_entropy(logits, torch.zeros(1, 1, 1, dtype=torch.long), ONE, log(2))
    assert loss.item() == pytest.approx(0.64 * log(2) + 0.36 * log(4))


def test_the_rows_of_the_base_model():
    rows = information_gain(150, 0.2, DOUBLE)
    inside = DOUBLE.new_tensor([0.25231325, 0.20657662, 0.11337165, 0.04170710])
    edge = DOUBLE.new_tensor([0.40295549, 0.32991205, 0.18105957, 0.06660810])
    assert_close(rows[70, 70:74], inside, rtol=0, atol=5e-9)
    assert_close(rows[70, 67:71].flip(0), inside, rtol=0, atol=5e-9)
    assert_close(rows[0, :4], edge, rtol=0, atol=5e-9)
    assert_close(rows.sum(1), torch.ones(150, dtype=torch.float64))


@pytest.mark.parametrize(("bins", "uniform"), [(150, 5.010635), (100, 4.605170)])
def test_uniform_logits_cost_the_logarithm_of_the_number_of_bins(bins, uniform):
    assert at(torch.full((bins,), 3.0, dtype=torch.float64), 40) == pytest.approx(uniform, abs=5e-7)


@pytest.mark.parametrize(("label", "floor"), [(75, 1.877084), (0, 1.308190), (149, 1.308190)])
def test_nothing_costs_less_than_the_entropy_of_a_row(label, floor):
    rows = information_gain(150, 0.2, DOUBLE)
    assert at(rows[label].clamp(min=1e-300).log(), label) == pytest.approx(floor, abs=5e-7)
    certain = torch.full((150,), -20.0, dtype=torch.float64)
    certain[label] = 20.0
    assert at(certain, label) > floor


@pytest.mark.parametrize(("bins", "published"), [(150, 7.640212), (100, 6.367159)])
def test_two_pixels_as_the_published_code_has_them(bins, published):
    places = torch.arange(bins, dtype=torch.float64)
    logits = torch.stack([0.05 * places, -0.03 * places], 1)[None, :, None]
    both = torch.ones(1, 1, 2, dtype=torch.bool)
    loss = weighted_cross_entropy(logits, torch.tensor([[[10, 60]]]), both, 0.2)
    assert loss.item() == pytest.approx(published, abs=5e-7)


def test_every_valid_pixel_of_the_batch_weighs_the_same():
    places = torch.arange(20, dtype=torch.float64)
    logits = torch.stack([0.3 * places, -0.1 * places]).reshape(2, 20, 1, 1).expand(2, 20, 1, 4)
    labels = torch.full((2, 1, 4), 7)
    valid = torch.tensor([[[True, True, True, True]], [[False, True, False, False]]])
    first, second = at(0.3 * places, 7), at(-0.1 * places, 7)
    loss = weighted_cross_entropy(logits, labels, valid, 0.2)
    assert loss.item() == pytest.approx((4 * first + second) / 5)


@pytest.mark.parametrize("rubbish", [torch.nan, torch.inf, -torch.inf])
def test_rubbish_in_invalid_pixels_touches_neither_value_nor_gradient(rubbish):
    generator = torch.Generator().manual_seed(3)
    clean = torch.randn(2, 9, 3, 4, generator=generator, dtype=torch.float64)
    labels = torch.randint(9, (2, 3, 4), generator=generator)
    valid = torch.rand(2, 3, 4, generator=generator) < 0.6
    spoilt = clean.where(valid[:, None], rubbish).requires_grad_(True)
    clean.requires_grad_(True)
    losses = [weighted_cross_entropy(x, labels, valid, 0.2) for x in (clean, spoilt)]
    assert_close(*losses)
    wanted, got = (
        torch.autograd.grad(x, y)[0] for x, y in zip(losses, (clean, spoilt), strict=True)
    )
    assert_close(got, wanted)
    assert not got.movedim(1, -1)[~valid].any()


def test_gradients_are_those_of_finite_differences():
    generator = torch.Generator().manual_seed(4)
    logits = torch.randn(2, 6, 2, 3, generator=generator, dtype=torch.float64)
    labels = torch.randint(6, (2, 2, 3), generator=generator)
    valid = torch.rand(2, 2, 3, generator=generator) < 0.7
    assert torch.autograd.gradcheck(
        lambda x: weighted_cross_entropy(x, labels, valid, 0.2), logits.requires_grad_(True)
    )
