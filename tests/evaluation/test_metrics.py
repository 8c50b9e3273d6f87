import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.evaluation.metrics import METRICS, Scored, abs_rel, delta1
from flexdepth.runtime.errors import InputError

EVERY = tuple(METRICS.values())

INDEPENDENT = {
    "abs_rel": lambda p, g: np.mean(np.abs(p - g) / g),
    "sq_rel": lambda p, g: np.mean((p - g) ** 2 / g),
    "sq_rel_squared": lambda p, g: np.mean(((p - g) / g) ** 2),
    "rmse": lambda p, g: np.sqrt(np.mean((p - g) ** 2)),
    "rmse_log": lambda p, g: np.sqrt(np.mean((np.log(p) - np.log(g)) ** 2)),
    "log10": lambda p, g: np.mean(np.abs(np.log10(p) - np.log10(g))),
    "silog": lambda p, g: 100 * np.std(np.log(p / g)),
    "silog_half": lambda p, g: np.sqrt(
        np.mean(np.log(p / g) ** 2) - 0.5 * np.mean(np.log(p / g)) ** 2
    ),
    "silog_sample": lambda p, g: 100 * np.std(np.log(p / g), ddof=1),
    "scale_invariant": lambda p, g: (
        np.mean((np.log(p / g)[:, None] - np.log(p / g)[None]) ** 2) / 2
    ),
    "delta1": lambda p, g: np.mean((p < 1.25 * g) & (g < 1.25 * p)),
    "delta2": lambda p, g: np.mean((p < 1.5625 * g) & (g < 1.5625 * p)),
    "delta3": lambda p, g: np.mean((p < 1.953125 * g) & (g < 1.953125 * p)),
}
"""Each metric in a line of NumPy, without terms, means and values."""


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


def test_every_metric_has_an_independent_line():
    assert INDEPENDENT.keys() == METRICS.keys()


@pytest.mark.parametrize("name", METRICS)
@given(st.integers(0, 2**32 - 1), st.floats(0.1, 3))
def test_every_metric_agrees_with_an_independent_line(name, seed, spread):
    draw = np.random.default_rng(seed)
    truth = draw.uniform(0.5, 10, (5, 7))
    depth = truth * np.exp(draw.normal(0, spread, truth.shape))
    valid = draw.random(truth.shape) < 0.7
    valid[0, :2] = True
    wanted = INDEPENDENT[name](depth[valid], truth[valid])
    assert METRICS[name](depth, truth, valid) == pytest.approx(wanted, rel=1e-9, abs=1e-12)


@given(st.integers(0, 2**32 - 1), st.floats(0.1, 3))
def test_sq_rel_is_at_least_the_square_of_rmse_over_the_farthest_truth(seed, spread):
    # The dissertation's tables 5.2 and 5.3 break it: .532 at an RMS of 10.551 and truth up to 80 m.
    draw = np.random.default_rng(seed)
    truth = draw.uniform(1, 80, (5, 7))
    depth = truth * np.exp(draw.normal(0, spread, truth.shape))
    sq_rel, rmse = (METRICS[name](depth, truth, everywhere(truth)) for name in ("sq_rel", "rmse"))
    assert sq_rel >= rmse**2 / truth.max() * (1 - 1e-12)
    assert 10.551**2 / 80 > 0.532


def test_the_metrics_of_two_pixels_are_those_worked_by_hand():
    # e and 1/e times the truth of 2 m and 4 m: d is 1 and -1.
    truth = np.array([[2.0, 4.0]])
    depth = truth * np.exp([[1.0, -1.0]])
    e = np.e
    wanted = {
        "abs_rel": ((e - 1) + (1 - 1 / e)) / 2,
        "sq_rel": (2 * (e - 1) ** 2 + 4 * (1 - 1 / e) ** 2) / 2,
        "sq_rel_squared": ((e - 1) ** 2 + (1 - 1 / e) ** 2) / 2,
        "rmse": np.sqrt((4 * (e - 1) ** 2 + 16 * (1 - 1 / e) ** 2) / 2),
        "rmse_log": 1.0,
        "log10": 1 / np.log(10),
        "silog": 100.0,
        "silog_half": 1.0,
        "silog_sample": 100 * np.sqrt(2),
        "scale_invariant": 1.0,
        "delta1": 0.0,
        "delta2": 0.0,
        "delta3": 0.0,
    }
    found = {name: metric(depth, truth, everywhere(truth)) for name, metric in METRICS.items()}
    assert found == pytest.approx(wanted, abs=1e-12)


def test_the_three_silogs_differ_on_a_map_that_is_too_far_throughout():
    # d is 0.1, 0.1, 0.1, 0.5: mean 0.2, mean square 0.07, variance 0.03.
    truth = np.full((1, 4), 3.0)
    depth = truth * np.exp([[0.1, 0.1, 0.1, 0.5]])
    everything = everywhere(truth)
    assert METRICS["silog"](depth, truth, everything) == pytest.approx(100 * 0.03**0.5)
    assert METRICS["silog_half"](depth, truth, everything) == pytest.approx(0.05**0.5)
    assert METRICS["silog_sample"](depth, truth, everything) == pytest.approx(100 * 0.04**0.5)
    # Twice as far throughout moves only the one that is not blind to scale: d rises by ln 2.
    assert METRICS["silog"](2 * depth, truth, everything) == pytest.approx(100 * 0.03**0.5)
    assert METRICS["silog_half"](2 * depth, truth, everything) == pytest.approx(
        (0.03 + 0.5 * (0.2 + np.log(2)) ** 2) ** 0.5
    )


def test_the_scale_invariant_error_is_half_the_mean_square_over_all_pairs_of_pixels():
    # d is 0, 0 and 3: of the nine ordered pairs four are 3 apart, 36 / 9 / 2 = 2. Half of that
    # is what (1.8) of the dissertation would give.
    truth = np.ones((1, 3))
    depth = np.exp([[0.0, 0.0, 3.0]])
    assert METRICS["scale_invariant"](depth, truth, everywhere(truth)) == pytest.approx(2.0)


@pytest.mark.parametrize("name", METRICS)
def test_two_halves_of_an_image_pool_to_the_whole(name):
    """The means of both halves, weighted by their pixels, give the metric of all pixels."""
    truth, depth = np.random.default_rng(5).uniform(1, 9, (2, 60))
    metric = METRICS[name]
    halves = [Scored(depth[part], truth[part]) for part in (slice(20), slice(20, 60))]
    weighted = zip(*(np.array(metric.means(h)) * len(h.truth) / 60 for h in halves), strict=True)
    pooled = metric.of(tuple(float(sum(each)) for each in weighted), 60)
    assert pooled == pytest.approx(INDEPENDENT[name](depth, truth), rel=1e-12)


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


@pytest.mark.parametrize("metric", EVERY)
@pytest.mark.parametrize("rubbish", [0.0, -1.0, np.nan, np.inf])
def test_pixels_that_are_not_scored_do_not_matter(metric, rubbish):
    depth, truth = np.array([[2.0, rubbish]]), np.array([[2.5, rubbish]])
    assert metric(depth, truth, np.array([[True, False]])) == metric(
        np.array([[2.0]]), np.array([[2.5]]), np.array([[True]])
    )


@pytest.mark.parametrize("metric", EVERY)
def test_an_image_without_scored_pixels_has_no_error(metric):
    truth = np.ones((2, 2))
    with pytest.raises(InputError, match="no pixel of this image is scored"):
        metric(truth, truth, np.zeros((2, 2), dtype=bool))


@pytest.mark.parametrize("metric", EVERY)
@pytest.mark.parametrize("depth", [0.0, -1.0, np.nan])
def test_a_scored_pixel_without_positive_depth_is_refused(metric, depth):
    truth = np.ones((1, 2))
    with pytest.raises(InputError, match="no depth > 0 at 1 of 2 scored pixels"):
        metric(np.array([[1.0, depth]]), truth, everywhere(truth))


@pytest.mark.parametrize("metric", EVERY)
@pytest.mark.parametrize("truth", [0.0, -1.0, np.nan, np.inf])
def test_a_scored_pixel_without_truth_is_refused(metric, truth):
    measured = np.array([[1.0, truth]])
    with pytest.raises(InputError, match="no measured depth"):
        metric(np.ones((1, 2)), measured, everywhere(measured))


@pytest.mark.parametrize("metric", EVERY)
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
