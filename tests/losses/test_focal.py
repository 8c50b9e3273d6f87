"""The loss of a focal length is the logarithm of the ratio, either way."""

import math

import pytest
import torch
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.losses.focal import Focal
from flexdepth.sample import Frame, Prediction, Sample

# Images of 4 x 3 pixels have a diagonal of 5: cameras of 5 and 10 pixels have 1 and 2 diagonals.
CAMERA = Camera(torch.tensor([[5.0, 5.0], [10.0, 10.0]]), torch.tensor([[2.0, 1.5], [2.0, 1.5]]))
SAMPLE = Sample(("a", "b"), Frame(torch.zeros(2, 3, 3, 4), CAMERA), None)


def test_twice_and_half_are_as_far_off():
    said = Prediction(torch.ones(2, 3, 4), None, focal=torch.tensor([2.0, 1.0]))
    assert_close(Focal()(said, SAMPLE), torch.full((2,), math.log(2)))


def test_what_is_right_has_no_loss():
    said = Prediction(torch.ones(2, 3, 4), None, focal=torch.tensor([1.0, 2.0]))
    assert_close(Focal()(said, SAMPLE), torch.zeros(2))


def test_a_network_without_a_focal_length_is_told():
    with pytest.raises(ValueError, match="no such head"):
        Focal()(Prediction(torch.ones(2, 3, 4), None), SAMPLE)
