import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.geometry.depth import KITTI_BINS, NYU_BINS
from flexdepth.networks.heads import BinnedDepth, LogDepth


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


@pytest.mark.parametrize(
    ("bins", "expected", "parameters"),
    [(NYU_BINS, 1.30384, 345_750), (KITTI_BINS, 9.79796, 230_500)],
)
def test_bins_of_equal_score_mean_the_geometric_mean_of_the_range(bins, expected, parameters):
    head = BinnedDepth(bins).build(256)
    assert sum(p.numel() for p in head.parameters()) == parameters
    nn.init.zeros_(head.conv.weight)
    depth, logits = head(torch.randn(1, 256, 3, 4))
    assert logits.shape == (1, bins.count, 3, 4)
    assert_close(depth * bins.unit, torch.full((1, 3, 4), expected), atol=1e-5, rtol=1e-5)


def test_a_pixel_s_bins_see_two_steps_around_it():
    head = BinnedDepth().build(2)
    features = torch.rand(1, 2, 9, 9, requires_grad=True)
    _, logits = head(features)
    (gradient,) = torch.autograd.grad(logits[0, :, 4, 4].sum(), features)
    seen = {divmod(int(i), 9) for i in gradient.abs().sum((0, 1)).flatten().nonzero()}
    assert seen == {(row, column) for row in (2, 4, 6) for column in (2, 4, 6)}


def test_the_prediction_says_what_the_logits_are_of():
    head, features = BinnedDepth(KITTI_BINS).build(4), torch.randn(2, 4, 5, 6)
    prediction = head.predicted(features)
    depth, logits = head(features)
    assert prediction.bins == KITTI_BINS
    assert prediction.beyond is None
    assert_close(prediction.depth, depth)
    assert_close(prediction.logits, logits)


def test_a_stretched_depth_is_so_many_times_what_it_was_and_the_sky_stays():
    head, features = LogDepth(farthest=400.0).build(4), torch.randn(2, 4, 6, 8)
    depth, sky = head(features)
    head.stretch(1.25)
    farther, same = head(features)
    assert_close(farther, 1.25 * depth)
    assert_close(same, sky)
