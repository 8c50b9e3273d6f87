import numpy as np
import pytest

from flexdepth.evaluation.catalogue import PROTOCOLS
from flexdepth.evaluation.protocols import Resize
from flexdepth.evaluation.resize import at_size_of_truth, resized
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError


def row(*values):
    return np.array([values], np.float32)


def test_half_pixel_centres_hold_the_border_and_weigh_by_quarters():
    # Twice as wide: new centres lie at -.25, .25, .75 and 1.25 of the old ones.
    found = resized(row(1, 5), (1, 4), Resize.BILINEAR, Space.METRIC)
    np.testing.assert_allclose(found, row(1, 2, 4, 5))


def test_corners_that_fall_together_divide_the_way_between_them_evenly():
    found = resized(row(1, 4), (1, 4), Resize.CORNERS, Space.METRIC)
    np.testing.assert_allclose(found, row(1, 2, 3, 4))


def test_disparity_is_resized_as_disparity():
    # 1 and 1/3: a quarter and three quarters on the way are 5/6 and 1/2.
    found = resized(row(1, 3), (1, 4), Resize.DISPARITY, Space.METRIC)
    np.testing.assert_allclose(found, row(1, 6 / 5, 2, 3), rtol=1e-6)
    # A map of disparity is one already.
    found = resized(row(1, 5), (1, 4), Resize.DISPARITY, Space.AFFINE_DISPARITY)
    np.testing.assert_allclose(found, row(1, 2, 4, 5))


@pytest.mark.parametrize(("how", "corners"), [(Resize.BILINEAR, False), (Resize.CORNERS, True)])
def test_bilinear_is_what_torch_calls_so(how, corners):
    torch = pytest.importorskip("torch")
    values = np.random.default_rng(0).uniform(1, 9, (24, 80)).astype(np.float32)
    wanted = torch.nn.functional.interpolate(
        torch.from_numpy(values)[None, None], (47, 155), mode="bilinear", align_corners=corners
    )[0, 0].numpy()
    np.testing.assert_allclose(resized(values, (47, 155), how, Space.METRIC), wanted, atol=1e-4)


@pytest.mark.parametrize("how", Resize)
def test_what_is_constant_stays_so(how):
    found = resized(np.full((5, 7), 3, np.float32), (11, 9), how, Space.METRIC)
    np.testing.assert_allclose(found, 3, rtol=1e-6)


@pytest.mark.parametrize("how", [Resize.BILINEAR, Resize.CORNERS, Resize.DISPARITY])
def test_the_unknown_and_the_sky_are_not_mixed_with_their_neighbours(how):
    values = row(2, 2, np.nan, np.nan, 2, 2, np.inf, np.inf)
    found = resized(np.repeat(values, 4, 0), (8, 16), how, Space.METRIC)
    assert set(found[np.isfinite(found)].round(5)) == {2.0}
    # A pixel is known where at least half of what it is made of is.
    assert np.isnan(found[:, 4:8]).all()
    assert np.isfinite(found[:, :4]).all()
    assert np.isposinf(found[:, 13:]).all()


def test_sky_of_disparity_is_minus_infinity():
    found = resized(row(2, 2, -np.inf, -np.inf), (1, 8), Resize.BILINEAR, Space.AFFINE_DISPARITY)
    assert np.isneginf(found[0, 6:]).all()


def kitti(values):
    return DepthMap(np.asarray(values, np.float32), Space.METRIC)


@pytest.mark.parametrize("name", ["kitti-eigen-garg-bts", "kitti-monodepth2-benchmark"])
def test_a_prediction_of_the_benchmark_crop_is_put_there_and_never_stretched(name):
    found = at_size_of_truth(kitti(np.full((352, 1216), 7)), (375, 1242), PROTOCOLS[name]).values
    assert (found[23:375, 13:1229] == 7).all()
    assert np.isnan(found).sum() == 375 * 1242 - 352 * 1216


def test_a_small_prediction_of_what_the_network_sees_fills_that():
    bts, whole = PROTOCOLS["kitti-eigen-garg-bts"], PROTOCOLS["kitti-improved"]
    small = kitti(np.full((176, 608), 7))
    found = at_size_of_truth(small, (375, 1242), bts).values
    np.testing.assert_array_equal(np.isfinite(found[:, 600]), np.arange(375) >= 23)
    assert np.isfinite(at_size_of_truth(small, (375, 1242), whole).values).all()


def test_a_prediction_at_the_size_of_the_truth_is_left_alone():
    prediction = kitti(np.ones((375, 1242)))
    bts = PROTOCOLS["kitti-eigen-garg-bts"]
    assert at_size_of_truth(prediction, (375, 1242), bts) is prediction


def test_a_prediction_on_its_side_is_refused():
    with pytest.raises(InputError, match="is 48x64, what it is scored against 64x48"):
        at_size_of_truth(kitti(np.ones((64, 48))), (48, 64), PROTOCOLS["metric"])
