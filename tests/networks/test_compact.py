from copy import deepcopy
from dataclasses import replace

import pytest
import torch
from torch import Tensor, nn
from torch.testing import assert_close
from torch.utils.flop_counter import FlopCounterMode

from flexdepth.geometry.camera import Camera
from flexdepth.losses import GradientMatching, Silog, Sky
from flexdepth.networks import Compact
from flexdepth.networks.attention import ChannelAttention
from flexdepth.sample import Frame, Sample, Truth


class DepthAndSky(nn.Module):
    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network = network

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor]:
        prediction = self.network(image)
        return prediction.depth, prediction.sky_logit


@pytest.fixture(scope="module")
def network() -> nn.Module:
    torch.manual_seed(0)
    return Compact().build().eval()


@pytest.mark.parametrize("size", [(32, 32), (64, 160), (96, 64)])
def test_depth_and_sky_have_the_image_s_size(network, size):
    prediction = network(torch.rand(2, 3, *size))
    assert prediction.depth.shape == (2, *size)
    assert prediction.sky_logit.shape == (2, *size)
    assert (prediction.depth > 0).all()


def test_each_merge_shows_where_it_looked(network):
    attention = network(torch.rand(2, 3, 64, 96)).attention
    assert [a.shape for a in attention] == [(2, 1, 64 // s, 96 // s) for s in (16, 8, 4, 2)]
    assert all((a >= 0).all() and (a <= 1 + 1e-6).all() for a in attention)


def test_merges_by_channel_attention_alone_show_nothing():
    network = replace(Compact(), coefficient=ChannelAttention(4)).build().eval()
    assert network(torch.rand(1, 3, 32, 32)).attention == ()


def test_it_fits_in_sixteen_megabytes(network):
    numbers = sum(x.numel() for x in (*network.parameters(), *network.buffers()))
    assert numbers <= 3_950_000


def test_it_costs_at_most_three_billion_multiplications_at_384_by_288(network):
    with FlopCounterMode(display=False) as counter, torch.no_grad():
        network(torch.rand(1, 3, 288, 384))
    assert counter.get_total_flops() / 2 <= 3.0e9


def test_an_image_is_judged_alone_whatever_else_is_in_the_batch(network):
    images = torch.rand(3, 3, 64, 64)
    assert_close(network(images).depth[1], network(images[1:2]).depth[0], atol=1e-4, rtol=1e-4)


def test_the_whole_image_bears_on_every_pixel_even_where_no_channel_attends(network):
    network = deepcopy(network)
    for level in network.levels:
        nn.init.zeros_(level.merge.weighting.channel.excite.weight)
    image = torch.rand(1, 3, 32, 2048, requires_grad=True)
    (gradient,) = torch.autograd.grad(network(image).depth[0, :, 0].sum(), image)
    assert gradient[..., -32:].abs().sum() > 0


def test_bfloat16_says_the_same_to_its_own_precision(network):
    image = torch.rand(1, 3, 64, 64)
    with torch.autocast("cpu", torch.bfloat16):
        rough = network(image).depth
    assert_close(rough.float().log(), network(image).depth.log(), atol=0.1, rtol=0)


def test_one_exported_program_serves_every_size(network):
    batch = torch.export.Dim("batch", min=1, max=64)
    rows, columns = (torch.export.Dim(name, min=2, max=128) for name in ("rows", "columns"))
    program = torch.export.export(
        DepthAndSky(network).eval(),
        (torch.rand(2, 3, 64, 96),),
        dynamic_shapes=({0: batch, 2: 32 * rows, 3: 32 * columns},),
    ).module()
    for shape in ((1, 3, 96, 64), (3, 3, 64, 160)):
        image = torch.rand(shape)
        prediction = network(image)
        depth, sky = program(image)
        assert_close(depth, prediction.depth)
        assert_close(sky, prediction.sky_logit)


def test_two_images_are_learnt_by_heart():
    torch.manual_seed(0)
    network = Compact().build().train()
    image = torch.rand(2, 3, 1, 1).expand(2, 3, 64, 64) * torch.linspace(0.2, 1, 64)[:, None]
    depth = torch.linspace(1, 9, 64)[:, None].expand(64, 64)
    sky = torch.zeros(2, 64, 64, dtype=torch.bool)
    sky[:, :16] = True
    truth = Truth(torch.stack([depth, 2 * depth]), ~sky, sky)
    camera = Camera(torch.full((2, 2), 60.0), torch.full((2, 2), 32.0))
    sample = Sample(("a", "b"), Frame(image, camera), truth)
    optimiser = torch.optim.AdamW(network.parameters(), 2e-3)
    history = []
    for _ in range(25):
        prediction = network(image)
        terms = (Silog()(prediction, sample), GradientMatching()(prediction, sample))
        loss = (sum(terms) + Sky()(prediction, sample)).mean()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        history.append(loss.item())
    assert history[-1] < 0.25 * history[0]
