from math import log

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.testing import assert_close

from flexdepth.losses.silog import silog

EVERYWHERE = torch.ones(1, 1, 2, dtype=torch.bool)


def test_one_pixel_twice_too_far_and_one_right_worked_by_hand():
    depth, truth = torch.tensor([[[2.0, 5.0]]]), torch.tensor([[[1.0, 5.0]]])
    # e = (ln 2, 0): mean e² = ln²2 / 2, mean(e)² = ln²2 / 4.
    for focus in (0.0, 0.5, 0.85, 1.0):
        expected = log(2) ** 2 * (0.5 - focus * 0.25)
        assert silog(depth, truth, EVERYWHERE, focus).item() == pytest.approx(expected)


@given(st.floats(0.01, 100))
def test_at_full_variance_focus_it_is_blind_to_scale(scale):
    generator = torch.Generator().manual_seed(1)
    depth, truth = 0.5 + torch.rand(2, 2, 4, 5, generator=generator, dtype=torch.float64)
    valid = torch.rand(2, 4, 5, generator=generator) < 0.7
    assert_close(silog(scale * depth, truth, valid, 1.0), silog(depth, truth, valid, 1.0))


def test_gradients_are_those_of_finite_differences():
    generator = torch.Generator().manual_seed(2)
    depth, truth = 0.5 + torch.rand(2, 2, 3, 4, generator=generator, dtype=torch.float64)
    valid = torch.rand(2, 3, 4, generator=generator) < 0.7
    assert torch.autograd.gradcheck(
        lambda d: silog(d, truth, valid, 0.85), depth.requires_grad_(requires_grad=True)
    )
