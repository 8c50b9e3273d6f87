from math import log

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.testing import assert_close

from flexdepth.losses.gradient_matching import gradient_matching


def scene(seed: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(seed)
    depth, truth = 0.5 + torch.rand(2, 2, 9, 11, generator=generator, dtype=torch.float64)
    return depth, truth, torch.rand(2, 9, 11, generator=generator) < 0.7


def test_a_step_of_two_between_two_columns_worked_by_hand():
    depth = torch.tensor([1.0, 1.0, 2.0, 2.0, 2.0]).expand(1, 3, 5)
    truth, valid = torch.ones(1, 3, 5), torch.ones(1, 3, 5, dtype=torch.bool)
    # Stride 1: one of four pairs across steps by ln 2. Stride 2: one of two. Stride 4: the only
    # one. Stride 8 has no pair, and nothing changes down.
    assert gradient_matching(depth, truth, valid, 1).item() == pytest.approx(log(2) / 4)
    assert gradient_matching(depth, truth, valid, 2).item() == pytest.approx(log(2) * 3 / 4)
    assert gradient_matching(depth, truth, valid, 4).item() == pytest.approx(log(2) * 7 / 4)
    turned = (x.transpose(-1, -2) for x in (depth, truth, valid))
    assert gradient_matching(*turned, 2).item() == pytest.approx(log(2) * 3 / 4)


def test_a_difference_counts_only_between_two_valid_pixels():
    depth = torch.tensor([[[1.0, 2.0, 8.0, 8.0]]])
    valid = torch.tensor([[[True, True, False, True]]])
    loss = gradient_matching(depth, torch.ones(1, 1, 4), valid, 1)
    assert loss.item() == pytest.approx(log(2))


@given(st.floats(0.01, 100), st.integers(1, 5))
def test_it_is_blind_to_scale(scale, scales):
    depth, truth, valid = scene(3)
    expected = gradient_matching(depth, truth, valid, scales)
    assert_close(gradient_matching(scale * depth, truth, valid, scales), expected)


def test_gradients_are_those_of_finite_differences():
    depth, truth, valid = scene(4)
    assert torch.autograd.gradcheck(
        lambda d: gradient_matching(d, truth, valid, 4), depth.requires_grad_(requires_grad=True)
    )
