import pytest
import torch
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.sample import Frame, Sample, Truth, canonical_truth, measured


def test_true_depth_is_seen_through_each_image_s_own_camera():
    focal = torch.tensor([[2.0, 2.0], [4.0, 4.0]])
    frame = Frame(torch.zeros(2, 3, 3, 4), Camera(focal, torch.zeros(2, 2)))
    known = torch.ones(2, 3, 4, dtype=torch.bool)
    truth = Truth(torch.full((2, 3, 4), 10.0), known, ~known)
    depth = canonical_truth(Sample(("a", "b"), frame, truth), truth, canonical_focal=0.8)
    # The diagonal is 5 pixels, so the focal lengths are 0.4 and 0.8 diagonals.
    assert_close(depth[:, 0, 0], torch.tensor([20.0, 10.0]))


def test_a_sample_without_truth_says_who_wanted_it():
    frame = Frame(torch.zeros(3, 3, 4), Camera(torch.ones(2), torch.zeros(2)))
    with pytest.raises(ValueError, match="Silog needs measured depth"):
        measured(Sample("a", frame, None), "Silog")
