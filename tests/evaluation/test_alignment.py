import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.evaluation.alignment import (
    NEAREST,
    Alignment,
    aligned,
    check_alignment,
    weakest,
)
from flexdepth.evaluation.metrics import abs_rel, delta1
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError

CAP = 10.0
seeds = st.integers(0, 2**32 - 1)


def depth_map(values, space):
    return DepthMap(np.array(values, dtype=np.float32), space)


def fit(values, space, alignment, truth, valid=None):
    truth = np.array(truth)
    valid = np.ones(truth.shape, dtype=bool) if valid is None else np.array(valid)
    return aligned(depth_map(values, space), alignment, truth, valid, CAP)


ENOUGH = {
    Space.METRIC: set(Alignment),
    Space.SCALE: set(Alignment) - {Alignment.NONE},
    Space.AFFINE_DEPTH: {Alignment.LEAST_SQUARES},
    Space.AFFINE_DISPARITY: {Alignment.LEAST_SQUARES_DISPARITY},
}


@pytest.mark.parametrize("space", Space)
@pytest.mark.parametrize("alignment", Alignment)
def test_an_alignment_must_undo_what_the_prediction_leaves_open(space, alignment):
    if alignment in ENOUGH[space]:
        check_alignment(space, alignment)
    else:
        with pytest.raises(InputError, match="leaves open; choose one of"):
            check_alignment(space, alignment)


def test_the_weakest_that_undoes_it_is_the_first_of_the_list():
    assert {space: weakest(space) for space in Space} == {
        Space.METRIC: Alignment.NONE,
        Space.SCALE: Alignment.MEDIAN,
        Space.AFFINE_DEPTH: Alignment.LEAST_SQUARES,
        Space.AFFINE_DISPARITY: Alignment.LEAST_SQUARES_DISPARITY,
    }


def test_a_weak_alignment_is_refused_before_anything_is_fitted():
    with pytest.raises(InputError, match="choose one of: least_squares_disparity"):
        fit([[1, 2]], Space.AFFINE_DISPARITY, Alignment.LEAST_SQUARES, [[1.0, 2.0]])


TRUTH = np.array([[0.5, 1.0, 2.0], [3.0, 4.0, 8.0]])
MADE_FROM_TRUTH = {
    Space.METRIC: TRUTH,
    Space.SCALE: 0.3 * TRUTH,
    Space.AFFINE_DEPTH: 0.3 * TRUTH - 7,
    Space.AFFINE_DISPARITY: 5 / TRUTH + 4,
}


@pytest.mark.parametrize(
    ("space", "alignment"), [(s, a) for s, ok in ENOUGH.items() for a in sorted(ok)]
)
def test_every_allowed_alignment_brings_a_perfect_prediction_back_to_the_truth(space, alignment):
    depth = fit(MADE_FROM_TRUTH[space], space, alignment, TRUTH)
    # The maps are float32; the offsets lose it a digit or two.
    np.testing.assert_allclose(depth, TRUTH, rtol=2e-5)


@given(seeds, st.floats(0.1, 10))
def test_the_score_of_a_prediction_up_to_scale_does_not_know_its_scale(seed, factor):
    truth, shape = np.random.default_rng(seed).uniform(1, 9, (2, 6, 6))
    valid = np.ones(truth.shape, dtype=bool)
    # Those two are not run to their end, as published, so rounding shows.
    for alignment in ENOUGH[Space.SCALE] - {Alignment.DESCENT, Alignment.SCALE_WEISZFELD}:
        first, second = (
            fit(values, Space.SCALE, alignment, truth) for values in (shape, factor * shape)
        )
        assert abs_rel(first, truth, valid) == pytest.approx(
            abs_rel(second, truth, valid), abs=1e-5
        )


@given(seeds, st.floats(0.1, 10), st.floats(-10, 10))
def test_the_score_of_disparity_knows_neither_factor_nor_offset(seed, factor, offset):
    truth, disparity = np.random.default_rng(seed).uniform(1, 9, (2, 6, 6))
    first, second = (
        fit(values, Space.AFFINE_DISPARITY, Alignment.LEAST_SQUARES_DISPARITY, truth)
        for values in (disparity, factor * disparity + offset)
    )
    np.testing.assert_allclose(first, second, rtol=1e-3)


def test_disparity_is_fitted_to_one_over_truth():
    depth = fit(
        [[0.0, 1.0, 2.0]],
        Space.AFFINE_DISPARITY,
        Alignment.LEAST_SQUARES_DISPARITY,
        [[2.0, 1.0, 2.0]],
    )
    # 1/truth is 1/2, 1, 1/2: no slope, mean 2/3.
    np.testing.assert_allclose(depth, 1.5)


def test_nothing_comes_out_beyond_the_cap_nor_behind_the_camera():
    disparity = [[1.0, 2.0, -5.0]]
    depth = fit(
        disparity,
        Space.AFFINE_DISPARITY,
        Alignment.LEAST_SQUARES_DISPARITY,
        [[1.0, 0.5, 1.0]],
        [[True, True, False]],
    )
    np.testing.assert_allclose(depth, [[1.0, 0.5, CAP]])
    depth = fit([[-3.0, 3.0, 30.0]], Space.METRIC, Alignment.NONE, [[1.0, 3.0, 1.0]])
    np.testing.assert_allclose(depth, [[NEAREST, 3.0, CAP]])


@pytest.mark.parametrize(
    ("space", "alignment"), [(s, a) for s, ok in ENOUGH.items() for a in sorted(ok)]
)
def test_sky_stays_out_of_the_fit_and_ends_at_the_cap(space, alignment):
    values = np.array(MADE_FROM_TRUTH[space], dtype=np.float32)
    values[0, 0] = -np.inf if space is Space.AFFINE_DISPARITY else np.inf
    depth = fit(values, space, alignment, TRUTH)
    assert depth[0, 0] == CAP
    np.testing.assert_allclose(depth.flat[1:], TRUTH.flat[1:], rtol=2e-5)


def test_unknown_pixels_stay_unknown():
    depth = fit([[np.nan, 2.0, 4.0]], Space.SCALE, Alignment.MEDIAN, [[1.0, 1.0, 2.0]])
    np.testing.assert_array_equal(depth, [[np.nan, 1.0, 2.0]])


def test_depth_that_is_not_positive_has_no_disparity():
    depth = fit(
        [[0.0, -1.0, 2.0, 4.0]],
        Space.SCALE,
        Alignment.LEAST_SQUARES_DISPARITY,
        [[1.0, 1.0, 1.0, 2.0]],
    )
    np.testing.assert_allclose(depth, [[np.nan, np.nan, 1.0, 2.0]])


@pytest.mark.parametrize("rubbish", [0.0, -1.0, np.nan, np.inf])
def test_rubbish_in_pixels_that_are_not_scored_does_not_move_the_fit(rubbish):
    depth = fit(
        [[1.0, 2.0, 4.0]],
        Space.SCALE,
        Alignment.LEAST_SQUARES_DISPARITY,
        [[2.0, 4.0, rubbish]],
        [[True, True, False]],
    )
    np.testing.assert_allclose(depth, [[2.0, 4.0, 8.0]], rtol=1e-6)


@pytest.mark.parametrize("values", [[[np.nan, np.nan]], [[np.inf, np.inf]]])
def test_a_prediction_that_knows_nothing_is_refused(values):
    with pytest.raises(InputError, match="nothing to fit"):
        fit(values, Space.METRIC, Alignment.NONE, [[1.0, 2.0]])


@pytest.mark.parametrize("alignment", [Alignment.MEDIAN, Alignment.SCALE])
def test_no_factor_fits_a_prediction_that_is_not_positive(alignment):
    with pytest.raises(InputError, match="no factor fits"):
        fit([[0.0, 0.0]], Space.METRIC, alignment, [[1.0, 2.0]])
    with pytest.raises(InputError, match="no factor fits"):
        fit([[-1.0, -2.0]], Space.METRIC, alignment, [[1.0, 2.0]])


def test_sizes_must_agree():
    with pytest.raises(InputError, match=r"\(1, 2\), \(2, 2\)"):
        fit([[1.0, 2.0]], Space.METRIC, Alignment.NONE, np.ones((2, 2)))


def test_a_map_turned_inside_out_scores_as_bad_as_it_is():
    """Depth stored as disparity is bent by the fit, but not straight."""
    depth = fit(TRUTH, Space.AFFINE_DISPARITY, Alignment.LEAST_SQUARES_DISPARITY, TRUTH)
    assert delta1(depth, TRUTH, np.ones(TRUTH.shape, dtype=bool)) < 0.5


@pytest.mark.parametrize("alignment", [Alignment.LEAST_SQUARES, Alignment.SCALE])
def test_a_flat_prediction_under_a_sky_is_fitted_without_a_word(alignment):
    depth = fit([[2.0, 2.0, np.inf]], Space.METRIC, alignment, [[1.0, 3.0, 1.0]])
    np.testing.assert_allclose(depth, [[2.0, 2.0, CAP]])
