"""What is true of every loss."""

from dataclasses import replace
from pkgutil import iter_modules
from typing import get_args

import pytest
import torch
from torch import Tensor
from torch.testing import assert_close

from flexdepth import losses
from flexdepth.geometry.camera import Camera
from flexdepth.losses import GradientMatching, Loss, Silog, Sky
from flexdepth.sample import Frame, Prediction, Sample, Truth

every_loss = pytest.mark.parametrize("loss", [kind() for kind in get_args(Loss)], ids=repr)


def batch() -> tuple[Tensor, Tensor, Sample]:
    """Return a predicted depth, a sky's logit and a sample of three images with holes."""
    generator = torch.Generator().manual_seed(7)
    depth, truth = 0.5 + torch.rand(2, 3, 16, 20, generator=generator, dtype=torch.float64)
    logit = torch.randn(3, 16, 20, generator=generator, dtype=torch.float64)
    chance = torch.rand(3, 16, 20, generator=generator)
    focal = torch.tensor([[20.0, 20.0], [15.0, 15.0], [30.0, 30.0]], dtype=torch.float64)
    frame = Frame(torch.zeros(3, 3, 16, 20), Camera(focal, focal / 2))
    sample = Sample(("a", "b", "c"), frame, Truth(truth, chance < 0.6, chance > 0.9))
    return depth, logit, sample


def value(loss: Loss, depth: Tensor, logit: Tensor, sample: Sample) -> Tensor:
    return loss(Prediction(depth, 0.8, logit), sample)


@every_loss
@pytest.mark.parametrize("rubbish", [0.0, -1.0, torch.nan, torch.inf])
def test_unknown_pixels_touch_neither_value_nor_gradient(loss, rubbish):
    depth, logit, sample = batch()
    truth = sample.truth
    unknown = ~(truth.valid | truth.sky)
    spoilt = [x.masked_fill(unknown, rubbish).requires_grad_(True) for x in (depth, logit)]
    dirty = replace(sample, truth=replace(truth, depth=truth.depth.where(truth.valid, rubbish)))
    clean = [x.clone().requires_grad_(True) for x in (depth, logit)]
    expected, got = value(loss, *clean, sample), value(loss, *spoilt, dirty)
    assert_close(got, expected)
    gradients = torch.autograd.grad(got.sum(), spoilt, allow_unused=True)
    wanted = torch.autograd.grad(expected.sum(), clean, allow_unused=True)
    for gradient, right in zip(gradients, wanted, strict=True):
        assert_close(gradient, right)
        assert gradient is None or not gradient[unknown].any()


@every_loss
def test_an_image_with_nothing_known_has_loss_zero_and_gradient_zero(loss):
    depth, logit, sample = batch()
    nothing = torch.zeros(3, 16, 20, dtype=torch.bool)
    sample = replace(sample, truth=Truth(torch.full_like(depth, torch.nan), nothing, nothing))
    inputs = [x.requires_grad_(True) for x in (depth, logit)]
    result = value(loss, *inputs, sample)
    assert_close(result, torch.zeros(3, dtype=torch.float64))
    for gradient in torch.autograd.grad(result.sum(), inputs, allow_unused=True):
        assert gradient is None or not gradient.any()


@every_loss
def test_a_batch_costs_what_its_images_cost_alone(loss):
    depth, logit, sample = batch()
    truth, camera = sample.truth, sample.key.camera
    alone = []
    for i in range(3):
        own = slice(i, i + 1)
        frame = Frame(sample.key.image[own], Camera(camera.focal[own], camera.centre[own]))
        one = Sample("one", frame, Truth(truth.depth[own], truth.valid[own], truth.sky[own]))
        alone.append(value(loss, depth[own], logit[own], one))
    assert_close(value(loss, depth, logit, sample), torch.cat(alone))


@pytest.mark.parametrize("loss", [Silog(), GradientMatching()], ids=repr)
def test_the_truth_seen_through_its_camera_costs_nothing(loss):
    _, logit, sample = batch()
    focal = sample.key.focal_in_diagonals()
    canonical = sample.truth.depth * (0.8 / focal)[:, None, None]
    assert_close(value(loss, canonical, logit, sample), torch.zeros(3, dtype=torch.float64))
    if isinstance(loss, Silog):
        assert (value(loss, sample.truth.depth, logit, sample) > 1e-5).all()


@every_loss
def test_a_loss_without_truth_says_what_it_needs(loss):
    depth, logit, sample = batch()
    with pytest.raises(ValueError, match="needs measured depth"):
        value(loss, depth, logit, replace(sample, truth=None))


def test_the_sky_s_loss_needs_a_network_that_predicts_sky():
    depth, _, sample = batch()
    with pytest.raises(ValueError, match="predicts sky"):
        Sky()(Prediction(depth, 0.8), sample)


def test_every_file_has_its_setting_in_the_union():
    files = {module.name for module in iter_modules(losses.__path__)}
    assert files == {kind.__module__.rpartition(".")[2] for kind in get_args(Loss)}
