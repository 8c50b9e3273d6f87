from dataclasses import replace

import pytest
import torch
from torch import Tensor
from torch.testing import assert_close
from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils._pytree import tree_leaves

from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.conventional import attended_everywhere
from flexdepth.networks.merge import VARIANTS, Merge

SMALL = {"ratio": 2, "channel": ChannelAttention(2)}


class LargestTensor(TorchDispatchMode):
    """Remembers how many numbers the largest tensor had that anything returned."""

    def __init__(self) -> None:
        super().__init__()
        self.numbers = 0

    def __torch_dispatch__(self, function, types, arguments=(), named=None):
        result = function(*arguments, **(named or {}))
        sizes = [x.numel() for x in tree_leaves(result) if isinstance(x, Tensor)]
        self.numbers = max(self.numbers, *sizes, 0)
        return result


def maps(*channels: int, size: tuple[int, int] = (4, 6)) -> list[Tensor]:
    torch.manual_seed(0)
    return [torch.randn(2, c, *size, dtype=torch.float64, requires_grad=True) for c in channels]


def test_on_features_that_are_the_same_everywhere_looking_everywhere_is_looking_here():
    here = Merge(replace(VARIANTS["S7"], **SMALL), 8, 8)
    everywhere = Merge(replace(VARIANTS["NS7"], **SMALL), 8, 8)
    everywhere.load_state_dict(here.state_dict())
    constant = [torch.randn(2, 8, 1, 1).expand(2, 8, 5, 7) for _ in range(2)]
    for got, right in zip(everywhere(*constant), here(*constant), strict=True):
        assert_close(got, right)


def test_a_pixel_sees_every_other_as_much_as_it_is_alike():
    lateral, key, query = maps(3, 2, 2)
    attended, alike = attended_everywhere(lateral, key, query, rows=5)
    places = [divmod(n, 6) for n in range(24)]
    for p in places:
        cosines = [torch.cosine_similarity(query[0, :, *p], key[0, :, *q], dim=0) for q in places]
        shares = [abs(c) * abs(c).exp() / 24 for c in cosines]
        expected = sum(s * lateral[0, :, *q] for s, q in zip(shares, places, strict=True))
        assert_close(attended[0, :, *p], expected, atol=1e-6, rtol=0)
        assert_close(alike[0, 0, *p], sum(map(abs, cosines)) / 24, atol=1e-6, rtol=0)


@pytest.mark.parametrize("rows", [1, 7, 24, 100])
def test_the_rows_at_a_time_change_neither_value_nor_gradient(rows):
    inputs = maps(3, 2, 2)
    whole, some = (attended_everywhere(*inputs, rows=r)[0] for r in (24, rows))
    assert_close(some, whole)
    weight = torch.randn_like(whole)
    for got, right in zip(
        torch.autograd.grad((some * weight).sum(), inputs),
        torch.autograd.grad((whole * weight).sum(), inputs),
        strict=True,
    ):
        assert_close(got, right)


def test_its_gradient_is_that_of_finite_differences():
    inputs = maps(2, 2, 2, size=(2, 2))
    assert torch.autograd.gradcheck(lambda *x: attended_everywhere(*x, rows=3), inputs)


def test_no_matrix_of_all_pixels_by_all_pixels_is_ever_made():
    inputs = maps(4, 2, 2, size=(30, 20))
    with LargestTensor() as largest:
        attended, _ = attended_everywhere(*inputs, rows=10)
        attended.square().sum().backward()
    assert largest.numbers <= 2 * 600 * 10


@pytest.mark.parametrize(("power", "expected"), [(0.0, -3.0), (0.5, -3 / 2**0.5), (1.0, -1.5)])
def test_the_dot_product_is_divided_by_a_power_of_the_embedding_s_width(power, expected):
    merge = Merge(replace(VARIANTS["DS7"], ratio=1, channel=ChannelAttention(2), power=power), 2, 2)
    torch.nn.init.eye_(merge.weighting.embed.weight[..., 0, 0])
    lateral = torch.tensor([3.0, 4.0]).reshape(1, 2, 1, 1)
    _, product = merge(lateral, torch.tensor([-1.0, 0.0]).reshape(1, 2, 1, 1))
    assert product.item() == pytest.approx(expected)
