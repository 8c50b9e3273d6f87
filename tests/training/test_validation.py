from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import nn

from flexdepth.data.folder import Pair
from flexdepth.evaluation.alignment import Alignment
from flexdepth.geometry.depth import DepthBins
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction
from flexdepth.training.processes import Place
from flexdepth.training.validation import pictures, validate

BINS = DepthBins(150, 0.01, 1.7, unit=10.0)


class RedIsDepth(nn.Module):
    """A tenth of the red channel, 0 to 255, is depth in metres; it is given in units of BINS."""

    def forward(self, image):
        return Prediction(image[:, 0] * 25.5 / BINS.unit, canonical_focal=None, bins=BINS)


def red_pair(metres, truth):
    metres = np.asarray(metres, float)
    height, width = metres.shape
    image = np.zeros((height, width, 3), np.uint8)
    image[..., 0] = np.round(10 * metres)
    camera = Intrinsics.centred(width, height, 60.0, FocalSource.GIVEN)
    depth = DepthMap(np.asarray(truth, np.float32), Space.METRIC, camera)
    return Pair("a", image, depth)


def test_metres_are_scored_as_they_stand_over_what_is_known():
    """Of 1, 2, 3 and 4 m for 2, 2, unknown and 5 m: (1/2 + 0 + 1/5) / 3."""
    pairs = [red_pair([[1, 2], [3, 4]], [[2, 2], [np.nan, 5]])]
    assert validate(RedIsDepth(), pairs, Alignment.NONE)["abs_rel"] == pytest.approx(
        0.7 / 3, rel=1e-5
    )


def test_every_metric_of_chapter_3_is_told():
    """1 and 4 m for 2 and 4: ln 2 at one of two pixels, off by 1 m and by half."""
    scores = validate(RedIsDepth(), [red_pair([[1, 4]], [[2, 4]])], Alignment.NONE)
    assert scores == pytest.approx(
        {
            "abs_rel": 0.25,
            "sq_rel": 0.25,
            "log10": 0.150515,
            "rmse": 0.707107,
            "rmse_log": 0.490129,
            "delta1": 0.5,
            "delta2": 0.5,
            "delta3": 0.5,
        },
        rel=1e-5,
    )


@pytest.mark.parametrize("unknown", [np.nan, np.inf, 0.0, -1.0, 80.0, 100.0])
def test_what_is_unknown_or_beyond_80_metres_is_not_scored(unknown):
    pairs = [red_pair([[1, 2], [3, 4]], [[1.25, 2], [unknown, unknown]])]
    assert validate(RedIsDepth(), pairs, Alignment.NONE)["abs_rel"] == pytest.approx(0.1, rel=1e-5)


def test_images_of_several_sizes_count_alike_and_those_without_truth_not_at_all():
    """0.5 and 0.1; sizes as KITTI has them, and an image whose scan was lost."""
    pairs = [
        red_pair(np.full((3, 7), 1.0), np.full((3, 7), 2.0)),
        red_pair(np.full((2, 6), 9.0), np.full((2, 6), 10.0)),
        red_pair(np.full((4, 5), 9.0), np.full((4, 5), np.nan)),
    ]
    assert validate(RedIsDepth(), pairs, Alignment.NONE)["abs_rel"] == pytest.approx(0.3, rel=1e-5)


def test_a_fit_forgives_what_it_fits():
    pairs = [red_pair([[1, 2], [3, 6]], [[2, 4], [6, 12]])]
    assert validate(RedIsDepth(), pairs, Alignment.NONE)["abs_rel"] == pytest.approx(0.5, rel=1e-5)
    for alignment in (Alignment.MEDIAN, Alignment.LEAST_SQUARES_DISPARITY):
        assert validate(RedIsDepth(), pairs, alignment)["abs_rel"] == pytest.approx(0.0, abs=1e-6)


def test_canonical_depth_is_scored_in_metres_for_the_camera_that_took_the_image():
    """60 pixels are 12 diagonals of a 4 x 3 image; canonical are 6: everything is twice as far."""

    class Canonical(nn.Module):
        def forward(self, image):
            return replace(RedIsDepth()(image), canonical_focal=6.0)

    pairs = [red_pair(np.full((3, 4), 2.0), np.full((3, 4), 4.0))]
    assert validate(Canonical(), pairs, Alignment.NONE)["abs_rel"] == pytest.approx(0.0, abs=1e-5)


def test_nothing_to_be_judged_by_is_refused():
    pairs = [red_pair(np.ones((2, 2)), np.full((2, 2), np.nan))] * 2
    with pytest.raises(InputError, match="none of the 2 held-out images has known depth"):
        validate(RedIsDepth(), pairs, Alignment.NONE)


def test_the_network_is_left_in_evaluation_mode_and_without_gradients():
    network = nn.Sequential(nn.BatchNorm2d(3), RedIsDepth()).train()
    before = network[0].running_mean.clone()
    validate(network, [red_pair(np.ones((2, 2)), np.ones((2, 2)))], Alignment.NONE)
    assert not network.training
    assert torch.equal(network[0].running_mean, before)


class SeesSizes(nn.Module):
    def __init__(self):
        super().__init__()
        self.seen = []

    def forward(self, image):
        self.seen.append(tuple(image.shape[-2:]))
        return RedIsDepth()(image)


def test_networks_that_halve_sizes_are_shown_sides_that_can_be_halved():
    network, metres = SeesSizes(), np.linspace(1, 9, 40)[None] * np.ones((33, 1))
    pairs = [red_pair(metres, np.round(10 * metres) / 10)]
    assert validate(network, pairs, Alignment.NONE)["abs_rel"] == pytest.approx(0.0, abs=1e-6)
    assert network.seen == [(64, 64)]


def test_large_images_are_judged_at_a_size_that_fits_the_memory():
    network, metres = SeesSizes(), np.full((1500, 1600), 2.0)
    assert validate(network, [red_pair(metres, metres)], Alignment.NONE)[
        "abs_rel"
    ] == pytest.approx(0.0)
    ((rows, columns),) = network.seen
    assert 0.9 < rows * columns / (1024 * 512) < 1.1
    assert columns / rows == pytest.approx(16 / 15, rel=0.05)


def test_processes_judge_by_different_images(monkeypatch):
    metres = [np.full((2, 2), depth) for depth in (1.0, 2.0, 4.0)]
    pairs = [red_pair(depth, np.full((2, 2), 4.0)) for depth in metres]
    shares = []

    def summed(_place, numbers):
        shares.append(numbers)
        return [1.0] * len(numbers)

    monkeypatch.setattr(Place, "summed", summed)
    for rank in (0, 1):
        validate(RedIsDepth(), pairs, Alignment.NONE, Place(rank, 2))
    errors = [(share[0], share[-1]) for share in shares]
    assert errors == [pytest.approx([0.75, 2]), pytest.approx([0.5, 1])]


def test_pictures_show_truth_and_prediction_in_the_same_colours():
    """The truth of the picture in the middle is twice as far on the right half."""
    seen = np.round(np.linspace(10, 90, 40)) / 10 * np.ones((33, 1))
    pairs = [replace(red_pair(seen, seen), name=str(number)) for number in range(7)]
    farther = np.where(np.arange(40) < 20, seen, 2 * seen)
    pairs[2] = replace(red_pair(seen, farther), name="2")
    shown = pictures(RedIsDepth(), pairs)
    assert list(shown) == ["0", "2", "4"]
    for name, pixels in shown.items():
        image, truth, prediction = (pixels[-33:, left : left + 40] for left in (0, 45, 90))
        assert (image[..., 1:] == 0).all()
        assert (truth[:, :20] == prediction[:, :20]).all()
        assert (truth[:, 20:] == prediction[:, 20:]).all() == (name != "2")


def test_an_image_without_any_depth_has_a_picture_all_the_same():
    pairs = [red_pair(np.ones((4, 4)), np.full((4, 4), np.nan))]
    assert list(pictures(RedIsDepth(), pairs)) == ["a"]
