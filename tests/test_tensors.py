from dataclasses import replace

import pytest
import torch
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.sample import Frame, Prediction, Sample, Truth
from flexdepth.tensors import mapped, moved, stacked


def one(name: str, value: float) -> Sample:
    image = torch.full((3, 2, 4), value)
    camera = Camera(torch.tensor([value, 5.0]), torch.tensor([2.0, 1.0]))
    known = torch.ones(2, 4, dtype=torch.bool)
    return Sample(name, Frame(image, camera), Truth(image[0], known, ~known))


def test_samples_stack_to_a_batch_in_their_order():
    batch = stacked([one("a", 1.0), one("b", 2.0)])
    assert batch.name == ("a", "b")
    assert batch.key.image.shape == (2, 3, 2, 4)
    assert_close(batch.key.camera.focal, torch.tensor([[1.0, 5.0], [2.0, 5.0]]))
    assert batch.truth is not None
    assert_close(batch.truth.depth[:, 0, 0], torch.tensor([1.0, 2.0]))


def test_what_all_samples_lack_the_batch_lacks():
    assert stacked([replace(one("a", 1.0), truth=None)] * 2).truth is None


def test_samples_with_and_without_truth_make_no_batch():
    with pytest.raises(ValueError, match="of one make"):
        stacked([one("a", 1.0), replace(one("b", 1.0), truth=None)])


def test_nothing_makes_no_batch():
    with pytest.raises(ValueError, match="at least one"):
        stacked([])


def test_every_tensor_is_changed_and_nothing_else():
    record = Prediction(torch.ones(1, 1), 0.8, attention=(torch.ones(1, 2, 3), torch.ones(1, 1, 1)))
    doubled = mapped(record, lambda tensor: 2 * tensor)
    assert doubled.depth.item() == 2
    assert [a.sum().item() for a in doubled.attention] == [12, 2]
    assert doubled.sky_logit is None
    assert doubled.canonical_focal == 0.8


def test_a_sample_moves_with_its_camera_and_its_truth():
    there = moved(one("a", 1.0), "meta")
    assert there.name == "a"
    assert there.truth is not None
    for tensor in (there.key.image, there.key.camera.centre, there.truth.valid):
        assert tensor.device.type == "meta"
