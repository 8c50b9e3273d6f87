"""What a network says of its own answer."""

import torch
from torch.testing import assert_close

from flexdepth.networks.certainty import FocalLength, Spread


def test_a_spread_is_positive_and_twice_the_size_of_its_features():
    spread = Spread().build(8)(100 * torch.randn(2, 8, 3, 5))
    assert spread.shape == (2, 6, 10)
    assert (spread >= 0.003 * (1 - 1e-5)).all()
    assert (spread <= 3 * (1 + 1e-5)).all()


def test_features_of_zero_have_the_typical_spread():
    assert_close(Spread(typical=0.2).build(4)(torch.zeros(1, 4, 2, 2)), torch.full((1, 4, 4), 0.2))


def test_looking_at_the_spread_teaches_the_features_nothing():
    features = torch.randn(1, 4, 2, 2, requires_grad=True)
    spread = Spread().build(4)(features)
    assert spread.requires_grad
    spread.sum().backward()
    assert features.grad is None


def test_one_focal_length_for_each_image_however_large():
    head = FocalLength().build(6)
    features = torch.randn(3, 6, 1, 1)
    assert head(features).shape == (3,)
    assert_close(head(features.expand(3, 6, 4, 2)), head(features))
    assert (head(1e4 * features) <= 10 * (1 + 1e-5)).all()
