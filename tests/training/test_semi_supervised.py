from dataclasses import replace

import numpy as np
import pytest
import torch
from PIL import Image
from torch import nn

from flexdepth.data.folder import Folder
from flexdepth.data.transforms import as_sample
from flexdepth.losses import Silog
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction
from flexdepth.training.semi_supervised import (
    Agreement,
    Joined,
    label,
    unlabelled_photos,
    write_labels,
)


class RedIsDepth(nn.Module):
    """Ten times the red channel is depth, whatever lies around a pixel; blue is sky."""

    def forward(self, image):
        red, _, blue = image.unbind(1)
        return Prediction(1 + 10 * red, canonical_focal=None, sky_logit=blue - 0.5)


class LeftIsNearer(nn.Module):
    """Sees the left half of whatever it is shown at half its depth."""

    def forward(self, image):
        depth = 1 + 10 * image[:, 0]
        left = torch.arange(image.shape[-1]) < image.shape[-1] // 2
        return Prediction(torch.where(left, depth / 2, depth), canonical_focal=None)


class SizeIsDepth(nn.Module):
    """Sees smaller images farther away: 3 m at 64 pixels, 4 m at 48."""

    def forward(self, image):
        rows, columns = image.shape[-2:]
        return Prediction(torch.full((1, rows, columns), 192 / columns), canonical_focal=None)


SMALL = Agreement(ratio=1.1, smaller=0.5, area=64 * 64, multiple=32)


def plain(level, width=64, height=64):
    return torch.full((3, height, width), float(level)) * torch.tensor([1.0, 0, 0])[:, None, None]


def test_a_teacher_that_always_says_the_same_is_sure_everywhere():
    said = label(RedIsDepth(), plain(0.2), SMALL)
    assert said.sure.all()
    assert not said.sky.any()
    assert torch.allclose(said.depth, torch.tensor(3.0))


def test_where_the_mirror_says_otherwise_nothing_is_sure():
    """A teacher with a bad left side contradicts itself at every pixel by a factor of two."""
    alone = replace(SMALL, smaller=1.0)
    assert not label(LeftIsNearer(), plain(0.2), alone).sure.any()
    tolerant = label(LeftIsNearer(), plain(0.2), replace(alone, ratio=2.01))
    assert tolerant.sure.all()
    assert torch.allclose(tolerant.depth, torch.tensor(3 / 2**0.5))


def test_where_the_smaller_look_says_otherwise_nothing_is_sure():
    """6 m at half the size for 3 m: a factor of two."""
    assert not label(SizeIsDepth(), plain(0.2), replace(SMALL, ratio=1.99)).sure.any()
    assert label(SizeIsDepth(), plain(0.2), replace(SMALL, ratio=2.01)).sure.all()
    assert label(SizeIsDepth(), plain(0.2), replace(SMALL, smaller=1.0)).sure.all()


def test_sky_is_what_every_look_sees_as_sky():
    image = plain(0.2)
    image[2, :32] = 1.0
    said = label(RedIsDepth(), image, SMALL)
    assert said.sky[:30].all()
    assert not said.sky[34:].any()
    assert said.sure[34:].all()
    assert not said.sure[:30].any()


def half_and_half(path):
    """A photo whose left half is near, beside one that is uniform."""
    pixels = np.zeros((64, 64, 3), np.uint8)
    pixels[:, :32, 0], pixels[:, 32:, 0] = 25, 51
    Image.fromarray(pixels).save(path)


class UnsureOnTheRight(nn.Module):
    """Sure where red is dark; where it is bright, each look multiplies depth by two."""

    def __init__(self):
        super().__init__()
        self.looks = 0

    def forward(self, image):
        self.looks += 1
        red = image[:, 0]
        depth = torch.where(red > 0.15, 3.0 * 2**self.looks, 2.0)
        return Prediction(depth, canonical_focal=None)


@pytest.fixture
def labelled(tmp_path):
    """One photo, labelled by a teacher that is sure of 2 m on the left and of nothing right.

    In 31 of 64 columns: the smaller look blurs the one beside the edge.
    """
    photos = tmp_path / "photos"
    photos.mkdir()
    half_and_half(photos / "a.png")
    said = []
    write_labels(
        UnsureOnTheRight(), unlabelled_photos(photos), tmp_path / "labels", SMALL, said.append
    )
    return Folder(tmp_path / "labels").load(), said


def test_what_the_teacher_is_not_sure_of_has_no_label(labelled):
    pairs, said = labelled
    values = pairs[0].truth.values
    assert np.allclose(values[:, :28], 2.0)
    assert np.isnan(values[:, 36:]).all()
    assert said == ["1 of 1 photos labelled, at 48% of their pixels"]


def test_what_has_no_label_touches_no_gradient(labelled):
    sample = as_sample(labelled[0][0])
    batch = replace(
        sample,
        truth=replace(
            sample.truth,
            **{name: getattr(sample.truth, name)[None] for name in ("depth", "valid", "sky")},
        ),
    )
    depth = torch.full((1, 64, 64), 5.0, requires_grad=True)
    Silog(0.5)(Prediction(depth, canonical_focal=None), batch).sum().backward()
    assert (depth.grad[..., 36:] == 0).all()
    assert (depth.grad[..., :28] != 0).all()


def test_the_student_sees_measured_and_labelled_pairs(labelled):
    pairs, _ = labelled
    measured = replace(pairs[0], name="measured")
    both = Joined([measured], pairs)
    assert [both[number].name for number in range(len(both))] == ["measured", "a"]


def test_a_teacher_that_is_sure_of_nothing_is_refused(tmp_path):
    half_and_half(tmp_path / "a.png")
    with pytest.raises(InputError, match="sure of nothing in 1 photos: allow a larger --agreement"):
        write_labels(SizeIsDepth(), [tmp_path / "a.png"], tmp_path / "labels", SMALL, print)


def test_a_folder_without_photos_is_refused(tmp_path):
    with pytest.raises(InputError, match="holds no photo"):
        unlabelled_photos(tmp_path)
    with pytest.raises(InputError, match="no such folder of photos"):
        unlabelled_photos(tmp_path / "nowhere")


@pytest.mark.parametrize("odd", [{"ratio": 1.0}, {"smaller": 0.0}, {"area": 100}])
def test_an_agreement_that_nothing_reaches_is_refused(odd):
    with pytest.raises(InputError, match="agreement needs ratio > 1"):
        Agreement(**odd)
