import numpy as np
import pytest

from flexdepth.flow.field import given
from flexdepth.flow.matches import Agreement, Akaze, Matches, agreement
from flexdepth.runtime.errors import InputError


def test_a_sheet_that_slides_is_found_again(cut):
    matches = Akaze().between(cut(), cut(right=7, down=4))
    assert len(matches) > 20
    shift = matches.target - matches.key
    assert np.mean(np.abs(shift - (-7, -4)).max(axis=1) < 0.5) > 0.9


def test_points_count_from_the_corner_of_the_picture():
    row, column = np.mgrid[:160, :200]
    spot = 200 * np.exp(-((row - 70) ** 2 + (column - 90) ** 2) / 40)
    tail = 120 * np.exp(-((row - 120) ** 2 + (column - 140) ** 2) / 30)
    picture = (spot + tail).astype(np.uint8)
    matches = Akaze(threshold=1e-4).between(picture, picture)
    # The brightest pixel is the 91st of its row: its centre lies at 90.5.
    off = np.abs(matches.key - (90.5, 70.5)).max(axis=1).min()
    assert off < 0.2


def test_frames_with_nothing_in_common_have_hardly_a_match(cut):
    assert len(Akaze().between(cut(), cut(seed=1))) < 10
    ramp = np.tile(np.arange(160, dtype=np.uint8), (120, 1))
    assert len(Akaze().between(ramp, ramp)) == 0
    with pytest.raises(InputError, match="one size"):
        Akaze().between(cut(), cut()[1:])


def test_agreement_counts_the_matches_that_end_where_the_flow_says():
    flow = np.full((20, 30, 2), (4, 0), np.float32)
    flow[0] = np.nan
    field = given(flow, (30, 20), 0.1)
    key = np.array([[5.5, 5.5], [29.9, 19.9], [10.5, 10.5], [15.5, 8.5], [3.5, 0.5]])
    # By the flow; 1.9 px off; 2.1 px off; the other way; on unknown flow, which counts for nothing.
    target = key + np.array([[4, 0], [5.9, 0], [4, 2.1], [-4, 0], [4, 0]])
    assert agreement(field, Matches(key, target)) == Agreement(4, 0.5)
    nothing = agreement(field, Matches(key[4:], target[4:]))
    assert nothing.matches == 0
    assert np.isnan(nothing.share)
