import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.evaluation.lines import (
    Line,
    Moments,
    descended,
    least_squares,
    median,
    scale,
    weiszfeld,
)

seeds = st.integers(0, 2**32 - 1)


def test_the_scale_is_the_nearest_multiple():
    # (1·2 + 2·5 + 3·4) / (1 + 4 + 9)
    assert scale(np.array([1.0, 2.0, 3.0]), np.array([2.0, 5.0, 4.0])) == Line(24 / 14)


def test_the_median_is_the_ratio_of_medians_and_not_the_median_ratio():
    # Medians 2 and 6, though the ratios are 9, 2 and 2.
    assert median(np.array([1.0, 2.0, 3.0]), np.array([9.0, 4.0, 6.0])) == Line(3.0)


def test_the_line_is_the_one_fitted_by_hand():
    # Means 2 and 3; Σ dx dy = 2, Σ dx² = 2.
    assert least_squares(np.array([1.0, 2.0, 3.0]), np.array([1.0, 5.0, 3.0])) == Line(1.0, 1.0)


@given(seeds, st.floats(-5, 5), st.floats(-5, 5))
def test_least_squares_finds_the_planted_line(seed, factor, offset):
    x = np.random.default_rng(seed).uniform(0, 1, 50)
    line = least_squares(x, factor * x + offset)
    assert line.factor == pytest.approx(factor, abs=1e-11)
    assert line.offset == pytest.approx(offset, abs=1e-11)


@given(seeds)
def test_least_squares_agrees_with_an_independent_solver(seed):
    x, y = np.random.default_rng(seed).uniform(0, 1, (2, 40))
    factor, offset = np.linalg.lstsq(np.stack([x, np.ones(40)], axis=1), y, rcond=None)[0]
    line = least_squares(x, y)
    assert (line.factor, line.offset) == pytest.approx((factor, offset), abs=1e-11)


@given(seeds, st.floats(-1, 1), st.floats(-1, 1))
def test_no_other_line_is_nearer(seed, turn, lift):
    x, y = np.random.default_rng(seed).uniform(0, 1, (2, 40))
    line = least_squares(x, y)
    other = Line(line.factor + turn, line.offset + lift)
    assert np.square(line(x) - y).sum() <= np.square(other(x) - y).sum() + 1e-12


def test_a_constant_fits_as_the_mean():
    assert least_squares(np.full(3, 0.1), np.array([1.0, 2.0, 6.0])) == Line(0.0, 3.0)


@given(seeds, st.integers(1, 39))
def test_a_clip_in_two_parts_has_the_moments_of_the_whole(seed, cut):
    x, y = np.random.default_rng(seed).uniform(0, 1, (2, 40))
    parts = Moments.of(x[:cut], y[:cut]) + Moments.of(x[cut:], y[cut:])
    whole, factor = parts.least_squares(), float(x @ y) / float(x @ x)
    wanted = np.linalg.lstsq(np.stack([x, np.ones(40)], axis=1), y, rcond=None)[0]
    assert (whole.factor, whole.offset) == pytest.approx(tuple(wanted), abs=1e-11)
    assert parts.scale().factor == pytest.approx(factor, abs=1e-11)


def test_a_clip_that_is_flat_throughout_fits_as_the_mean():
    first = Moments.of(np.full(3, 0.1), np.array([1.0, 2.0, 6.0]))
    assert (first + first).least_squares() == Line(0.0, 3.0)
    second = Moments.of(np.full(3, 0.2), np.array([5.0, 5.0, 5.0]))
    # From (0.1, 3) to (0.2, 5).
    line = (first + second).least_squares()
    assert (line.factor, line.offset) == pytest.approx((20, 1), abs=1e-9)


def test_weiszfeld_ends_at_the_ratio_that_most_pixels_have():
    x = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    # Least squares would go to 220 / 55 = 4, but all pixels except the last say 2.
    y = np.array([2.0, 4.0, 6.0, 8.0, 20.0])
    assert weiszfeld(x, y).factor == pytest.approx(2, abs=1e-3)


def test_weiszfeld_goes_no_lower_than_a_thousandth():
    assert weiszfeld(np.array([1e6]), np.array([1.0])) == Line(1e-3)


def test_descent_is_the_one_of_torch():
    torch = pytest.importorskip("torch")
    x, y = np.random.default_rng(3).uniform(1, 9, (2, 200))
    factor, offset = (torch.tensor([start], dtype=torch.float64) for start in (1.0, 0.0))
    factor[0] = float(np.median(y) / np.median(x))
    for each in (factor, offset):
        each.requires_grad_()
    optimiser = torch.optim.Adam([factor, offset], lr=1e-4)
    for _ in range(200):
        optimiser.zero_grad()
        (factor * torch.from_numpy(x) + offset - torch.from_numpy(y)).abs().sum().backward()
        optimiser.step()
    line = descended(x, y, steps=200)
    assert line.factor == pytest.approx(factor.item(), abs=1e-9)
    assert line.offset == pytest.approx(offset.item(), abs=1e-9)


def test_descent_does_not_undo_an_offset():
    x = np.random.default_rng(0).uniform(1, 9, 50)
    # The median alone is at (x + 5) / x; Adam's steps of 0.0001 sum up to 0.316 at most.
    line, begin = descended(x, x + 5), median(x, x + 5)
    assert abs(line.factor - begin.factor) < 0.316
    assert 0 < line.offset < 0.316
