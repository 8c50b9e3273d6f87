"""From the full size to half of it and back, by numbers worked out by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexdepth.solvers.answer import Kind
from flexdepth.solvers.dense import (
    Dense,
    _coarse_to_fine,
    _halved,
    _left_spread,
    _scales,
    _taken_over,
)
from flexdepth.solvers.field import Field, Terms, data_residual
from flexdepth.solvers.pose import Pose

HEIGHT, WIDTH, FOCAL = 5, 6, 50.0
"""An odd number of rows: the last has no place at half the size."""


def identity(height, width):
    return np.broadcast_to(np.eye(3), (height, width, 3, 3)).copy()


@pytest.fixture
def slanted():
    """A slanted plane that a camera sees as it goes sideways, and the flow of it: all is exact."""
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    key = np.stack([(column - WIDTH / 2) / FOCAL, (row - HEIGHT / 2) / FOCAL], -1)
    key = np.concatenate([key, np.ones((HEIGHT, WIDTH, 1))], -1)
    inverse = 0.2 + 0.3 * key[..., 0] - 0.1 * key[..., 1]
    way = np.array([0.8, -0.6, 0.0])
    terms = Terms(
        key=key,
        target=key[..., :2] + inverse[..., None] * way[:2],
        focal=np.array([FOCAL, FOCAL]),
        unit=FOCAL,
        lever=20.0,
        certain=np.ones((HEIGHT, WIDTH)),
        labels=np.zeros((HEIGHT, WIDTH), np.int32),
        region_rotation=np.eye(3)[None],
        region_translation=way[None],
        region_certain=np.ones(1),
        depth=inverse.copy(),
        depth_certain=np.zeros((HEIGHT, WIDTH)),
    )
    way_of_all = np.broadcast_to(way, (HEIGHT, WIDTH, 3)).copy()
    return Field(inverse, identity(HEIGHT, WIDTH), way_of_all), terms


def test_half_the_size_has_the_mean_of_those_of_its_own_region_by_their_certainty(slanted):
    field, terms = slanted
    field.inverse_depth[:2] = [[0.1, 0.2, 0.1, 0.7, 0.1, 0.2], [0.3, 0.4, 0.3, 0.8, 0.8, 0.9]]
    terms.labels[:2, 3] = 1
    terms.certain[:2, 4:] = [[3, 1], [0, 0]]
    terms.certain[2:4, :2] = 0
    small, half = _halved(field, terms)
    assert small.inverse_depth.shape == half.labels.shape == (2, 3)
    np.testing.assert_allclose(small.inverse_depth[0], [0.25, 0.2, 0.125], atol=1e-8)
    # Four pixels have four times the certainty, in pixels twice as large again four times that.
    np.testing.assert_allclose(half.certain, [[16, 8, 16], [0, 16, 16]], atol=1e-7)
    assert half.labels.tolist() == [[0, 0, 0], [0, 0, 0]]
    assert (half.focal.tolist(), half.unit, half.lever) == ([25.0, 25.0], 25.0, 10.0)


def test_what_is_exact_is_exact_at_half_the_size(slanted):
    small, half = _halved(*slanted)
    out = np.empty(6)
    for at in np.ndindex(2, 3):
        data_residual(small, half, *at, out)
        assert np.abs(out[:2]).max() < 1e-7
    # The middle of two by two pixels: a pixel of the small picture.
    np.testing.assert_allclose(half.key[0, 0, :2], [-2 / FOCAL, -1.5 / FOCAL], atol=1e-12)


def test_what_half_the_size_changes_is_taken_over_by_its_factor_up_to_two(slanted):
    field, _ = slanted
    before = Field(np.full((2, 3), 0.2), identity(2, 3), np.zeros((2, 3, 3)))
    way = np.arange(18.0).reshape(2, 3, 3)
    after = Field(np.array([[0.2, 0.3, 2.0], [0.1, 0.01, 0.2]]), identity(2, 3), way)
    found = _taken_over(field, before, after)
    factor = found.inverse_depth / field.inverse_depth
    np.testing.assert_allclose(factor[:2], [[1, 1, 1.5, 1.5, 2, 2]] * 2)
    # The last row has none of its own and takes the one above it.
    np.testing.assert_allclose(factor[2:], [[0.5, 0.5, 0.5, 0.5, 1, 1]] * 3)
    np.testing.assert_array_equal(found.translation[4, 5], way[1, 2])
    np.testing.assert_array_equal(found.translation[1, 2], way[0, 1])
    assert found.rotation.shape == (HEIGHT, WIDTH, 3, 3)


def test_the_scales_go_from_wide_to_narrow_but_not_below_the_noise():
    settings = Dense(wide=2.0, narrow=0.25)
    first, middle, last = (_scales(settings, share, 0.01) for share in (0.0, 0.5, 1.0))
    assert (first.field, last.field) == (2.0, 0.25)
    assert middle.field == pytest.approx(2**-0.5)  # halfway in logarithms: √(2 · 1/4)
    assert (first.planar, last.planar) == (pytest.approx(0.02), pytest.approx(0.01))
    assert _scales(settings, 1.0, 0.4).field == 0.8
    assert _scales(settings, 1.5, 0.01) == last


def test_the_truth_stays_where_it_is_through_all_sizes(slanted, monkeypatch):
    monkeypatch.setattr("flexdepth.solvers.dense._COARSEST", 2)
    field, terms = slanted
    found = _coarse_to_fine(field, terms, Dense(steps=2))
    np.testing.assert_allclose(found.inverse_depth, field.inverse_depth, rtol=1e-6)
    np.testing.assert_allclose(found.translation, field.translation, atol=1e-6)
    # Depth that is wrong by a tenth everywhere is told by flow.
    wrong = field._replace(inverse_depth=1.1 * field.inverse_depth)
    better = _coarse_to_fine(wrong, terms, Dense(steps=8))
    np.testing.assert_allclose(better.inverse_depth, field.inverse_depth, rtol=0.01)


# Across the lines still pixels are off by so many of the deviations that the spread was told, which
# are 1.25 of those said: by less than what was said noise is not; .3 shows nothing.
@pytest.mark.parametrize(
    ("off", "moved", "left"),
    [
        (1.0, 0.0, 1.0),
        (1.0, 0.6, 0.8),
        (1.0, 1.0, np.sqrt(0.1)),
        (1.0, 3.0, np.sqrt(0.9)),
        (0.8, 0.0, 0.8),
        (0.8, 0.6, np.sqrt(0.28)),
        (0.8, 0.8, np.sqrt(0.1)),
        (0.7, 0.0, 0.8),
        (0.3, 0.6, 0.8),
    ],
)
def test_what_is_left_of_a_spread_goes_by_how_far_depth_was_moved(off, moved, left):
    labels = np.repeat([[0, 0, 0, 1, 1, 2]], 4, axis=0)
    still, bends, rigid = (labels == k for k in range(3))
    kinds = (Kind.STATIC, Kind.FLEXIBLE, Kind.RIGID)
    # The camera goes sideways: what is across its lines is up or down. .125 pixels are said.
    row, column = np.mgrid[:4, :6] / FOCAL
    across = np.where(still, 0.6745 * 0.125 * off, 5.0)
    key = np.stack([column, row, np.ones_like(row)], -1)
    shift = np.stack([np.full((4, 6), 2.0), across, np.zeros((4, 6))], -1) / FOCAL
    world = SimpleNamespace(
        shape_spread=np.full((4, 6), 0.1),
        inverse_depth=np.full((4, 6), 2.0),
        labels=labels,
        regions=[SimpleNamespace(label=k, kind=kind) for k, kind in enumerate(kinds)],
        sight=SimpleNamespace(
            key=key,
            target=key + shift,
            noise=np.full((4, 6), 0.1),
            trusted=np.ones((4, 6), bool),
            focal=np.full(2, FOCAL),
        ),
        camera=SimpleNamespace(
            translates=True, noise_factor=1.25, pose=Pose(np.eye(3), np.array([1.0, 0.0, 0.0]))
        ),
    )
    # Of a normal distribution's deviations, .6745 is the median.
    found = _left_spread(world, 2.0 * np.exp(0.1 * 0.6745 * moved * np.ones((4, 6))))
    np.testing.assert_allclose(found[still], 0.1 * left, rtol=1e-9)
    np.testing.assert_allclose(found[bends], 0.1, rtol=1e-9)
    as_said = max(1 - moved**2, 0.1 * max(1.0, moved**2))
    np.testing.assert_allclose(found[rigid], 0.1 * np.sqrt(as_said), rtol=1e-9)
