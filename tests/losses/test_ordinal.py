from math import exp, log

import pytest
import torch
from torch.testing import assert_close

from flexdepth.losses.ordinal import ordinal

ONE = torch.ones(1, 1, 1, dtype=torch.bool)


def at(probabilities: list[float], label: int) -> float:
    odds = torch.tensor(probabilities, dtype=torch.float64).logit()[None, :, None, None]
    return ordinal(odds, torch.full((1, 1, 1), label), ONE).item()


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        (0, -log(0.1) - log(0.6) - log(0.8)),
        (1, -log(0.9) - log(0.6) - log(0.8)),
        (2, -log(0.9) - log(0.4) - log(0.8)),
        (3, -log(0.9) - log(0.4) - log(0.2)),
    ],
)
def test_three_thresholds_worked_by_hand(label, expected):
    # Beyond the bins with probability 0.9, 0.4 and 0.2; those before the label should be passed.
    assert at([0.9, 0.4, 0.2], label) == pytest.approx(expected)


def test_every_bin_of_error_costs_more():
    odds = torch.tensor([2.0, 2, 2, -2, -2, -2], dtype=torch.float64)[None, :, None, None]
    costs = [ordinal(odds, torch.full((1, 1, 1), label), ONE).item() for label in range(7)]
    assert costs[3] == min(costs)
    assert costs[:4] == sorted(costs[:4], reverse=True)
    assert costs[3:] == sorted(costs[3:])
    # From one bin to the next a threshold changes sides: log(1 + e²) − log(1 + e⁻²) = 2.
    assert costs[4] - costs[3] == pytest.approx(2.0)


def test_no_opinion_costs_the_logarithm_of_two_for_each_bin():
    odds = torch.zeros(1, 150, 2, 2)
    labels = torch.tensor([[[0, 149], [70, 3]]])
    everywhere = torch.ones(1, 2, 2, dtype=torch.bool)
    assert ordinal(odds, labels, everywhere).item() == pytest.approx(150 * log(2), rel=1e-6)


def test_wrong_beyond_all_doubt_is_finite():
    odds = torch.full((1, 3, 1, 1), 1e4)
    assert ordinal(odds, torch.zeros(1, 1, 1, dtype=torch.long), ONE).item() == pytest.approx(3e4)


def test_certainty_costs_nothing():
    odds = torch.tensor([40.0, 40.0, -40.0])[None, :, None, None]
    assert ordinal(odds, torch.full((1, 1, 1), 2), ONE).item() < 4 * exp(-40)


def test_gradients_are_those_of_finite_differences():
    generator = torch.Generator().manual_seed(3)
    odds = torch.randn(2, 5, 2, 3, generator=generator, dtype=torch.float64)
    labels = torch.randint(6, (2, 2, 3), generator=generator)
    valid = torch.rand(2, 2, 3, generator=generator) < 0.7
    assert torch.autograd.gradcheck(lambda x: ordinal(x, labels, valid), odds.requires_grad_(True))


@pytest.mark.parametrize("rubbish", [torch.nan, torch.inf, -torch.inf])
def test_rubbish_in_invalid_pixels_touches_neither_value_nor_gradient(rubbish):
    generator = torch.Generator().manual_seed(4)
    clean = torch.randn(2, 5, 3, 4, generator=generator, dtype=torch.float64)
    labels = torch.randint(5, (2, 3, 4), generator=generator)
    valid = torch.rand(2, 3, 4, generator=generator) < 0.6
    spoilt = clean.where(valid[:, None], rubbish).requires_grad_(True)
    clean.requires_grad_(True)
    losses = [ordinal(x, labels, valid).sum() for x in (clean, spoilt)]
    assert_close(*losses)
    wanted, got = (
        torch.autograd.grad(x, y)[0] for x, y in zip(losses, (clean, spoilt), strict=True)
    )
    assert_close(got, wanted)
    assert not got.movedim(1, -1)[~valid].any()
