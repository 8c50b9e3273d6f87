import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from flexdepth.runtime import edges
from flexdepth.runtime.edges import with_sharp_edges

NEAR, FAR = np.float32(np.log(1.0)), np.float32(np.log(2.0))


def grey(levels: np.ndarray) -> np.ndarray:
    return np.repeat(np.asarray(levels, np.uint8)[..., None], 3, 2)


def ramp(centre: float, width: float, columns: int = 60, rows: int = 40) -> np.ndarray:
    """Return log depth that goes from near to far over `width` columns around `centre`."""
    share = np.clip((np.arange(columns) + 0.5 - centre) / width + 0.5, 0, 1)
    return np.tile((NEAR + (FAR - NEAR) * share).astype(np.float32), (rows, 1))


def test_a_soft_edge_becomes_a_step_where_the_colour_changes():
    picture = grey(np.tile(np.where(np.arange(60) < 31, 40, 200), (40, 1)))
    sharp = with_sharp_edges(ramp(30, 5), picture)
    assert_allclose(sharp[:, :31], NEAR, atol=0.15 * (FAR - NEAR))
    assert_allclose(sharp[:, 31:], FAR, atol=0.15 * (FAR - NEAR))


def test_without_an_edge_in_the_picture_the_step_is_in_the_middle_of_the_ramp():
    sharp = with_sharp_edges(ramp(30, 5), grey(np.full((40, 60), 90)))
    jumps = np.diff(sharp[20])
    assert int(np.argmax(jumps)) == 29
    assert jumps[29] > 0.4 * (FAR - NEAR)  # The ramp has .2 of it.


def test_a_slanted_plane_and_a_flat_wall_stay_to_the_last_bit_whatever_is_painted_on_them():
    rng = np.random.default_rng(0)
    picture = rng.integers(0, 256, (40, 60, 3), np.uint8)
    rows = np.linspace(0, 0.15, 40, dtype=np.float32)[:, None]
    for log_depth in (np.zeros((40, 60), np.float32), np.broadcast_to(rows, (40, 60)).copy()):
        assert_array_equal(with_sharp_edges(log_depth, picture), log_depth)


def test_nothing_changes_far_from_edges_and_no_seam_lies_along_a_high_one():
    rng = np.random.default_rng(1)
    picture = rng.integers(0, 256, (40, 130, 3), np.uint8)
    log_depth = ramp(65, 4, columns=130)
    sharp = with_sharp_edges(log_depth, picture)
    assert sharp.min() >= NEAR - 0.02
    assert sharp.max() <= FAR + 0.02
    assert_array_equal(sharp[:, :30], log_depth[:, :30])
    assert_array_equal(sharp[:, -30:], log_depth[:, -30:])


def test_a_low_soft_edge_becomes_higher_where_the_colour_changes():
    picture = grey(np.tile(np.where(np.arange(60) < 30, 40, 200), (40, 1)))
    low = ramp(30, 5) * np.float32(0.05)
    step = np.diff(with_sharp_edges(low, picture)[20])
    assert int(np.argmax(step)) == 29
    assert step[29] > 2 * (low.max() - low.min())


def test_a_slope_stays_at_the_border_as_well():
    rows = np.linspace(0, 1.5, 40, dtype=np.float32)[:, None]
    slope = np.broadcast_to(rows, (40, 60)).copy()
    picture = np.random.default_rng(0).integers(0, 256, (40, 60, 3), np.uint8)
    assert_array_equal(with_sharp_edges(slope, picture), slope)


def test_what_it_is_given_is_left_alone():
    log_depth = ramp(30, 5)
    before = log_depth.copy()
    with_sharp_edges(log_depth, grey(np.full((40, 60), 90)))
    assert_array_equal(log_depth, before)


def test_a_large_picture_gets_the_change_of_its_small_copy(monkeypatch):
    monkeypatch.setattr(edges, "LARGEST", 30 * 20)
    picture = grey(np.tile(np.where(np.arange(60) < 34, 40, 200), (40, 1)))
    log_depth, wanted = ramp(30, 10), np.where(np.arange(60) < 34, NEAR, FAR)
    sharp = with_sharp_edges(log_depth, picture)
    assert sharp.shape == log_depth.shape
    assert np.abs(sharp - wanted).mean() < 0.85 * np.abs(log_depth - wanted).mean()
    assert abs(int(np.argmax(np.diff(sharp[20]))) - 33) <= 1
    assert_allclose(sharp[:, :8], NEAR, atol=1e-6)


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (50, 1), (3, 3)])
def test_pictures_of_any_size_are_taken(shape):
    rng = np.random.default_rng(2)
    log_depth = rng.normal(0, 1, shape).astype(np.float32)
    sharp = with_sharp_edges(log_depth, rng.integers(0, 256, (*shape, 3), np.uint8))
    assert sharp.shape == shape
    assert np.isfinite(sharp).all()
