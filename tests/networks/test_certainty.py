"""What a network says of its own answer."""

import pytest
import torch
from torch.testing import assert_close

from flexdepth.networks.certainty import FocalLength, Spread

WIDTHS = (8, 6, 4, 2)


def features(scale: float = 1.0) -> list[torch.Tensor]:
    """Return features of an image 64 wide and 32 high, at strides 32, 16, 8 and 4."""
    sizes = zip(WIDTHS, ((1, 2), (2, 4), (4, 8), (8, 16)), strict=True)
    return [scale * torch.randn(2, width, *size) for width, size in sizes]


def test_a_spread_is_positive_and_of_the_image_s_size():
    spread = Spread().build(WIDTHS)(features(100.0))
    assert spread.shape == (2, 32, 64)
    assert (spread >= 0.003 * (1 - 1e-5)).all()
    assert (spread <= 3 * (1 + 1e-5)).all()


def test_features_of_zero_have_the_typical_spread():
    spread = Spread(typical=0.2).build(WIDTHS)(features(0.0))
    assert_close(spread, torch.full((2, 32, 64), 0.2))


def test_a_widened_spread_is_so_many_times_what_it_was():
    head, seen = Spread().build(WIDTHS), features()
    before = head(seen)
    head.widen(1.25)
    assert_close(head(seen), (1.25 * before).clamp(max=3))


@pytest.mark.parametrize("level", range(4))
def test_the_spread_hangs_on_the_features_of_every_stride(level):
    head, seen = Spread().build(WIDTHS), features()
    before = head(seen)
    seen[level] = torch.randn_like(seen[level])
    assert not torch.equal(head(seen), before)


def test_looking_at_the_spread_teaches_the_features_nothing():
    seen = [each.requires_grad_() for each in features()]
    spread = Spread().build(WIDTHS)(seen)
    assert spread.requires_grad
    spread.sum().backward()
    assert all(each.grad is None for each in seen)


def test_one_focal_length_for_each_image_however_large():
    head = FocalLength().build(6)
    features = torch.randn(3, 6, 1, 1)
    assert head(features).shape == (3,)
    assert_close(head(features.expand(3, 6, 4, 2)), head(features))
    assert (head(1e4 * features) <= 10 * (1 + 1e-5)).all()
