from math import log

import pytest
import torch

from flexdepth.losses.sky import sky_cross_entropy


def test_a_certain_pixel_a_doubtful_pixel_and_an_unknown_one_worked_by_hand():
    logit = torch.tensor([[[log(3), log(3), 0.0, 50.0]]])
    sky = torch.tensor([[[True, False, False, False]]])
    valid = torch.tensor([[[False, True, True, False]]])
    # Probabilities of what is there: 3/4, 1/4, 1/2; the last pixel is neither sky nor valid.
    expected = (log(4 / 3) + log(4) + log(2)) / 3
    assert sky_cross_entropy(logit, sky, valid).item() == pytest.approx(expected)


def test_a_confident_mistake_costs_its_logit_and_not_infinity():
    logit, yes = torch.full((1, 1, 1), 1e4), torch.ones(1, 1, 1, dtype=torch.bool)
    assert sky_cross_entropy(logit, ~yes, yes).item() == 1e4
    assert sky_cross_entropy(-logit, yes, ~yes).item() == 1e4


def test_gradients_are_those_of_finite_differences():
    generator = torch.Generator().manual_seed(5)
    logit = torch.randn(2, 3, 4, generator=generator, dtype=torch.float64)
    sky, valid = torch.rand(2, 2, 3, 4, generator=generator) < 0.5
    assert torch.autograd.gradcheck(
        lambda x: sky_cross_entropy(x, sky, valid), logit.requires_grad_(requires_grad=True)
    )
