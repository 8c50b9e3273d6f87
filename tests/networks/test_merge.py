from math import e

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.testing import assert_close

from flexdepth.networks.merge import (
    ChannelAttention,
    Merge,
    SpatialPlusChannelAttention,
    emphasised,
    similarity,
)
from flexdepth.runtime.errors import InputError


def features(*seeds: int) -> list[torch.Tensor]:
    return [torch.randn(2, 8, 5, 6, generator=torch.Generator().manual_seed(s)) for s in seeds]


def parameters(merge: Merge) -> int:
    return sum(p.numel() for p in merge.parameters())


@pytest.mark.parametrize(("width", "channel", "spatial"), [(256, 24576, 4096), (512, 98304, 16384)])
def test_attention_has_the_published_number_of_parameters(width, channel, spatial):
    assert parameters(Merge(ChannelAttention(), width)) == channel
    assert parameters(Merge(SpatialPlusChannelAttention(), width)) == channel + spatial


def test_channel_attention_worked_by_hand():
    merge = Merge(ChannelAttention(ratio=2), 2)
    with torch.no_grad():
        merge.weighting.squeeze.weight.copy_(
            torch.tensor([[1.0, 0.0, 2.0, 0.0], [0.0, 1.0, 0.0, 2.0]])[..., None, None]
        )
        merge.weighting.excite.weight.copy_(
            torch.tensor([[0.5, 9.0], [-0.25, 9.0]])[..., None, None]
        )
    lateral = torch.tensor([[[[0.0, 2.0]], [[2.0, 2.0]]]])
    decoder = torch.tensor([[[[3.0, 3.0]], [[-4.0, -4.0]]]])
    # Means (1, 2 | 3, -4); squeezed to (7, -6), rectified to (7, 0); excited to (3.5, -1.75).
    weight = torch.sigmoid(torch.tensor([3.5, -1.75]))[:, None, None]
    merged, attention = merge(lateral, decoder)
    assert_close(merged, weight * lateral + decoder)
    assert attention is None


def test_where_both_agree_the_spatial_attention_is_one_and_the_coefficient_e_plus_channels():
    (same,) = features(1)
    merge = Merge(SpatialPlusChannelAttention(ratio=2, channel=ChannelAttention(2)), 8)
    merged, attention = merge(same, same)
    assert_close(attention, torch.ones(2, 1, 5, 6))
    channels = merge.weighting.channel.coefficient(same, same)
    assert_close(merged, (e + channels) * same + same)


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


def test_a_decoder_too_narrow_for_its_attention_is_refused():
    with pytest.raises(InputError, match="lower the ratio or widen the decoder"):
        Merge(SpatialPlusChannelAttention(ratio=16), 16)
