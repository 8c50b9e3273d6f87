from dataclasses import replace

import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.geometry.depth import KITTI_BINS, NYU_BINS
from flexdepth.networks.aga import AGA, BASE, RELEASED_TOP, AGANetwork
from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.blocks import Pyramid
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.heads import BinnedDepth
from flexdepth.networks.merge import (
    VARIANTS,
    Coefficient,
    SpatialAttention,
    SpatialPlusChannelAttention,
)

SMALL = AGA(
    encoder=Encoder("resnet18", 16),
    laterals=(16, 12, 8, 8),
    top=16,
    widths=(12, 8, 8, 8, 8),
    pyramid=Pyramid(width=8),
    head=BinnedDepth(replace(NYU_BINS, count=20)),
).merged_by(SpatialPlusChannelAttention(ratio=4, channel=ChannelAttention(8)))
"""Its merges see 16 + 16, 12 + 12, 8 + 8 and 8 + 8 channels."""


def for_narrow_maps(name: str) -> Coefficient:
    variant = VARIANTS[name]
    if isinstance(variant, ChannelAttention):
        return ChannelAttention(8)
    few = replace(variant, ratio=4)
    return few if isinstance(few, SpatialAttention) else replace(few, channel=ChannelAttention(8))


def without_memory(settings: AGA) -> AGANetwork:
    with torch.device("meta"):
        return settings.build().eval()


def parameters(module: nn.Module) -> int:
    return sum(p.numel() for p in module.parameters())


@pytest.fixture(scope="module")
def base() -> AGANetwork:
    return without_memory(BASE)


@pytest.fixture(scope="module")
def small() -> AGANetwork:
    torch.manual_seed(0)
    return SMALL.build().eval()


@pytest.mark.parametrize(
    ("encoder", "bins", "variant", "expected"),
    [
        ("resnext101_32x4d", NYU_BINS, "S1", 90_436_054),
        ("resnext101_32x4d", KITTI_BINS, "S1", 90_320_804),
        ("resnext101_32x4d", NYU_BINS, "S2", 90_464_726),
        ("resnext101_32x4d", NYU_BINS, "S3", 90_292_694),
        ("resnext101_32x4d", NYU_BINS, "S4", 90_464_726),
        ("resnext101_32x4d", NYU_BINS, "S5", 90_493_398),
        ("resnext101_32x4d", NYU_BINS, "S6", 90_464_726),
        ("resnext101_32x4d", NYU_BINS, "S7", 90_464_726),
        ("resnext101_32x4d", KITTI_BINS, "S7", 90_349_476),
        ("resnext101_32x4d", NYU_BINS, "DS7", 90_464_726),
        ("resnext101_32x4d", NYU_BINS, "NS7", 90_464_726),
        ("resnext50_32x4d", NYU_BINS, "S1", 71_287_254),
        ("resnext50_32x4d", KITTI_BINS, "S1", 71_172_004),
    ],
)
def test_the_number_of_parameters_is_the_published_one(encoder, bins, variant, expected):
    settings = AGA(encoder=Encoder(encoder, 16), head=BinnedDepth(bins))
    assert parameters(without_memory(settings.merged_by(VARIANTS[variant]))) == expected


def test_every_part_of_the_base_has_the_published_number_of_parameters(base):
    trunk = base.encoder.trunk
    assert parameters(trunk.conv1) + parameters(trunk.bn1) == 9_536
    stages = (trunk.layer1, trunk.layer2, trunk.layer3, trunk.layer4)
    assert [parameters(s) for s in stages] == [205_824, 1_197_056, 26_171_392, 14_544_896]
    assert parameters(base.encoder) == 42_128_704
    laterals = [parameters(lateral) for lateral in base.laterals]
    assert laterals == [5_768_704, 1_442_560, 1_311_488, 1_245_952]
    assert parameters(base.pyramid) == 30_413_824
    assert parameters(base.top) == 1_311_744
    assert [parameters(s) for s in base.stages] == [1_409_792, *([1_270_528] * 3)]
    assert parameters(base.last) == 1_245_952
    assert parameters(base.head) == 345_750


@pytest.mark.parametrize(
    ("size", "quarter", "eighth", "sixteenth"),
    [
        ((384, 384), (96, 96), (48, 48), (24, 24)),
        ((385, 385), (97, 97), (49, 49), (25, 25)),
        ((385, 513), (97, 129), (49, 65), (25, 33)),
        ((480, 640), (120, 160), (60, 80), (30, 40)),
    ],
)
def test_every_map_has_the_published_shape(base, size, quarter, eighth, sixteenth):
    shapes = {}

    def remember(name):
        return lambda _module, _inputs, output: shapes.update({name: output})

    named = {"pyramid": base.pyramid, "top": base.top, "last": base.last}
    named |= {f"lateral {n}": module for n, module in enumerate(base.laterals)}
    named |= {f"stage {n}": module.block for n, module in enumerate(base.stages)}
    hooks = [module.register_forward_hook(remember(name)) for name, module in named.items()]
    image = torch.empty(1, 3, *size, device="meta")
    prediction = base(image)
    encoded = base.encoder(image)
    for hook in hooks:
        hook.remove()
    half = tuple((side + 1) // 2 for side in size)
    assert [tuple(x.shape[1:]) for x in encoded] == [
        (256, *quarter),
        (512, *eighth),
        (1024, *sixteenth),
        (2048, *sixteenth),
    ]
    assert {name: tuple(x.shape[1:]) for name, x in shapes.items()} == {
        "pyramid": (2560, *sixteenth),
        "top": (512, *sixteenth),
        "lateral 0": (512, *sixteenth),
        "lateral 1": (256, *sixteenth),
        "lateral 2": (256, *eighth),
        "lateral 3": (256, *quarter),
        "stage 0": (256, *sixteenth),
        "stage 1": (256, *sixteenth),
        "stage 2": (256, *eighth),
        "stage 3": (256, *quarter),
        "last": (256, *half),
    }
    assert prediction.logits.shape == (1, 150, *size)
    assert prediction.depth.shape == (1, *size)


def test_all_three_blocks_of_the_last_stage_dilate_by_two_and_none_before(base):
    trunk = base.encoder.trunk
    assert [block.conv2.dilation for block in trunk.layer4] == [(2, 2)] * 3
    assert [block.conv2.padding for block in trunk.layer4] == [(2, 2)] * 3
    assert [block.conv2.stride for block in trunk.layer4] == [(1, 1)] * 3
    before = (*trunk.layer1, *trunk.layer2, *trunk.layer3)
    assert {block.conv2.dilation for block in before} == {(1, 1)}


def test_the_decoder_s_normalisations_have_momentum_one_half_and_the_encoder_s_a_tenth(base):
    def settings(module):
        norms = [m for m in module.modules() if isinstance(m, nn.BatchNorm2d)]
        return {(norm.momentum, norm.eps) for norm in norms}

    assert settings(base.encoder) == {(0.1, 1e-5)}
    for part in (base.laterals, base.pyramid, base.top, base.stages, base.last):
        assert settings(part) == {(0.5, 1e-5)}
    released = without_memory(replace(BASE, top_norm=RELEASED_TOP))
    assert settings(released.top) == {(0.1, 0.5)}


def test_the_decoder_starts_as_xavier_draws_it(small):
    convolutions = [
        conv
        for part in (small.laterals, small.pyramid, small.top, small.stages, small.last, small.head)
        for conv in part.modules()
        if isinstance(conv, nn.Conv2d) and conv.weight.numel() > 4000
    ]
    assert len(convolutions) >= 5
    for conv in convolutions:
        fans = sum(conv.weight.shape[:2]) * conv.weight[0, 0].numel()
        assert conv.weight.var().item() == pytest.approx(2 / fans, rel=0.1)


@pytest.mark.parametrize("size", [(64, 64), (65, 97), (33, 50), (16, 16), (5, 7)])
def test_any_size_goes_in_and_comes_out(small, size):
    prediction = small(torch.rand(2, 3, *size))
    assert prediction.depth.shape == (2, *size)
    assert prediction.logits.shape == (2, 20, *size)
    assert ((prediction.depth > 0.01) & (prediction.depth < 1.7)).all()


def test_depth_is_what_the_bins_make_of_the_logits(small):
    prediction = small(torch.rand(1, 3, 32, 32))
    assert prediction.bins == SMALL.head.bins
    assert_close(prediction.depth, prediction.bins.depth(prediction.logits))
    assert prediction.canonical_focal is None


def test_the_four_merges_show_where_they_looked_the_last_at_a_quarter_of_the_image(small):
    attention = small(torch.rand(2, 3, 64, 96)).attention
    assert [tuple(a.shape) for a in attention] == [(2, 1, 64 // s, 96 // s) for s in (16, 16, 8, 4)]
    assert all((a >= 0).all() and (a <= 1 + 1e-6).all() for a in attention)


def test_the_base_shows_nothing():
    small_base = SMALL.merged_by(ChannelAttention(8)).build().eval()
    assert small_base(torch.rand(1, 3, 32, 32)).attention == ()


@pytest.mark.parametrize("name", VARIANTS)
def test_every_variant_learns_in_all_its_parameters(name):
    network = SMALL.merged_by(for_narrow_maps(name)).build().train()
    prediction = network(torch.rand(2, 3, 32, 48))
    prediction.depth.log().square().mean().backward()
    idle = [
        n for n, p in network.named_parameters() if p.grad is None or not p.grad.isfinite().all()
    ]
    assert idle == []


def test_looking_everywhere_can_be_left_to_the_coarse_merges():
    everywhere = for_narrow_maps("NS7")
    mixed = replace(SMALL, coefficients=(everywhere,) * 3 + SMALL.coefficients[3:])
    network = mixed.build().eval()
    assert [type(s.merge.weighting).__name__ for s in network.stages] == [
        *["NonLocalPlusChannelWeighting"] * 3,
        "SpatialPlusChannelWeighting",
    ]
    assert network(torch.rand(1, 3, 32, 32)).depth.isfinite().all()


def test_decoder_and_encoder_may_have_any_widths():
    uneven = replace(SMALL, laterals=(24, 8, 16, 12), top=12, widths=(20, 12, 8, 16, 8))
    network = uneven.build().eval()
    assert [s.merge.adapt.weight.shape[:2] for s in network.stages] == [
        (24, 12),
        (8, 20),
        (16, 12),
        (12, 8),
    ]
    assert network(torch.rand(1, 3, 33, 40)).depth.shape == (1, 33, 40)


@pytest.mark.parametrize(
    ("encoder", "stride"),
    [
        ("mobilenetv3_small_100", 16),
        ("tf_efficientnet_lite0", 16),
        ("convnext_atto", 16),
        ("regnety_002", 16),
        ("densenet121", 32),
        ("pvt_v2_b0", 32),
        ("swin_tiny_patch4_window7_224", 32),
        ("vit_tiny_patch16_224", 32),
        ("vgg11", 32),
    ],
)
def test_any_encoder_of_timm_takes_the_place_of_the_published_one(encoder, stride):
    network = without_memory(AGA(encoder=Encoder(encoder, stride)))
    prediction = network(torch.empty(1, 3, 192, 256, device="meta"))
    assert prediction.depth.shape == (1, 192, 256)
    assert len(prediction.attention) == 4


def test_one_exported_program_serves_every_size(small):
    rows, columns = (torch.export.Dim(name, min=33, max=512) for name in ("rows", "columns"))

    class Depth(nn.Module):
        def __init__(self):
            super().__init__()
            self.network = small

        def forward(self, image):
            return self.network(image).depth

    program = torch.export.export(
        Depth().eval(), (torch.rand(2, 3, 64, 96),), dynamic_shapes=({2: rows, 3: columns},)
    ).module()
    for size in ((64, 64), (65, 97)):
        image = torch.rand(2, 3, *size)
        assert_close(program(image), small(image).depth)


def test_two_images_are_learnt_by_heart():
    torch.manual_seed(0)
    network = SMALL.build().train()
    image = torch.rand(2, 3, 1, 1).expand(2, 3, 32, 32) * torch.linspace(0.2, 1, 32)[:, None]
    depth = torch.linspace(0.1, 1.2, 32)[:, None].expand(32, 32)
    labels, _ = SMALL.head.bins.labels(torch.stack([depth, 1.3 - depth]))
    optimiser = torch.optim.AdamW(network.parameters(), 5e-3)
    history = []
    for _ in range(20):
        loss = nn.functional.cross_entropy(network(image).logits, labels)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        history.append(loss.item())
    assert history[-1] < 0.6 * history[0]
