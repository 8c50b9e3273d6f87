from itertools import pairwise

import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.geometry.depth import NYU_BINS, DepthBins
from flexdepth.networks.heads import OrdinalDepth, midway

# Bins end at 1, 10, 100 and 1000.
DECADES = DepthBins(3, 1.0, 1000.0, unit=1.0)


def head_that_says(odds: list[float], label: str) -> torch.Tensor:
    head = OrdinalDepth(DECADES, label).build(2)
    nn.init.zeros_(head.conv.weight)
    with torch.no_grad():
        head.conv.bias.copy_(torch.tensor(odds))
    depth, beyond = head(torch.randn(1, 2, 3, 4))
    assert_close(beyond, torch.tensor(odds).reshape(1, 3, 1, 1).expand(1, 3, 3, 4))
    assert (depth == depth[0, 0, 0]).all()
    return depth[0, 0, 0]


@pytest.mark.parametrize(
    ("odds", "expected"),
    [
        ([-1.0, -2.0, -3.0], 5.5),
        ([1.0, -2.0, -3.0], 55.0),
        ([1.0, 0.0, -3.0], 550.0),
        ([1.0, 2.0, 3.0], 550.0),
        ([-1.0, 2.0, -3.0], 55.0),
    ],
)
def test_depth_is_the_middle_of_the_bin_that_so_many_thresholds_lead_to(odds, expected):
    # (1 + 10) / 2, (10 + 100) / 2, (100 + 1000) / 2; at even odds the threshold is passed.
    assert head_that_says(odds, "counted").item() == pytest.approx(expected, rel=1e-5)


def test_the_expected_bin_may_lie_between_two():
    # Beyond the first bin for certain, beyond the second in one case of two: bin 1.5.
    odds = [100.0, 0.0, -100.0]
    assert head_that_says(odds, "expected").item() == pytest.approx(10**1.5 * 5.5, rel=1e-5)


def test_sure_of_every_threshold_both_ways_of_decoding_agree():
    for passed in range(4):
        odds = [80.0] * passed + [-80.0] * (3 - passed)
        assert_close(head_that_says(odds, "expected"), head_that_says(odds, "counted"))


def test_the_thresholds_are_those_of_the_space_increasing_discretisation():
    places = torch.arange(150.0, dtype=torch.float64)
    edges = [0.01 * 170.0 ** (k / 150) for k in range(151)]
    expected = torch.tensor([(a + b) / 2 for a, b in pairwise(edges)])
    assert_close(midway(places, NYU_BINS).float(), expected.float())


def test_only_the_expected_bin_has_a_gradient():
    for label, learns in (("counted", False), ("expected", True)):
        depth, beyond = OrdinalDepth(DECADES, label).build(2)(torch.randn(1, 2, 3, 4))
        assert depth.requires_grad == learns
        assert beyond.requires_grad


def test_the_expected_depth_has_the_gradient_of_finite_differences():
    generator = torch.Generator().manual_seed(0)
    beyond = torch.randn(2, 3, 2, 2, generator=generator, dtype=torch.float64)
    head = OrdinalDepth(DECADES, "expected").build(2)
    assert torch.autograd.gradcheck(
        lambda x: midway(head.label(x), DECADES), beyond.requires_grad_(True)
    )


def test_half_precision_does_not_lose_the_bins():
    head = OrdinalDepth(NYU_BINS).build(2)
    with torch.autocast("cpu", torch.bfloat16):
        depth, beyond = head(torch.randn(1, 2, 8, 8))
    assert beyond.dtype == torch.bfloat16
    assert depth.dtype == torch.float32


def test_the_prediction_says_what_the_odds_are_of():
    features = torch.randn(2, 4, 5, 6)
    head = OrdinalDepth().build(4)
    prediction = head.predicted(features)
    assert prediction.bins == NYU_BINS
    assert prediction.beyond.shape == (2, 150, 5, 6)
    assert prediction.logits is None
    assert_close(prediction.depth, head(features)[0])
