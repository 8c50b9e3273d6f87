import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.evaluation.boundary import THRESHOLDS, boundary_f1, boundary_recall
from flexdepth.runtime.errors import InputError

seeds = st.integers(0, 2**32 - 1)


def everywhere(depth):
    return np.ones(depth.shape, dtype=bool)


def step(near, far, at=3, shape=(6, 8)):
    """A wall of which the right part, from column `at`, is farther."""
    depth = np.full(shape, float(near))
    depth[:, at:] = far
    return depth


def by_loops(depth, truth, threshold):
    """F1 pixel by pixel, as the paper describes it."""
    height, width = truth.shape
    hits, seen, true = np.zeros((3, 4))
    for row in range(height):
        for column in range(width):
            for way, (down, right) in enumerate(((0, 1), (0, -1), (1, 0), (-1, 0))):
                r, c = row + down, column + right
                if not (0 <= r < height and 0 <= c < width):
                    continue
                is_seen = depth[r, c] / depth[row, column] > threshold
                is_true = truth[r, c] / truth[row, column] > threshold
                hits[way] += is_seen and is_true
                seen[way] += is_seen
                true[way] += is_true
    precision = np.mean(hits / np.maximum(seen, 1))
    recall = np.mean(hits / np.maximum(true, 1))
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0


@given(seeds)
def test_it_agrees_with_the_paper_pixel_by_pixel(seed):
    truth, depth = np.random.default_rng(seed).choice([1, 1.08, 1.2, 1.5], (2, 5, 6))
    truth[0, :2] = 1, 2
    each = [by_loops(depth, truth, t) for t in np.linspace(1.05, 1.25, 10)]
    wanted = sum(np.linspace(1.05, 1.25, 10) * each) / np.linspace(1.05, 1.25, 10).sum()
    assert boundary_f1(depth, truth, everywhere(truth)) == pytest.approx(wanted, abs=1e-12)


def test_the_truth_scores_a_half_where_its_edges_run_one_way_alone():
    # The step is an edge to the right alone; recall is (1 + 0 + 0 + 0) / 4, and so is precision.
    truth = step(1, 2)
    assert boundary_f1(truth, truth, everywhere(truth)) == pytest.approx(0.25)


def test_the_truth_with_edges_in_all_four_directions_is_perfect():
    truth = np.ones((5, 5))
    truth[2, 2] = 2
    # Around the far pixel an edge leads up to it in each direction.
    assert boundary_f1(3 * truth, truth, everywhere(truth)) == pytest.approx(1)


def test_a_faint_edge_counts_up_to_its_own_strength():
    truth = np.ones((5, 5))
    truth[2, 2] = 2
    faint = np.where(truth > 1, 1.1, 1.0)
    below = THRESHOLDS[THRESHOLDS < 1.1].sum()
    wanted = below / THRESHOLDS.sum()
    assert boundary_f1(faint, truth, everywhere(truth)) == pytest.approx(wanted)


def test_an_edge_beside_the_true_one_or_the_wrong_way_round_is_a_miss():
    truth = step(1, 2)
    assert boundary_f1(step(1, 2, at=4), truth, everywhere(truth)) == 0
    assert boundary_f1(step(2, 1), truth, everywhere(truth)) == 0


@given(seeds, st.floats(0.1, 10))
def test_a_factor_on_the_prediction_changes_nothing(seed, factor):
    truth, depth = np.random.default_rng(seed).uniform(1, 9, (2, 6, 6))
    valid = everywhere(truth)
    assert boundary_f1(factor * depth, truth, valid) == pytest.approx(
        boundary_f1(depth, truth, valid), abs=1e-9
    )


@pytest.mark.parametrize("rubbish", [0.0, -1.0, np.nan, np.inf])
def test_pairs_with_an_unknown_pixel_do_not_count(rubbish):
    truth, depth = step(1, 2), step(1, 2)
    valid = everywhere(truth)
    valid[:, 6] = False
    truth[:, 6] = depth[:, 6] = rubbish
    assert boundary_f1(depth, truth, valid) == pytest.approx(0.25)


def test_a_truth_without_edges_has_no_score():
    flat = np.ones((4, 4))
    with pytest.raises(InputError, match="no edge"):
        boundary_f1(flat, flat, everywhere(flat))


def test_a_prediction_without_depth_is_refused():
    truth = step(1, 2)
    with pytest.raises(InputError, match="no depth > 0 at 1 of 48"):
        boundary_f1(np.where(np.arange(48).reshape(6, 8) == 7, np.nan, truth), truth, truth > 0)


def test_a_matte_is_recalled_where_depth_steps_at_its_outline():
    # Foreground left of column 3: one direction of four has an outline, and it is found.
    opacity = (step(0, 1) == 0).astype(float)
    assert boundary_recall(step(1, 2), opacity) == pytest.approx(0.25)
    assert boundary_recall(step(2, 1), opacity) == 0


def test_of_a_blurred_edge_only_the_steepest_step_counts():
    opacity = (step(0, 1, at=4) == 0).astype(float)
    rise = np.array([1.0, 1, 1, 1.3, 2.6, 3.4, 3.4, 3.4])
    # Between columns 3 and 4 the factor is 2, on either side 1.3: thinned to the outline.
    assert boundary_recall(np.tile(rise, (6, 1)), opacity) == pytest.approx(0.25)
    beside = (step(0, 1, at=5) == 0).astype(float)
    assert boundary_recall(np.tile(rise, (6, 1)), beside) == 0


def test_the_matte_begins_where_it_is_a_tenth_opaque():
    opacity = np.where(step(0, 1) == 0, 0.1, 0.0)
    with pytest.raises(InputError, match="no outline"):
        boundary_recall(step(1, 2), opacity)
    assert boundary_recall(step(1, 2), opacity * 1.01) == pytest.approx(0.25)
