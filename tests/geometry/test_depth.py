from math import log10, sqrt

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.testing import assert_close

from flexdepth.geometry.depth import (
    KITTI_BINS,
    NYU_BINS,
    DepthBins,
    canonical_from_metres,
    metres_from_canonical,
)
from flexdepth.runtime.errors import InputError

DOUBLE = torch.zeros((), dtype=torch.float64)


def test_through_twice_the_focal_length_a_thing_looks_half_as_far():
    metres = torch.full((2, 1, 1), 6.0)
    focal = torch.tensor([0.8, 1.6])
    assert_close(canonical_from_metres(metres, focal, 0.8).flatten(), torch.tensor([6.0, 3.0]))


@given(st.floats(0.1, 100), st.floats(0.2, 3), st.floats(0.2, 3))
def test_metres_come_back_from_canonical_depth(depth, focal, canonical):
    metres = torch.full((3, 1, 2, 2), depth, dtype=torch.float64)
    focals = torch.full((3, 1), focal, dtype=torch.float64)
    there = canonical_from_metres(metres, focals, canonical)
    assert_close(metres_from_canonical(there, focals, canonical), metres)


def test_three_bins_of_a_decade_each_worked_by_hand():
    bins = DepthBins(3, 0.01, 10.0)
    assert bins.width == pytest.approx(1)
    assert_close(bins.centres(DOUBLE), DOUBLE.new_tensor([-1.5, -0.5, 0.5]))
    labels, valid = bins.labels(torch.tensor([0.05, 0.5, 5.0, 1e-3, 1e3]))
    assert labels.tolist() == [0, 1, 2, 0, 2]
    assert valid.all()


@pytest.mark.parametrize("nothing", [0.0, -0.0, -1.0, torch.nan, torch.inf, -torch.inf])
def test_what_was_not_measured_is_in_no_bin(nothing):
    labels, valid = NYU_BINS.labels(torch.tensor([nothing, 1.0]))
    assert valid.tolist() == [False, True]
    assert labels.tolist() == [0, 134]


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_bins_of_known_depths(dtype):
    indoors, _ = NYU_BINS.labels(torch.tensor([0.1, 0.25, 1.0, 1.7, 0.01], dtype=dtype))
    assert indoors.tolist() == [67, 94, 134, 149, 0]
    roads, _ = KITTI_BINS.labels(torch.tensor([0.1, 0.5, 1.0], dtype=dtype))
    assert roads.tolist() == [45, 83, 99]


@pytest.mark.parametrize(
    ("bins", "width", "first", "last", "uniform"),
    [
        (NYU_BINS, 0.0148696595, 0.101727, 16.711448, 1.30384),
        (KITTI_BINS, 0.0182390874, 1.225465, 78.337633, 9.79796),
    ],
)
def test_the_bins_of_both_data_sets_in_metres(bins, width, first, last, uniform):
    assert bins.width == pytest.approx(width, abs=5e-11)
    ends = 10 ** bins.centres(DOUBLE)[[0, -1]] * bins.unit
    assert_close(ends, DOUBLE.new_tensor([first, last]), rtol=0, atol=5e-7)
    decoded = bins.depth(torch.zeros(bins.count, 1, 1, dtype=torch.float64)) * bins.unit
    assert decoded.item() == pytest.approx(uniform, abs=5e-6)
    assert decoded.item() == pytest.approx(sqrt(bins.nearest * bins.farthest) * bins.unit)


def test_a_certain_bin_is_decoded_to_its_centre_and_labelled_as_itself():
    logits = torch.full((150, 1, 150), -1e4, dtype=torch.float64)
    logits[:, 0] += 2e4 * torch.eye(150, dtype=torch.float64)
    depth = NYU_BINS.depth(logits)
    assert_close(depth[0], 10 ** NYU_BINS.centres(DOUBLE))
    labels, _ = NYU_BINS.labels(depth)
    assert labels[0].tolist() == list(range(150))


def test_two_equally_likely_bins_are_decoded_to_their_geometric_mean():
    bins = DepthBins(2, 0.1, 10.0)
    logits = torch.tensor([[0.0, 100.0], [0.0, -100.0]], dtype=torch.float64)[:, None]
    # Centres 10^-0.5 and 10^0.5.
    assert_close(bins.depth(logits)[0].log10(), DOUBLE.new_tensor([0.0, -0.5]))


def test_half_precision_logits_keep_the_bins_apart():
    logits = torch.linspace(-3, 3, 150)[None, :, None, None].bfloat16()
    depth = NYU_BINS.depth(logits)
    assert depth.dtype == torch.float32
    assert_close(depth.double(), NYU_BINS.depth(logits.double()), rtol=1e-5, atol=0)


@given(st.floats(1e-4, 0.5), st.floats(1.01, 1e4), st.integers(1, 300), st.floats(0.001, 0.999))
def test_a_depth_lies_in_the_bin_of_its_label(nearest, ratio, count, place):
    bins = DepthBins(count, nearest, nearest * ratio)
    depth = DOUBLE.new_tensor([nearest * ratio**place])
    labels, _ = bins.labels(depth)
    above = (depth.log10() - log10(nearest)) / bins.width
    assert abs(above - labels - 0.5).item() <= 0.5 + 1e-6


@pytest.mark.parametrize(
    "wrong", [{"count": 0}, {"nearest": 0.0}, {"nearest": 2.0}, {"unit": 0.0}, {"farthest": -1.0}]
)
def test_impossible_bins_are_refused(wrong):
    with pytest.raises(InputError, match="depth bins need"):
        DepthBins(**wrong)
