import json
from dataclasses import replace

import numpy as np
import pytest
import torch
from safetensors.torch import save_file
from torch.testing import assert_close

from flexdepth.networks.depth_basis import Basis, DepthBasis, Moments
from flexdepth.runtime.errors import InputError

TINY = Basis(rows=3, columns=4, components=3, nearest=0.01, farthest=1000.0)


def known(depth: torch.Tensor) -> torch.Tensor:
    return torch.ones_like(depth, dtype=torch.bool)


def maps(count: int, seed: int = 0) -> list[tuple[torch.Tensor, torch.Tensor]]:
    generator = torch.Generator().manual_seed(seed)
    depth = 1 + 9 * torch.rand(count, 3, 4, generator=generator)
    return [(x, known(x)) for x in depth]


def test_two_directions_of_known_variance_are_found_by_hand():
    # Depth is 5 ± 2 on the left, ± 1 on the right, in all four combinations: with unit vectors
    # of value 1 / √6 on six pixels, the variances are 4 · 6 and 1 · 6.
    left = torch.tensor([1.0, 1, 0, 0]).expand(3, 4)
    all_four = [5 + a * left + b * (1 - left) for a in (-2, 2) for b in (-1, 1)]
    basis = TINY.fit((x, known(x)) for x in all_four)
    assert_close(basis.mean, torch.full((3, 4), 5.0))
    assert_close(basis.variances[:3], torch.tensor([24.0, 6.0, 0.0]), atol=1e-5, rtol=0)
    assert_close(basis.components[0].abs(), left / 6**0.5, atol=1e-6, rtol=0)
    assert_close(basis.components[1].abs(), (1 - left) / 6**0.5, atol=1e-6, rtol=0)
    assert_close(basis.explained(), torch.tensor([0.8, 1.0, 1.0]))
    assert basis.count == 4


def test_it_is_the_singular_value_decomposition_of_all_maps_together():
    several = maps(150)
    basis = TINY.fit(several)
    table = np.stack([depth.double().numpy().ravel() for depth, _ in several])
    _, singular, vectors = np.linalg.svd(table - table.mean(0), full_matrices=False)
    assert_close(basis.variances, torch.tensor(singular**2 / 150).float())
    dots = np.einsum("kp,kp->k", basis.components.flatten(1).numpy(), vectors[:3])
    assert np.abs(dots) == pytest.approx(np.ones(3), abs=1e-4)
    assert basis.explained()[2].item() == pytest.approx(
        (singular[:3] ** 2).sum() / (singular**2).sum(), rel=1e-5
    )


def test_the_order_of_the_maps_and_their_parts_mean_nothing():
    several = maps(130)
    forwards, backwards = TINY.fit(several), TINY.fit(reversed(several))
    assert_close(forwards.mean, backwards.mean)
    assert_close(forwards.variances, backwards.variances)


def test_moments_of_numbers_far_from_zero_keep_their_digits():
    rows = 1e8 + torch.tensor([[1.0, 2.0], [2.0, 4.0], [6.0, 3.0]], dtype=torch.float64)
    moments = Moments.of_nothing(2).updated(rows[:1]).updated(rows[1:])
    assert moments.count == 3
    assert_close(moments.mean, rows.new_tensor([1e8 + 3, 1e8 + 3]))
    assert_close(moments.products, rows.new_tensor([[14.0, 1.0], [1.0, 2.0]]))


def test_memory_does_not_grow_with_the_number_of_maps(monkeypatch):
    asked_for, waiting = 0, []
    update = Moments.updated

    def stream():
        nonlocal asked_for
        for each in maps(300):
            asked_for += 1
            yield each

    def watched(moments, rows):
        waiting.append(asked_for - moments.count)
        return update(moments, rows)

    monkeypatch.setattr(Moments, "updated", watched)
    assert TINY.fit(stream()).count == 300
    assert max(waiting) <= 64


def test_components_are_orthonormal_and_maps_of_their_span_come_back():
    basis = TINY.fit(maps(40))
    gram = torch.einsum("krc,lrc->kl", basis.components, basis.components)
    assert_close(gram, torch.eye(3), atol=1e-5, rtol=0)
    coefficients = torch.randn(5, 3)
    assert_close(basis.coefficients(basis.maps(coefficients)), coefficients, atol=1e-4, rtol=0)
    assert_close(basis.maps(torch.zeros(3)), basis.mean)


def test_what_the_coefficients_leave_over_is_the_variance_that_is_not_explained():
    several = maps(60)
    basis = TINY.fit(several)
    small = torch.stack([TINY.small(*each) for each in several]).float()
    left = small - basis.maps(basis.coefficients(small))
    total = (small - basis.mean).square().sum()
    assert (left.square().sum() / total).item() == pytest.approx(
        1 - basis.explained()[-1].item(), abs=1e-4
    )


def test_larger_maps_are_averaged_over_what_is_known():
    depth = torch.tensor([[1.0, 3, 5, 5], [2, 9, 5, 7]])
    mask = torch.tensor([[True, True, True, True], [True, False, True, True]])
    two = Basis(rows=1, columns=2, components=1, nearest=0.1, farthest=99.0)
    assert_close(two.small(depth, mask), torch.tensor([[2.0, 5.5]]).double())
    logs = replace(two, scale="log").small(depth, mask)
    assert_close(logs.exp(), torch.tensor([[6 ** (1 / 3), 875 ** (1 / 4)]]).double())


def test_a_hole_takes_the_mean_of_the_smallest_block_around_it():
    depth = torch.tensor([[1.0, 3, 7, 9], [5, 0, 0, 0], [4, 4, 0, 0]])
    small = TINY.small(depth, depth > 0)
    expected = torch.tensor([[1.0, 3, 7, 9], [5, 3, 8, 8], [4, 4, 33 / 7, 33 / 7]])
    # The block of the last hole, 2 x 2, has nothing known; that around it, 4 x 4, has everything.
    assert_close(small[:2], expected[:2].double())
    assert_close(small[2, :2], expected[2, :2].double())
    assert small[2, 2] == small[2, 3]
    assert 1 < small[2, 2] < 9


@pytest.mark.parametrize("rubbish", [torch.nan, torch.inf, -1.0, 0.0])
def test_rubbish_where_nothing_is_known_touches_nothing(rubbish):
    several = maps(9)
    holes = [(depth, depth < 8) for depth, _ in several]
    spoilt = [(depth.where(mask, rubbish), mask) for depth, mask in holes]
    for scale in ("depth", "log"):
        settings = replace(TINY, scale=scale)
        assert_close(settings.fit(spoilt).variances, settings.fit(holes).variances)


def test_maps_without_any_known_depth_are_left_out():
    nothing = torch.zeros(3, 4), torch.zeros(3, 4, dtype=torch.bool)
    assert TINY.fit([*maps(5), nothing]).count == 5
    with pytest.raises(InputError, match="at least 2 maps with known depth, got 1"):
        TINY.fit([maps(1)[0], nothing])


def test_a_basis_survives_a_file(tmp_path):
    basis = TINY.fit(maps(20))
    basis.save(tmp_path / "basis.safetensors", TINY)
    found = DepthBasis.load(tmp_path / "basis.safetensors", TINY)
    for name in ("mean", "components", "variances"):
        assert torch.equal(getattr(found, name), getattr(basis, name))
    assert found.count == 20


def test_a_file_that_is_no_such_basis_is_refused(tmp_path):
    path = tmp_path / "basis.safetensors"
    with pytest.raises(InputError, match="no such basis"):
        DepthBasis.load(path, TINY)
    path.write_bytes(b"rubbish")
    with pytest.raises(InputError, match="not a readable safetensors file"):
        DepthBasis.load(path, TINY)
    save_file({"x": torch.zeros(1)}, path)
    with pytest.raises(InputError, match="wanted a basis of depth maps"):
        DepthBasis.load(path, TINY)
    TINY.fit(maps(5)).save(path, TINY)
    with pytest.raises(InputError, match='"components": 2'):
        DepthBasis.load(path, replace(TINY, components=2))
    save_file({"x": torch.zeros(1)}, path, {"basis": "1", "settings": json.dumps(vars(TINY))})
    with pytest.raises(InputError, match="lacks"):
        DepthBasis.load(path, TINY)


@pytest.mark.parametrize(
    "change", [{"components": 13}, {"components": 0}, {"rows": 0}, {"nearest": 0.0}]
)
def test_settings_that_make_no_basis_are_refused(change):
    with pytest.raises(InputError, match="a basis of depth maps needs"):
        replace(TINY, **change)
