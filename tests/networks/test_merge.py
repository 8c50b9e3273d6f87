from dataclasses import replace
from math import e
from typing import get_args

import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.networks.attention import ChannelAttention, Embedding
from flexdepth.networks.merge import VARIANTS, Coefficient, Merge, SpatialPlusChannelAttention
from flexdepth.runtime.errors import InputError


def features(*seeds: int) -> list[torch.Tensor]:
    return [torch.randn(2, 8, 5, 6, generator=torch.Generator().manual_seed(s)) for s in seeds]


def parameters(merge: Merge) -> int:
    return sum(p.numel() for p in merge.parameters())


ADDED = {
    "S1": 0,
    "S2": 28_672,
    "S3": 28_672 - 172_032,
    "S4": 28_672,
    "S5": 57_344,
    "S6": 28_672,
    "S7": 28_672,
    "DS7": 28_672,
    "NS7": 28_672,
}
"""Parameters of the four merges, at widths 512, 256, 256 and 256, over those of the base."""

BASE = 172_032


@pytest.mark.parametrize("name", VARIANTS)
def test_every_variant_adds_the_published_number_of_parameters(name):
    merges = [Merge(VARIANTS[name], width, width) for width in (512, 256, 256, 256)]
    assert sum(map(parameters, merges)) == BASE + ADDED[name]


def test_separate_embeddings_double_what_is_added():
    separate = replace(VARIANTS["S7"], embedding=Embedding.SEPARATE)
    merges = [Merge(separate, width, width) for width in (512, 256, 256, 256)]
    assert sum(map(parameters, merges)) == BASE + 57_344


def test_every_coefficient_is_one_of_the_published_variants():
    assert {type(variant) for variant in VARIANTS.values()} == set(get_args(Coefficient))


@pytest.mark.parametrize(
    ("lateral", "decoder", "expected"), [(512, 512, 114_688), (256, 512, 192_512)]
)
def test_a_merge_of_unequal_widths_has_the_stated_number_of_parameters(lateral, decoder, expected):
    assert parameters(Merge(VARIANTS["S7"], lateral, decoder)) == expected


@pytest.mark.parametrize("name", VARIANTS)
@pytest.mark.parametrize(("lateral", "decoder"), [(32, 64), (64, 32)])
def test_every_variant_merges_features_of_unequal_widths(name, lateral, decoder):
    merge = Merge(VARIANTS[name], lateral, decoder)
    merged, _ = merge(torch.randn(2, lateral, 5, 6), torch.randn(2, decoder, 5, 6))
    assert merged.shape == (2, lateral, 5, 6)
    assert merged.isfinite().all()


def test_channel_attention_worked_by_hand():
    merge = Merge(ChannelAttention(ratio=2), 2, 2)
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
    merge = Merge(SpatialPlusChannelAttention(ratio=2, channel=ChannelAttention(2)), 8, 8)
    merged, attention = merge(same, same)
    assert_close(attention, torch.ones(2, 1, 5, 6))
    channels = merge.weighting.channel.coefficient(same, same)
    assert_close(merged, (e + channels) * same + same)


def test_a_decoder_too_narrow_for_its_attention_is_refused():
    with pytest.raises(InputError, match="lower the ratio or widen the decoder"):
        Merge(SpatialPlusChannelAttention(ratio=16), 16, 16)


def by_hand(name: str) -> tuple[torch.Tensor, torch.Tensor | None]:
    """Merge (3, 4) of the encoder with (-1, 0) of the decoder, embedded as they are.

    Their similarity is 0.6, their dot product -3, and CA is 1/2: its last layer gives zero.
    """
    small = {"ratio": 1} | ({} if name in {"S1", "S3"} else {"channel": ChannelAttention(2)})
    merge = Merge(replace(VARIANTS[name], **small), 2, 2)
    for part, weight in merge.named_parameters():
        if part.endswith("excite.weight"):
            nn.init.zeros_(weight)
        elif "embed" in part:
            nn.init.eye_(weight[..., 0, 0])
    lateral = torch.tensor([3.0, 4.0]).reshape(1, 2, 1, 1)
    merged, attention = merge(lateral, torch.tensor([-1.0, 0.0]).reshape(1, 2, 1, 1))
    return merged.flatten(), None if attention is None else attention.flatten()


# 0.6 exp(0.6) = 1.0932713
@pytest.mark.parametrize(
    ("name", "coefficient", "attention"),
    [
        ("S1", 0.5, None),
        ("S2", 0.3, 0.6),
        ("S3", 0.6, 0.6),
        ("S4", 0.3, 0.6),
        ("S5", 1.3932713, 0.6),
        ("S6", 1.5932713, 0.6),
        ("S7", 1.5932713, 0.6),
        ("DS7", -2.5, -3.0),
        ("NS7", 1.5932713, 0.6),
    ],
)
def test_every_variant_worked_by_hand(name, coefficient, attention):
    merged, looked_at = by_hand(name)
    assert_close(merged, torch.tensor([3 * coefficient - 1, 4 * coefficient]))
    assert (
        (looked_at is None) if attention is None else looked_at.item() == pytest.approx(attention)
    )


def test_features_of_unequal_widths_are_merged_as_the_formula_says():
    merge = Merge(VARIANTS["S7"], 32, 64).double()
    # Long features, for which the 1e-8 that is added to squared lengths is nothing.
    lateral, decoder = (100 * torch.randn(2, width, 3, 4).double() for width in (32, 64))
    merged, attention = merge(lateral, decoder)
    weighting = merge.weighting
    first = torch.einsum("oi,bihw->bohw", weighting.embed.lateral.weight[..., 0, 0], lateral)
    second = torch.einsum("oi,bihw->bohw", weighting.embed.decoder.weight[..., 0, 0], decoder)
    cosine = torch.cosine_similarity(first, second, dim=1).abs()[:, None]
    assert_close(attention, cosine, atol=1e-6, rtol=0)
    seen = torch.cat([lateral, decoder], 1).mean((2, 3))
    inner = (seen @ weighting.channel.squeeze.weight[..., 0, 0].mT).relu()
    channels = (inner @ weighting.channel.excite.weight[..., 0, 0].mT).sigmoid()[..., None, None]
    adapted = torch.einsum("oi,bihw->bohw", merge.adapt.weight[..., 0, 0], decoder)
    expected = (cosine * cosine.exp() + channels) * lateral + adapted
    assert_close(merged, expected, atol=1e-5, rtol=0)
