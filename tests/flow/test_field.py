import numpy as np
import pytest

from flexdepth.flow.field import checked, given, likeness
from flexdepth.runtime.errors import InputError


def constant(right, down, height=20, width=30):
    return np.full((height, width, 2), (right, down), np.float32)


def test_flow_that_comes_home_is_valid_unless_it_leaves_the_picture():
    field = checked(constant(2, 0), constant(-2, 0), understatement=3, floor=0.5)
    assert field.valid[:, :28].all()
    assert not field.valid[:, 28:].any()
    assert field.coverage == pytest.approx(28 / 30)
    np.testing.assert_allclose(field.noise[:, :28], 0.5)
    assert np.isnan(field.noise[:, 28:]).all()


def test_noise_is_worked_out_from_what_is_left_of_the_round_trip():
    # e = (0.3, 0.4), |e|² = 0.25, √(0.25 / 4) = 0.25; 0.1 + 2 · 0.25.
    field = checked(constant(2, 0), constant(-1.7, 0.4), understatement=2, floor=0.1)
    np.testing.assert_allclose(field.noise[field.valid], 0.6, rtol=1e-5)


def test_a_pixel_that_is_covered_in_the_target_does_not_come_home():
    backward = constant(-2, 0)
    backward[7, 12] = (3, 0)  # What is seen there came from the right.
    field = checked(constant(2, 0), backward, understatement=1, floor=0.1)
    assert set(zip(*np.nonzero(~field.valid[:, :28]), strict=True)) == {(7, 10)}


def test_large_flow_may_be_off_by_more_than_small():
    # 0.01 (10² + 8.6²) + 0.5 = 2.24 is more than 1.4²; 0.01 (10² + 8²) + 0.5 = 2.14 less than 2².
    assert checked(constant(10, 0), constant(-8.6, 0), 1, 0.1).valid[:, :20].all()
    assert not checked(constant(10, 0), constant(-8, 0), 1, 0.1).valid.any()
    assert not checked(constant(1.4, 0), constant(0, 0), 1, 0.1).valid.any()


def test_independent_errors_of_both_ways_are_measured_as_they_are():
    forward, backward = (
        np.random.default_rng(seed).normal(0, 0.2, (200, 300, 2)).astype(np.float32)
        for seed in (0, 1)
    )
    field = checked(forward, backward, understatement=1, floor=0)
    # Between pixels, the way back is interpolated, and its error is up to a half smaller.
    assert 0.15 < np.nanmedian(field.noise) < 0.21


def test_flow_from_elsewhere_keeps_its_unknown_pixels_unknown():
    flow = constant(1, 2)
    flow[3, 4, 0] = np.nan
    flow[5, 6, 1] = np.inf
    field = given(flow, (30, 20), 0.5)
    assert (~field.valid).sum() == 2
    assert np.isnan(field.noise[3, 4])
    assert field.noise[0, 0] == 0.5


def test_flow_that_does_not_belong_to_its_frames_is_refused():
    with pytest.raises(InputError, match=r"30x20 pixels with 2 components is wanted.*20x31x2"):
        given(constant(0, 0, width=31), (30, 20), 0.5)
    with pytest.raises(InputError, match="NaN or infinite at every pixel"):
        given(constant(np.nan, 0), (30, 20), 0.5)
    for noise in (0, -1, np.nan, np.inf):
        with pytest.raises(InputError, match="noise is wanted in pixels, above 0"):
            given(constant(1, 0), (30, 20), noise)


def test_grays_that_stay_correlate_fully_and_others_do_not():
    gray = np.random.default_rng(0).integers(0, 255, (40, 50)).astype(np.uint8)
    still = given(np.zeros((40, 50, 2), np.float32), (50, 40), 0.1)
    assert likeness(gray, gray, still) == pytest.approx(1)
    assert abs(likeness(gray, gray.T[:40, :].repeat(2, 1)[:, :50], still)) < 0.2
    right = np.zeros((40, 50, 2), np.float32)
    right[..., 0] = 3
    assert likeness(gray, np.roll(gray, 3, 1), given(right, (50, 40), 0.1)) == pytest.approx(1)


def test_nothing_that_stays_in_the_picture_is_like_nothing():
    away = np.full((40, 50, 2), 500, np.float32)
    gray = np.zeros((40, 50), np.uint8)
    assert np.isnan(likeness(gray, gray, given(away, (50, 40), 0.1)))
