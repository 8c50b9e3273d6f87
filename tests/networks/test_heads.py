import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.networks.heads import LogDepth


def head_of(constant: tuple[float, float]) -> nn.Module:
    head = LogDepth(typical=3.0, nearest=0.5, farthest=40.0).build(4)
    nn.init.zeros_(head.conv.weight)
    with torch.no_grad():
        head.conv.bias.copy_(torch.tensor(constant))
    return head


@pytest.mark.parametrize(("log_depth", "expected"), [(0, 3.0), (1, 8.154845), (-9, 0.5), (9, 40.0)])
def test_the_first_channel_is_the_log_of_depth_over_what_is_typical(log_depth, expected):
    depth, sky = head_of((log_depth, -2.0))(torch.randn(2, 4, 3, 5))
    assert_close(depth, torch.full((2, 6, 10), expected))
    assert_close(sky, torch.full((2, 6, 10), -2.0))


def test_an_untrained_head_says_about_the_typical_depth():
    depth, _ = LogDepth().build(32)(torch.rand(1, 32, 8, 8))
    assert (depth.log() - torch.tensor(3.0).log()).abs().max() < 1
