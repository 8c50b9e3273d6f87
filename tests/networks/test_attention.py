from math import e

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.testing import assert_close

from flexdepth.networks.attention import Embedding, emphasised, similarity


def features(*seeds: int) -> list[torch.Tensor]:
    return [torch.randn(2, 8, 5, 6, generator=torch.Generator().manual_seed(s)) for s in seeds]


@given(st.floats(0.1, 10), st.floats(-10, -0.1))
def test_similarity_knows_neither_sign_nor_length(first, second):
    a, b = features(1, 2)
    assert_close(similarity(first * a, second * b), similarity(a, b), atol=1e-5, rtol=0)


def test_similarity_worked_by_hand():
    a = torch.tensor([3.0, 4.0]).reshape(1, 2, 1, 1)
    b = torch.tensor([-1.0, 0.0]).reshape(1, 2, 1, 1)
    assert similarity(a, b).item() == pytest.approx(0.6)


def test_features_of_zero_are_like_nothing_and_keep_gradients_finite():
    zero, other = torch.zeros(1, 4, 1, 1, requires_grad=True), torch.ones(1, 4, 1, 1)
    result = similarity(zero, other)
    assert result.item() == 0
    (gradient,) = torch.autograd.grad(emphasised(result).sum(), zero)
    assert gradient.isfinite().all()


def test_the_emphasis_of_nothing_half_and_all():
    got = emphasised(torch.tensor([0.0, 0.5, 1.0]))
    assert_close(got, torch.tensor([0.0, 0.824361, e]), atol=1e-6, rtol=0)


def test_a_shared_embedding_takes_the_same_features_to_the_same_place():
    (same,) = features(1)
    first, second = Embedding.SHARED.build(8, 8, ratio=4)(same, same)
    assert first.shape == (2, 2, 5, 6)
    assert_close(first, second)


def test_separate_embeddings_take_the_same_features_to_two_places():
    (same,) = features(1)
    first, second = Embedding.SEPARATE.build(8, 8, ratio=4)(same, same)
    assert first.shape == second.shape
    assert (first - second).abs().max() > 0.1


def test_features_of_unequal_widths_meet_in_the_embedding_of_the_narrower():
    embed = Embedding.SHARED.build(32, 64, ratio=16)
    first, second = embed(torch.rand(1, 32, 3, 3), torch.rand(1, 64, 3, 3))
    assert first.shape == second.shape == (1, 2, 3, 3)


def test_a_shared_embedding_starts_as_xavier_draws_it():
    weight = Embedding.SHARED.build(512, 512, ratio=2).weight
    # Variance 2 / (fan in + fan out); 131,072 draws: 0.4 % a deviation.
    assert weight.var().item() == pytest.approx(2 / (512 + 256), rel=0.02)
