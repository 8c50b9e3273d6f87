import pytest
import torch
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.depth import DepthBins
from flexdepth.sample import Frame, Prediction, Sample, Truth, in_metres, measured, true_depth

METRES, CANONICAL = torch.full((2, 3, 4), 10.0), torch.ones(2, 3, 4)


def two_cameras(depth: torch.Tensor) -> Sample:
    # The diagonal is 5 pixels, so the focal lengths are 0.4 and 0.8 diagonals.
    focal = torch.tensor([[2.0, 2.0], [4.0, 4.0]])
    frame = Frame(torch.zeros(2, 3, 3, 4), Camera(focal, torch.zeros(2, 2)))
    known = torch.ones(2, 3, 4, dtype=torch.bool)
    return Sample(("a", "b"), frame, Truth(depth, known, ~known))


@pytest.mark.parametrize(
    ("prediction", "expected"),
    [
        (Prediction(CANONICAL, 0.8), [20.0, 10.0]),
        (Prediction(CANONICAL, None), [10.0, 10.0]),
        (Prediction(CANONICAL, None, bins=DepthBins(9, 0.1, 4.0, unit=5.0)), [2.0, 2.0]),
        (Prediction(CANONICAL, 0.8, bins=DepthBins(9, 0.1, 4.0, unit=5.0)), [4.0, 2.0]),
    ],
)
def test_true_depth_is_what_the_prediction_means(prediction, expected):
    sample = two_cameras(METRES)
    depth, valid = true_depth(prediction, sample, "a test")
    assert valid.all()
    assert_close(depth[:, 0, 0], torch.tensor(expected))
    assert_close(in_metres(depth, prediction, sample), METRES)


def test_what_no_bin_holds_is_brought_into_the_nearest():
    bins = DepthBins(9, 0.1, 1.5, unit=10.0)
    metres = METRES.clone()
    metres[0, 0, 0], metres[0, 0, 1] = 0.5, 100.0
    depth, valid = true_depth(Prediction(CANONICAL, None, bins=bins), two_cameras(metres), "a test")
    assert valid.all()
    assert_close(depth[0, 0, :3], torch.tensor([0.1, 1.5, 1.0]))


@pytest.mark.parametrize("rubbish", [0.0, -1.0, torch.nan, torch.inf, -torch.inf])
@pytest.mark.parametrize("bins", [None, DepthBins(9, 0.1, 0.5)])
def test_rubbish_is_unknown_whatever_the_sample_says(rubbish, bins):
    metres = METRES.clone()
    metres[1, 2, 3] = rubbish
    depth, valid = true_depth(Prediction(CANONICAL, 0.8, bins=bins), two_cameras(metres), "a test")
    assert valid.sum() == 23
    assert not valid[1, 2, 3]
    assert depth[1, 2, 3] == 1


def test_a_sample_without_truth_says_who_wanted_it():
    frame = Frame(torch.zeros(3, 3, 4), Camera(torch.ones(2), torch.zeros(2)))
    with pytest.raises(ValueError, match="Silog needs measured depth"):
        measured(Sample("a", frame, None), "Silog")
