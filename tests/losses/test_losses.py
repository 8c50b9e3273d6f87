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
from flexdepth.geometry.depth import DepthBins
from flexdepth.losses import (
    BerHu,
    BinCentres,
    Focal,
    GradientMatching,
    Loss,
    Ordinal,
    Silog,
    Sky,
    SpreadQuantiles,
    Squared,
    VirtualNormal,
    WeightedCrossEntropy,
)
from flexdepth.losses.virtual_normal import Triangles
from flexdepth.sample import Frame, Prediction, Sample, Truth

BINS = DepthBins(6, 0.05, 60.0, unit=1.0)
# Images of 16 by 20 pixels have few triangles, and through 519 pixels these are needles.
NORMAL = VirtualNormal(focal=20.0, triangles=Triangles(share=2.0))
ALONE = [
    Silog(),
    GradientMatching(),
    Sky(),
    Squared(),
    Squared(mean="root"),
    Squared(unit="metres"),
    Ordinal(),
    BinCentres(),
    SpreadQuantiles(),
]
POOLED = [WeightedCrossEntropy(), NORMAL, BerHu()]

every_loss = pytest.mark.parametrize("loss", ALONE + POOLED, ids=repr)


def test_every_loss_is_tested_here():
    # A focal length has no pixels to be unknown in; its tests are in test_focal.py.
    assert {type(loss) for loss in ALONE + POOLED} | {Focal} == set(get_args(Loss))


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
    logits = torch.stack([logit * factor for factor in range(1, 7)], 1)
    centres = torch.linspace(0.3, 2.0, 5, dtype=depth.dtype).repeat(len(depth), 1)
    centres.requires_grad_(True)
    said = Prediction(
        *(depth, 0.8, logit), logits=logits, bins=BINS, beyond=-logits, centres=centres
    )
    if isinstance(loss, SpreadQuantiles):
        said = replace(said, bins=None, spread=depth)
    return loss(said, sample)


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
    assert (expected > 0).all()
    gradients = torch.autograd.grad(got.sum(), spoilt, allow_unused=True)
    wanted = torch.autograd.grad(expected.sum(), clean, allow_unused=True)
    for gradient, right in zip(gradients, wanted, strict=True):
        assert_close(gradient, right)
        assert gradient is None or not gradient[unknown].any()


@pytest.mark.parametrize("loss", [x for x in ALONE + POOLED if not isinstance(x, Sky)], ids=repr)
@pytest.mark.parametrize("rubbish", [0.0, -1.0, torch.nan, torch.inf])
def test_rubbish_that_is_called_valid_is_not(loss, rubbish):
    depth, logit, sample = batch()
    truth = sample.truth
    wrong = truth.valid & (truth.depth < 0.8)
    dirty = replace(truth, depth=truth.depth.masked_fill(wrong, rubbish))
    without = replace(truth, valid=truth.valid & ~wrong)
    inputs = [x.requires_grad_(True) for x in (depth, logit)]
    got, wanted = (value(loss, *inputs, replace(sample, truth=x)) for x in (dirty, without))
    assert_close(got, wanted)
    for gradient in torch.autograd.grad(got.sum(), inputs, allow_unused=True):
        assert gradient is None or gradient.isfinite().all()


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


@pytest.mark.parametrize("loss", POOLED, ids=repr)
def test_a_loss_of_the_whole_batch_is_given_to_each_image(loss):
    depth, logit, sample = batch()
    result = value(loss, depth, logit, sample)
    assert result.shape == (3,)
    assert (result == result[0]).all()
    backward = [x.flip(0) for x in (depth, logit)]
    turned = replace(sample, key=replace(sample.key, camera=flipped(sample.key.camera)))
    truth = sample.truth
    turned = replace(
        turned, truth=Truth(truth.depth.flip(0), truth.valid.flip(0), truth.sky.flip(0))
    )
    assert_close(value(loss, *backward, turned), result)


def flipped(camera: Camera) -> Camera:
    return Camera(camera.focal.flip(0), camera.centre.flip(0))


@pytest.mark.parametrize("loss", ALONE, ids=repr)
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


@pytest.mark.parametrize(
    "loss",
    [Silog(), GradientMatching(), Squared(), Squared(unit="metres"), NORMAL, BerHu()],
    ids=repr,
)
def test_the_truth_seen_through_its_camera_costs_nothing(loss):
    _, logit, sample = batch()
    focal = sample.key.focal_by_area()
    canonical = sample.truth.depth * (0.8 / focal)[:, None, None]
    assert_close(value(loss, canonical, logit, sample), torch.zeros(3, dtype=torch.float64))
    if isinstance(loss, Silog | Squared):
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


def test_the_cross_entropy_needs_a_network_that_tells_bins_apart():
    depth, _, sample = batch()
    with pytest.raises(ValueError, match="classifies depth into bins"):
        WeightedCrossEntropy()(Prediction(depth, None, bins=BINS), sample)


def test_ordinal_regression_needs_a_network_that_says_what_lies_beyond():
    depth, _, sample = batch()
    with pytest.raises(ValueError, match="lies beyond each bin"):
        Ordinal()(Prediction(depth, None, bins=BINS), sample)


def test_the_loss_of_bins_needs_a_network_that_chooses_them():
    depth, _, sample = batch()
    with pytest.raises(ValueError, match="chooses its bins"):
        BinCentres()(Prediction(depth, None), sample)


TWO_FRAMES = {"epipolar", "flow", "gauge", "motion_boundaries", "perspective", "synchrony"}
"""Terms of chapter 5: they take a motion for each pixel, which no network here gives."""


def test_every_file_has_its_setting_in_the_union():
    files = {module.name for module in iter_modules(losses.__path__)} - TWO_FRAMES
    assert files == {kind.__module__.rpartition(".")[2] for kind in get_args(Loss)}
