"""A spread is right when 68 % of the errors are within it, and 95 % within twice as much."""

import math

import pytest
import torch
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.losses.spread import SpreadQuantiles, pinball, spread_quantiles
from flexdepth.sample import Frame, Prediction, Sample, Truth


def errors_of(count: int) -> torch.Tensor:
    """Return a map whose log errors are normal with a deviation of .2, median 0, by quantiles."""
    levels = (torch.arange(count, dtype=torch.float64) + 0.5) / count
    return (0.2 * math.sqrt(2) * torch.erfinv(2 * levels - 1)).exp()[None, None]


def loss(spread: float, depth: torch.Tensor) -> float:
    flat = torch.ones_like(depth)
    return spread_quantiles(depth, spread * flat, flat, flat.bool()).item()


def test_pinball_by_hand():
    value, quantile = torch.tensor([3.0, 1.0]), torch.tensor([2.0, 2.0])
    assert_close(pinball(value, quantile, 0.8), torch.tensor([0.8, 0.2]))


def test_one_pixel_that_is_off_by_hand():
    # Of five pixels one is e times too deep; the median of the differences is 0.
    depth = torch.tensor([1.0, 1.0, 1.0, 1.0, math.e], dtype=torch.float64)[None, None]
    tiny, far = math.log(1e-4) - math.log(0.5), 0 - math.log(0.5)
    one = 4 * (0.6826894921 - 1) * tiny + 0.6826894921 * far
    two = 4 * (0.9544997361 - 1) * (math.log(1e-4) - 0) + 0.0
    assert loss(0.5, depth) == pytest.approx((one + two) / 5, abs=1e-9)


def test_the_deviation_of_normal_errors_is_the_best_spread():
    depth = errors_of(2001)
    best = loss(0.2, depth)
    assert all(loss(0.2 * factor, depth) > best for factor in (0.7, 0.9, 1.1, 1.4))


def test_a_factor_of_the_whole_map_is_no_error_of_its_pixels():
    depth = errors_of(501)
    assert loss(0.1, 7.0 * depth) == pytest.approx(loss(0.1, depth), abs=1e-9)


@pytest.mark.parametrize("rubbish", [0.0, -1.0, torch.nan, torch.inf])
def test_invalid_pixels_touch_neither_value_nor_gradient(rubbish):
    depth, valid = errors_of(9).expand(1, 2, 9).clone(), torch.ones(1, 2, 9, dtype=torch.bool)
    truth, spread = torch.ones_like(depth), torch.full_like(depth, 0.3)
    valid[:, 1] = False
    spread.requires_grad_()
    clean = spread_quantiles(depth, spread, truth, valid)
    (wanted,) = torch.autograd.grad(clean.sum(), spread)
    depth[:, 1] = truth[:, 1] = rubbish
    dirty = spread_quantiles(depth, spread, truth, valid)
    (found,) = torch.autograd.grad(dirty.sum(), spread)
    assert_close(dirty, clean)
    assert_close(found, wanted)
    assert not found[:, 1].any()


def test_an_image_without_valid_pixels_has_loss_zero():
    flat = torch.ones(2, 3, 4)
    nothing = torch.zeros(2, 3, 4, dtype=torch.bool)
    assert_close(spread_quantiles(flat, flat, flat, nothing), torch.zeros(2))


def test_a_batch_is_its_images_one_by_one():
    depth = torch.stack([errors_of(6)[0], 3 * errors_of(6)[0].flip(-1)])
    flat, spread = torch.ones_like(depth), torch.tensor([0.1, 0.4])[:, None, None] * depth
    together = spread_quantiles(depth, spread, flat, flat.bool())
    single = [
        spread_quantiles(*(x[k : k + 1] for x in (depth, spread, flat, flat.bool())))
        for k in range(2)
    ]
    assert_close(together, torch.cat(single))


def test_the_loss_moves_the_spread_and_never_the_depth():
    depth = errors_of(9).requires_grad_()
    flat = torch.ones_like(depth)
    spread = torch.full_like(depth, 0.3).requires_grad_()
    spread_quantiles(depth, spread, flat, flat.bool()).sum().backward()
    assert depth.grad is None
    assert spread.grad is not None
    assert spread.grad.any()


def test_the_gradient_is_that_of_the_value():
    flat = torch.ones(1, 1, 9, dtype=torch.float64)
    spread = torch.linspace(0.05, 0.9, 9, dtype=torch.float64)[None, None].requires_grad_()
    assert torch.autograd.gradcheck(
        lambda s: spread_quantiles(errors_of(9), s, flat, flat.bool()), spread
    )


def test_a_network_without_spread_is_told():
    flat = torch.ones(1, 2, 2)
    camera = Camera(torch.ones(1, 2), torch.ones(1, 2))
    sample = Sample(
        ("one",),
        Frame(torch.zeros(1, 3, 2, 2), camera),
        Truth(flat, flat.bool(), ~flat.bool()),
    )
    with pytest.raises(ValueError, match="no such head"):
        SpreadQuantiles()(Prediction(flat, None), sample)
