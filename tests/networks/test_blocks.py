import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.networks.blocks import (
    BatchNorm,
    DilatedResidual,
    Pyramid,
    resized,
    start_as_xavier,
)
from flexdepth.runtime.errors import InputError


@pytest.mark.parametrize(("inputs", "width", "expected"), [(2048, 512, 5_768_704), (8, 4, 332)])
def test_a_dilated_residual_block_has_the_published_number_of_parameters(inputs, width, expected):
    block = DilatedResidual().build(inputs, width)
    assert sum(p.numel() for p in block.parameters()) == expected


@pytest.mark.parametrize("dilation", [1, 2, 3])
def test_a_pixel_sees_two_dilated_steps_around_it_and_nothing_between(dilation):
    block = DilatedResidual(dilation=dilation).build(3, 4).eval()
    image = torch.rand(1, 3, 15, 15, requires_grad=True)
    with torch.no_grad():
        for weight in block.parameters():
            weight.abs_()
    (gradient,) = torch.autograd.grad(block(image)[0, :, 7, 7].sum(), image)
    seen = {divmod(int(i), 15) for i in gradient.sum((0, 1)).flatten().nonzero()}
    steps = [7 + k * dilation for k in range(-2, 3)]
    assert seen == {(row, column) for row in steps for column in steps}


def test_without_its_second_convolution_the_block_is_a_projection():
    block = DilatedResidual().build(3, 4)
    nn.init.zeros_(block.refine[-1].weight)
    features = torch.randn(2, 3, 5, 6)
    assert_close(block(features), block.project(features).relu())


def test_the_normalisation_is_built_as_it_is_set():
    norm = BatchNorm(momentum=0.5, eps=1e-3).build(7)
    assert (norm.momentum, norm.eps, norm.num_features) == (0.5, 1e-3, 7)


def test_xavier_gives_a_convolution_the_variance_of_its_fans():
    conv = nn.Conv2d(64, 128, 3)
    start_as_xavier(conv)
    # Variance 2 / (fan in + fan out) = 2 / (9 * 64 + 9 * 128); 73,728 draws: 0.5 % a deviation.
    assert conv.weight.var().item() == pytest.approx(2 / 1728, rel=0.03)
    assert not conv.bias.any()


def test_the_published_pyramid_has_the_published_number_of_parameters():
    with torch.device("meta"):
        pyramid = Pyramid().build(2048)
    assert sum(p.numel() for p in pyramid.parameters()) == 30_413_824
    assert pyramid.width == 2560


def test_the_pyramid_is_linear_in_evaluation_for_it_has_no_activation():
    pyramid = Pyramid(width=4).build(3).eval()
    with torch.no_grad():
        for part in pyramid.modules():
            if isinstance(part, nn.BatchNorm2d):
                part.bias.zero_()
    image = torch.randn(1, 3, 7, 9)
    assert_close(pyramid(-2 * image), -2 * pyramid(image), atol=1e-5, rtol=1e-4)


def test_the_branches_of_the_pyramid_see_a_point_three_scales_and_the_whole():
    pyramid = Pyramid(width=4).build(3).eval()
    image = torch.rand(1, 3, 17, 17, requires_grad=True)
    seen = []
    for branch in pyramid(image)[0, :, 8, 8].split(4):
        (gradient,) = torch.autograd.grad(branch.sum(), image, retain_graph=True)
        seen.append({divmod(int(i), 17) for i in gradient.abs().sum((0, 1)).flatten().nonzero()})
    expected = [{8}, *({8 - reach, 8, 8 + reach} for reach in (2, 4, 6)), set(range(17))]
    assert seen == [{(row, column) for row in places for column in places} for places in expected]


def test_every_branch_of_the_pyramid_is_normalised_with_momentum_one_half():
    momenta = [m.momentum for m in Pyramid().build(2).modules() if isinstance(m, nn.BatchNorm2d)]
    assert momenta == [0.5] * 5


def test_a_pyramid_cannot_learn_from_a_single_image():
    with pytest.raises(InputError, match="at least 2 images"):
        Pyramid(width=4).build(3)(torch.rand(1, 3, 8, 8))


def test_resizing_leaves_the_corners_where_they_are():
    ramp = torch.linspace(0, 4, 5).expand(1, 1, 3, 5)
    assert_close(resized(ramp, 3, 9)[0, 0, 0], torch.linspace(0, 4, 9))
    assert_close(resized(ramp, 3, 5), ramp)
