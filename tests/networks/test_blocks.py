import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.networks.blocks import BatchNorm, DilatedResidual, start_as_xavier


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
