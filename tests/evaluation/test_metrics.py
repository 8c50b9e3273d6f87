import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.evaluation.metrics import abs_rel, delta1
from flexdepth.runtime.errors import InputError

METRICS = (abs_rel, delta1)


def everywhere(depth):
    return np.ones(depth.shape, dtype=bool)


def test_abs_rel_is_the_mean_error_per_metre_of_truth():
    depth, truth = np.array([[3.0, 1.0]]), np.array([[2.0, 4.0]])
    # 1/2 and 3/4
    assert abs_rel(depth, truth, everywhere(truth)) == 0.625


def test_delta1_counts_ratios_below_a_quarter_more_and_misses_the_quarter_itself():
    truth = np.array([[4.0, 4.0, 4.0, 5.0, 5.0]])
    depth = np.array([[4.75, 5.0, 5.25, 4.25, 4.0]])
    # 1.19 in, 1.25 out, 1.31 out, 1/0.85 = 1.18 in, 1/0.8 = 1.25 out
    assert delta1(depth, truth, everywhere(truth)) == 0.4


@given(st.integers(0, 2**32 - 1), st.floats(0.1, 3))
def test_both_agree_with_sums_taken_pixel_by_pixel(seed, spread):
    draw = np.random.default_rng(seed)
    truth = draw.uniform(0.5, 10, (5, 7))
    depth = truth * np.exp(draw.normal(0, spread, truth.shape))
    valid = draw.random(truth.shape) < 0.7
    valid[0, 0] = True
    pairs = [(d, t) for d, t, v in zip(depth.flat, truth.flat, valid.flat, strict=True) if v]
    error = sum(abs(d - t) / t for d, t in pairs) / len(pairs)
    hits = sum(0.8 < d / t < 1.25 for d, t in pairs) / len(pairs)
    assert abs_rel(depth, truth, valid) == pytest.approx(error, rel=1e-12)
    assert delta1(depth, truth, valid) == pytest.approx(hits, rel=1e-12)


@given(st.lists(st.floats(1e-3, 80), min_size=1, max_size=20))
def test_the_truth_is_perfect(values):
    truth = np.array([values])
    assert abs_rel(truth, truth, everywhere(truth)) == 0
    assert delta1(truth, truth, everywhere(truth)) == 1


@given(st.floats(0.1, 10), st.integers(0, 1000))
def test_the_unit_does_not_matter(unit, seed):
    truth, depth = np.random.default_rng(seed).uniform(1, 10, (2, 4, 4))
    valid = everywhere(truth)
    expected = abs_rel(depth, truth, valid)
    assert abs_rel(depth * unit, truth * unit, valid) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("metric", METRICS)
@pytest.mark.parametrize("rubbish", [0.0, -1.0, np.nan, np.inf])
def test_pixels_that_are_not_scored_do_not_matter(metric, rubbish):
    depth, truth = np.array([[2.0, rubbish]]), np.array([[2.5, rubbish]])
    assert metric(depth, truth, np.array([[True, False]])) == metric(
        np.array([[2.0]]), np.array([[2.5]]), np.array([[True]])
    )


@pytest.mark.parametrize("metric", METRICS)
def test_an_image_without_scored_pixels_has_no_error(metric):
    truth = np.ones((2, 2))
    with pytest.raises(InputError, match="no pixel of this image is scored"):
        metric(truth, truth, np.zeros((2, 2), dtype=bool))


@pytest.mark.parametrize("metric", METRICS)
@pytest.mark.parametrize("depth", [0.0, -1.0, np.nan])
def test_a_scored_pixel_without_positive_depth_is_refused(metric, depth):
    truth = np.ones((1, 2))
    with pytest.raises(InputError, match="no depth > 0 at 1 of 2 scored pixels"):
        metric(np.array([[1.0, depth]]), truth, everywhere(truth))


@pytest.mark.parametrize("metric", METRICS)
@pytest.mark.parametrize("truth", [0.0, -1.0, np.nan, np.inf])
def test_a_scored_pixel_without_truth_is_refused(metric, truth):
    measured = np.array([[1.0, truth]])
    with pytest.raises(InputError, match="no measured depth"):
        metric(np.ones((1, 2)), measured, everywhere(measured))


@pytest.mark.parametrize("metric", METRICS)
def test_sizes_are_never_stretched_to_fit(metric):
    truth = np.ones((2, 3))
    with pytest.raises(InputError, match=r"\(1, 3\), \(2, 3\)"):
        metric(np.ones((1, 3)), truth, everywhere(truth))


def test_sky_where_something_was_measured_is_infinitely_wrong():
    depth, truth = np.array([[np.inf, 1.0]]), np.ones((1, 2))
    assert abs_rel(depth, truth, everywhere(truth)) == np.inf
    assert delta1(depth, truth, everywhere(truth)) == 0.5


def test_float32_maps_are_scored_in_float64():
    depth = np.full((1, 1), 1.1, dtype=np.float32)
    truth = np.ones((1, 1), dtype=np.float32)
    assert abs_rel(depth, truth, everywhere(truth)) == float(np.float32(1.1)) - 1
