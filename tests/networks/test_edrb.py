from dataclasses import replace

import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.geometry.depth import KITTI_BINS, NYU_BINS
from flexdepth.networks.adaptive import AdaptiveBins
from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.edrb import EDRB, EDRBMaps, EDRBNetwork, Rows, standardised
from flexdepth.networks.extended import Activations, GroupedBranch
from flexdepth.networks.guidance import PlanarGuidance
from flexdepth.networks.heads import BinnedDepth, OrdinalDepth
from flexdepth.networks.merge import SpatialPlusChannelAttention
from flexdepth.runtime.errors import InputError

NARROW = Rows(
    widths=(8, 16, 16),
    encoder_repeats=1,
    coefficient=SpatialPlusChannelAttention(ratio=4, channel=ChannelAttention(8)),
)
FEW = replace(NYU_BINS, count=20)
SMALL = EDRB(rows=NARROW, head=BinnedDepth(FEW))
HEADS = [
    BinnedDepth(FEW),
    OrdinalDepth(FEW),
    AdaptiveBins(count=20, width=16, layers=1),
    PlanarGuidance(width=8),
]


def without_memory(settings: EDRB | EDRBMaps) -> nn.Module:
    with torch.device("meta"):
        return settings.build().eval()


def parameters(module: nn.Module) -> int:
    return sum(p.numel() for p in module.parameters())


@pytest.fixture(scope="module")
def small() -> EDRBNetwork:
    torch.manual_seed(0)
    return SMALL.build().eval()


@pytest.mark.parametrize(
    ("rows", "expected"), [(4, 99_958_934), (5, 133_638_806), (6, 167_318_678)]
)
def test_the_number_of_parameters_is_that_of_the_description(rows, expected):
    settings = EDRB(rows=Rows(widths=(256, *[512] * (rows - 1))))
    assert parameters(without_memory(settings)) == expected


@pytest.mark.parametrize(
    ("inputs", "outputs", "expected"),
    [(3, 1, 133_295_361), (6, 2, 133_298_434), (6, 6, 133_307_654)],
)
def test_depth_flow_and_motion_have_the_parameters_of_the_description(inputs, outputs, expected):
    assert parameters(without_memory(EDRBMaps(inputs, outputs))) == expected


def test_every_part_has_the_parameters_of_the_description():
    rows = without_memory(EDRB()).rows
    assert [parameters(row) for row in rows.encoder] == [5_902_848, 23_731_712, *[23_862_784] * 3]
    assert [parameters(s.block) for s in rows.decoder] == [*[9_702_400] * 3, 2_426_368]
    assert [parameters(s.merge) for s in rows.decoder] == [*[114_688] * 3, 192_512]


def test_bins_of_kitti_and_of_nyu_differ_in_the_head_alone():
    nyu, kitti = (
        parameters(without_memory(EDRB(head=BinnedDepth(b)))) for b in (NYU_BINS, KITTI_BINS)
    )
    assert nyu - kitti == 50 * (9 * 256 + 1)


def test_the_rows_lie_at_a_half_to_a_thirty_second_of_the_image():
    network = without_memory(EDRB())
    shapes = []
    for row in network.rows.encoder:
        row.register_forward_hook(lambda _module, _inputs, out: shapes.append(tuple(out.shape[1:])))
    prediction = network(torch.empty(1, 3, 385, 513, device="meta"))
    assert shapes == [
        (256, 193, 257),
        (512, 97, 129),
        (512, 49, 65),
        (512, 25, 33),
        (512, 13, 17),
    ]
    assert [a.shape[1:] for a in prediction.attention] == [
        (1, 25, 33),
        (1, 49, 65),
        (1, 97, 129),
        (1, 193, 257),
    ]
    assert prediction.logits.shape == (1, 150, 385, 513)


def test_the_first_row_may_keep_the_size():
    rows = replace(NARROW, first_stride=1).build(3).eval()
    features, attention = rows(torch.rand(1, 3, 16, 24))
    assert features.shape == (1, 8, 16, 24)
    assert [a.shape[2:] for a in attention] == [(8, 12), (16, 24)]


@pytest.mark.parametrize("size", [(64, 64), (65, 97), (33, 50), (9, 6), (5, 7)])
@pytest.mark.parametrize("head", HEADS, ids=lambda head: type(head).__name__)
def test_any_size_goes_in_and_comes_out(head, size):
    network = replace(SMALL, head=head).build().eval()
    prediction = network(torch.rand(2, 3, *size))
    assert prediction.depth.shape == (2, *size)
    assert (prediction.depth > 0).all()
    assert prediction.depth.isfinite().all()


@pytest.mark.parametrize("head", HEADS, ids=lambda head: type(head).__name__)
def test_two_looks_at_an_image_give_one_depth_and_a_batch_what_its_images_give_alone(head):
    network = replace(SMALL, head=head).build().eval()
    images = torch.rand(2, 3, 32, 48)
    with torch.no_grad():
        together = network(images).depth
        assert torch.equal(network(images).depth, together)
        alone = torch.cat([network(images[n : n + 1]).depth for n in range(2)])
    if not isinstance(head, OrdinalDepth):
        assert_close(alone, together, atol=1e-4, rtol=1e-4)


def test_half_precision_gives_nearly_the_same_depth(small):
    image = torch.rand(2, 3, 32, 48)
    with torch.no_grad():
        exact = small(image).depth
        with torch.autocast("cpu", torch.bfloat16):
            rough = small(image).depth
    assert rough.dtype == torch.float32
    assert ((rough - exact).abs() / exact).median() < 0.02


def test_depth_is_what_the_bins_make_of_the_logits(small):
    prediction = small(torch.rand(1, 3, 32, 32))
    assert_close(prediction.depth, FEW.depth(prediction.logits))
    assert prediction.canonical_focal is None
    assert (
        replace(SMALL, canonical_focal=0.8).build().eval()(torch.rand(1, 3, 32, 32)).canonical_focal
        == 0.8
    )


def test_maps_of_any_meaning_come_of_maps_of_any_meaning():
    network = EDRBMaps(inputs=7, outputs=5, rows=NARROW).build().eval()
    maps = torch.randn(2, 7, 21, 18)
    out = network(maps)
    assert out.shape == (2, 5, 21, 18)
    assert (out < 0).any()
    assert (out > 0).any()


def test_frames_are_standardised_colour_by_colour():
    frames = torch.tensor([0.485, 0.456, 0.406, 0.714, 0.680, 0.631])[None, :, None, None]
    wanted = torch.tensor([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])[None, :, None, None]
    assert_close(standardised(frames), wanted)


@pytest.mark.parametrize(
    "settings",
    [
        SMALL,
        replace(SMALL, rows=NARROW.made_of(GroupedBranch(groups=4))),
        replace(SMALL, rows=NARROW.with_activations(Activations.RECOMPUTED)),
        *(replace(SMALL, head=head) for head in HEADS[2:]),
    ],
    ids=["dense", "grouped", "recomputed", "adaptive", "planar"],
)
def test_every_parameter_learns(settings):
    network = settings.build().train()
    network(torch.rand(2, 3, 40, 48)).depth.log().square().mean().backward()
    idle = [
        n for n, p in network.named_parameters() if p.grad is None or not p.grad.isfinite().all()
    ]
    assert idle == []


def test_recomputed_activations_train_the_same_network():
    torch.manual_seed(1)
    kept = SMALL.build().train()
    again = replace(SMALL, rows=NARROW.with_activations(Activations.RECOMPUTED)).build().train()
    again.load_state_dict(kept.state_dict())
    image = torch.rand(2, 3, 24, 32)
    for network in (kept, again):
        optimiser = torch.optim.SGD(network.parameters(), 0.1)
        for _ in range(2):
            optimiser.zero_grad()
            network(image).logits.square().mean().backward()
            optimiser.step()
    for name, value in kept.state_dict().items():
        assert torch.equal(value, again.state_dict()[name]), name


def test_one_exported_program_serves_every_size():
    network = replace(SMALL, rows=replace(NARROW, widths=(8, 16))).build().eval()

    class Depth(nn.Module):
        def __init__(self):
            super().__init__()
            self.network = network

        def forward(self, image):
            return self.network(image).depth

    rows, columns = (torch.export.Dim(name, min=33, max=512) for name in ("rows", "columns"))
    program = torch.export.export(
        Depth().eval(), (torch.rand(2, 3, 64, 96),), dynamic_shapes=({2: rows, 3: columns},)
    ).module()
    for size in ((64, 64), (65, 97)):
        image = torch.rand(2, 3, *size)
        assert_close(program(image), network(image).depth)


def test_four_images_are_learnt_by_heart():
    torch.manual_seed(0)
    network = SMALL.build().train()
    ramp = torch.linspace(0.1, 1.2, 24)
    depth = torch.stack([ramp.expand(24, 24), ramp.flip(0).expand(24, 24)])
    depth = torch.cat([depth, depth.mT])
    image = (depth / 1.3)[:, None].expand(4, 3, 24, 24)
    labels, _ = FEW.labels(depth)
    optimiser = torch.optim.AdamW(network.parameters(), 1e-2)
    history = []
    for _ in range(40):
        loss = nn.functional.cross_entropy(network(image).logits, labels)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        history.append(loss.item())
    assert history[-1] < 0.4 * history[0]


def test_a_single_row_has_no_decoder():
    with pytest.raises(InputError, match="at least 2 rows, got \\(64,\\)"):
        Rows(widths=(64,))
