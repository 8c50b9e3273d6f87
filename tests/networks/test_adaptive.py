from dataclasses import replace

import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.networks.adaptive import AdaptiveBins, bin_centres
from flexdepth.runtime.errors import InputError

SMALL = AdaptiveBins(count=6, nearest=1.0, farthest=9.0, patch=4, width=8, layers=1, heads=2)


def test_centres_worked_by_hand():
    # From 1 m to 9 m: widths 4, 2, 2, so the bins end at 5, 7 and 9.
    shares = torch.tensor([[0.5, 0.25, 0.25]])
    assert_close(bin_centres(shares, 1.0, 9.0), torch.tensor([[3.0, 6.0, 8.0]]))


def test_centres_have_the_gradient_of_finite_differences():
    shares = torch.rand(2, 5, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(lambda s: bin_centres(s, 0.1, 10.0), shares)


def test_depth_is_the_mean_of_the_centres_by_probability():
    head = SMALL.build(4).eval()
    features = torch.randn(2, 4, 9, 10)
    depth, centres = head(features)
    assert (centres.diff(dim=1) > 0).all()
    assert ((centres > 1) & (centres < 9)).all()
    # Where one bin is certain, depth is its centre but for rounding.
    above, below = depth - centres[:, :1, None], centres[:, -1:, None] - depth
    assert ((above > -1e-5) & (below > -1e-5)).all()
    nn.init.zeros_(head.scores.weight)
    with torch.no_grad():
        head.scores.bias.copy_(torch.tensor([0.0, 100, 0, 0, 0, 0]))
    depth, centres = head(features)
    assert_close(depth, centres[:, 1, None, None].expand(2, 9, 10))


def test_each_image_has_its_own_bins_and_the_same_ones_in_any_batch():
    head = SMALL.build(4).eval()
    features = torch.randn(2, 4, 12, 12) * 5
    _, centres = head(features)
    assert not torch.allclose(centres[0], centres[1])
    for number in range(2):
        assert_close(head(features[number : number + 1])[1][0], centres[number])


def test_the_bins_depend_on_where_things_are():
    head = replace(SMALL, patch=1).build(4).eval()
    features = torch.randn(1, 4, 8, 8)
    both = features, features.flip(3)
    nn.init.zeros_(head.places)
    assert_close(*(head(x)[1] for x in both))
    nn.init.normal_(head.places)
    placed, turned = (head(x)[1] for x in both)
    assert not torch.allclose(placed, turned, atol=1e-4)


def test_widths_of_nothing_make_equal_bins():
    head = SMALL.build(4).eval()
    nn.init.zeros_(head.widths[-1].weight)
    nn.init.constant_(head.widths[-1].bias, -1.0)
    _, centres = head(torch.randn(1, 4, 8, 8))
    assert_close(centres, 1 + 8 * (torch.arange(6) + 0.5)[None] / 6)


@pytest.mark.parametrize("size", [(1, 1), (3, 5), (33, 20)])
def test_any_size_goes_in(size):
    assert SMALL.build(4).eval()(torch.randn(2, 4, *size))[0].shape == (2, *size)


def test_one_exported_program_serves_every_size():
    head = SMALL.build(4).eval()
    rows, columns = (torch.export.Dim(name, min=5, max=512) for name in ("rows", "columns"))
    program = torch.export.export(
        head, (torch.rand(2, 4, 16, 24),), dynamic_shapes=({2: rows, 3: columns},)
    ).module()
    features = torch.rand(2, 4, 19, 11)
    for got, wanted in zip(program(features), head(features), strict=True):
        assert_close(got, wanted)


@pytest.mark.parametrize("change", [{"nearest": 10.0}, {"nearest": -1.0}, {"width": 130}])
def test_a_range_or_a_width_that_cannot_be_is_refused(change):
    with pytest.raises(InputError, match="adaptive bins need"):
        AdaptiveBins(**change)
