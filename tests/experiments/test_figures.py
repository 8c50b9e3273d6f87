import numpy as np
import pytest
import torch
from PIL import Image
from torch import nn

from flexdepth.experiments.figures import (
    Look,
    attention_figure,
    edges_figure,
    look,
    strongest,
    truth_beside,
)
from flexdepth.experiments.plots import enough, write_emphasis, write_explained
from flexdepth.networks.depth_basis import Basis, DepthBasis
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth
from flexdepth.runtime.images import read_photo
from flexdepth.sample import Prediction


class TwoMerges(nn.Module):
    """Canonical depth of 4, sky on top, and attention that is strong in the coarse map."""

    def forward(self, image):
        _, _, rows, columns = image.shape
        sky = torch.full((1, rows, columns), -1.0)
        sky[:, : rows // 4] = 1.0
        maps = (torch.full((1, 1, 2, 3), 0.75), torch.full((1, 1, 4, 6), 0.25))
        return Prediction(torch.full((1, rows, columns), 4.0), 0.8, sky, maps)


def saved(folder, width=400, height=300):
    (folder / "image").mkdir()
    path = folder / "image" / "a.png"
    Image.new("RGB", (width, height), (90, 60, 30)).save(path)
    return path


def test_a_photo_without_a_camera_has_depth_up_to_a_factor(tmp_path):
    seen = look(TwoMerges(), saved(tmp_path), None)
    assert seen.depth.space is Space.SCALE
    assert seen.depth.values.shape == (300, 400) == seen.photo.shape[:2]
    assert np.isinf(seen.depth.values[:60]).all()
    assert np.isfinite(seen.depth.values[90:]).all()
    assert [each.shape for each in seen.attention] == [(2, 3), (4, 6)]


def test_a_photo_whose_truth_has_a_camera_has_metres(tmp_path):
    """A focal length of 400 pixels is .8 of the diagonal of 400 x 300: 4 m are 4 m."""
    photo = saved(tmp_path)
    camera = Intrinsics.centred(400, 300, 400.0, FocalSource.GIVEN)
    depth = DepthMap(np.full((300, 400), 2.0, np.float32), Space.METRIC, camera)
    write_depth(tmp_path / "depth" / "a.npz", depth)
    seen = look(TwoMerges(), photo, truth_beside(photo, None))
    assert seen.depth.space is Space.METRIC
    assert seen.depth.values[200, 200] == pytest.approx(4.0)
    assert seen.truth.values[0, 0] == 2.0


def test_the_truth_lies_where_data_folders_have_it_or_where_it_is_said_to(tmp_path):
    photo = saved(tmp_path)
    assert truth_beside(photo, None) is None
    depth = DepthMap(np.ones((3, 4), np.float32), Space.METRIC)
    write_depth(tmp_path / "elsewhere" / "a.npz", depth)
    assert truth_beside(photo, tmp_path / "elsewhere") == tmp_path / "elsewhere" / "a.npz"
    assert truth_beside(tmp_path / "photos" / "a.png", None) is None


def test_the_strongest_map_has_the_largest_mean():
    low, high = np.full((4, 6), 0.25, np.float32), np.full((2, 3), 0.75, np.float32)
    assert strongest([high, low]) == 0
    assert strongest([low, high]) == 1
    assert strongest([low, low]) == 1
    with pytest.raises(InputError, match="no map of spatial attention"):
        strongest([])


def test_a_bright_place_of_the_figure_is_where_attention_is_strong():
    photo = np.zeros((300, 400, 3), np.uint8)
    attention = np.zeros((30, 40), np.float32)
    attention[:, 20:] = 1.0
    depth = DepthMap(np.ones((300, 400), np.float32), Space.SCALE)
    pixels = attention_figure(Look(photo, depth, (attention,), None), 0).astype(int)
    across = pixels.shape[1] // 3
    row = pixels[150]
    assert row[across + 300].sum() > row[across + 80].sum() + 200


def test_photo_attention_prediction_and_truth_stand_side_by_side():
    photo = np.zeros((300, 400, 3), np.uint8)
    depth = DepthMap(np.linspace(1, 5, 300 * 400, dtype=np.float32).reshape(300, 400), Space.METRIC)
    three = attention_figure(Look(photo, depth, (np.ones((3, 4), np.float32),), None), 0)
    four = attention_figure(Look(photo, depth, (np.ones((3, 4), np.float32),), depth), 0)
    assert 3 * 400 <= three.shape[1] < 3 * 430
    assert 4 * 400 <= four.shape[1] < 4 * 430


def test_edges_of_colour_are_the_photos_and_edges_of_things_both():
    """A step of colour at column 100, of depth at column 300."""
    photo = np.zeros((300, 400, 3), np.uint8)
    photo[:, 100:] = 200
    values = np.ones((300, 400), np.float32)
    values[:, 300:] = 4.0
    values[:50] = np.nan
    pixels = edges_figure(photo, DepthMap(values, Space.METRIC), "true depth").astype(int)
    row = pixels[-100].sum(1)
    right = pixels.shape[1] - 400
    assert row[95:105].max() > 700
    assert row[295:305].max() == 0
    assert row[right + 95 : right + 105].max() == 0
    assert row[right + 295 : right + 305].max() > 700


def test_curves_are_written_in_the_format_that_is_named(tmp_path):
    write_emphasis(tmp_path / "a.png")
    assert read_photo(tmp_path / "a.png").pixels.shape[1] > 300
    write_emphasis(tmp_path / "a.svg")
    assert "<svg" in (tmp_path / "a.svg").read_text()


def basis():
    """Of variances 6, 3, 1 and 0, of which three components are kept."""
    components = torch.eye(4)[:3].reshape(3, 2, 2)
    return DepthBasis(torch.ones(2, 2), components, torch.tensor([6.0, 3.0, 1.0, 0.0]), 9)


def test_so_many_components_are_enough_for_a_share():
    """.6, .9 and 1.0 of the variance."""
    assert enough(basis(), 0.5) == 1
    assert enough(basis(), 0.8) == 2
    assert enough(basis(), 0.95) == 3
    part = DepthBasis(basis().mean, basis().components[:1], basis().variances, 9)
    assert enough(part, 0.95) is None


@pytest.mark.parametrize("scale", ["depth", "log"])
def test_what_components_explain_is_drawn(tmp_path, scale):
    write_explained(tmp_path / "pca.png", basis(), Basis(2, 2, 3, scale))
    assert read_photo(tmp_path / "pca.png").pixels.shape[1] > 600
