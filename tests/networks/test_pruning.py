from dataclasses import replace

import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.geometry.depth import NYU_BINS
from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.edrb import EDRB, EDRBMaps, Rows
from flexdepth.networks.extended import DenseBranch, GroupedBranch
from flexdepth.networks.heads import BinnedDepth
from flexdepth.networks.merge import SpatialPlusChannelAttention
from flexdepth.networks.pruning import SmallestWeights, WeakestChannels
from flexdepth.runtime.errors import InputError

NARROW = Rows(
    widths=(8, 16),
    encoder_repeats=1,
    coefficient=SpatialPlusChannelAttention(ratio=4, channel=ChannelAttention(8)),
)
SMALL = EDRB(rows=NARROW, head=BinnedDepth(replace(NYU_BINS, count=5)))


def convolutions(module: nn.Module) -> list[nn.Conv2d]:
    return [m for m in module.modules() if isinstance(m, nn.Conv2d)]


def test_the_smallest_half_of_all_weights_together_becomes_zero():
    network = nn.Sequential(nn.Conv2d(1, 2, 1), nn.ReLU(), nn.Conv2d(2, 1, 1))
    with torch.no_grad():
        network[0].weight.copy_(torch.tensor([5.0, -0.1]).reshape(2, 1, 1, 1))
        network[2].weight.copy_(torch.tensor([-3.0, 0.2]).reshape(1, 2, 1, 1))
    SmallestWeights(0.5).prune(network)
    assert network[0].weight.flatten().tolist() == [5.0, 0.0]
    assert network[2].weight.flatten().tolist() == [-3.0, 0.0]


def test_what_is_pruned_stays_zero_while_the_rest_learns_and_then_it_is_an_ordinary_network():
    torch.manual_seed(0)
    network = SMALL.build().train()
    names = set(network.state_dict())
    value = SmallestWeights(0.3)
    value.prune(network)
    before = [conv.weight.detach().clone() for conv in convolutions(network)]
    optimiser = torch.optim.SGD(network.parameters(), 0.1)
    network(torch.rand(2, 3, 16, 16)).logits.square().mean().backward()
    optimiser.step()
    value.settle(network)
    assert set(network.state_dict()) == names
    after = [conv.weight.detach() for conv in convolutions(network)]
    zeros = sum(int((x == 0).sum()) for x in after) / sum(x.numel() for x in after)
    assert zeros == pytest.approx(0.3, abs=1e-3)
    for old, new in zip(before, after, strict=True):
        assert not new[old == 0].any()
    assert any(not torch.equal(old, new) for old, new in zip(before, after, strict=True))


def silent(network: nn.Module) -> None:
    """Cut every other channel inside every branch off from what follows."""
    for name, conv in network.named_modules():
        if name.endswith(".3") and isinstance(conv, nn.Conv2d):
            nn.init.zeros_(conv.weight[:, ::2])


@pytest.mark.parametrize("settings", [SMALL, EDRBMaps(4, 3, NARROW)], ids=["depth", "maps"])
def test_channels_that_nothing_listens_to_can_go_without_a_trace(settings):
    torch.manual_seed(1)
    network = settings.build().eval()
    for norm in network.modules():
        if isinstance(norm, nn.BatchNorm2d):
            nn.init.normal_(norm.weight)
            nn.init.normal_(norm.running_mean)
    silent(network)
    smaller = WeakestChannels(0.5).pruned(network).eval()
    assert smaller.settings.rows.block.branch == DenseBranch(0.5)
    maps = torch.rand(1, 3 if settings is SMALL else 4, 17, 20)
    wanted, got = network(maps), smaller(maps)
    if settings is SMALL:
        wanted, got = wanted.logits, got.logits
    assert_close(got, wanted, atol=1e-5, rtol=1e-5)


def test_half_of_the_channels_are_half_of_the_weights_of_the_branches():
    with torch.device("meta"):
        whole, half = (
            EDRB(rows=Rows().made_of(DenseBranch(share))).build() for share in (1.0, 0.5)
        )
    kept = [sum(p.numel() for p in network.parameters()) for network in (whole, half)]
    # Of the 18 C² + 3 C of each branch 9 C² + 1.5 C go; there are 25 + 8 of them.
    gone = {256: 5 + 2, 512: 20 + 6}
    assert kept[0] - kept[1] == sum(n * (9 * c * c + 3 * c // 2) for c, n in gone.items())


def test_pruning_twice_takes_out_a_share_of_what_is_left():
    network = SMALL.build()
    once = WeakestChannels(0.5).pruned(network)
    twice = WeakestChannels(0.5).pruned(once)
    assert twice.settings.rows.block.branch == DenseBranch(0.25)
    assert network.settings == SMALL


def test_grouped_branches_are_not_pruned_by_channels():
    grouped = replace(SMALL, rows=NARROW.made_of(GroupedBranch(groups=4))).build()
    with pytest.raises(InputError, match="out of dense branches"):
        WeakestChannels().pruned(grouped)


@pytest.mark.parametrize("share", [0.0, 1.0, -0.5])
@pytest.mark.parametrize("kind", [SmallestWeights, WeakestChannels])
def test_a_share_of_nothing_or_of_everything_is_refused(kind, share):
    with pytest.raises(InputError, match="between 0 and 1"):
        kind(share)
