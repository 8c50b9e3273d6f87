import numpy as np
import pytest

from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.scenes import prior
from flexdepth.scenes.prior import SPREAD, as_prior, single_image_depth

PICTURE = np.full((60, 80, 3), 120, np.uint8)


def camera(source):
    return Intrinsics(70.0, 70.0, 40.0, 30.0, source)


def test_a_focal_length_that_nobody_knows_gives_no_metres(make_bundle):
    file = make_bundle()
    for source, space in ((FocalSource.GIVEN, Space.METRIC), (FocalSource.ASSUMED, Space.SCALE)):
        depth, notes = single_image_depth(file, PICTURE, camera(source))
        assert depth.space is space
        assert as_prior(depth).metric is (space is Space.METRIC)
        assert notes == ()


def test_the_camera_as_it_is_known_is_the_models(make_bundle):
    depth, _ = single_image_depth(make_bundle(), PICTURE, camera(FocalSource.EXIF))
    # tiny: (1 + 120 / 255) metres at the canonical focal length of half a diagonal.
    np.testing.assert_allclose(depth.depth, (1 + 120 / 255) * 70 / 100 / 0.5, rtol=1e-4)


def test_what_the_licence_forbids_is_said(make_bundle):
    file = make_bundle(licence="CC-BY-NC-4.0")
    _, (said,) = single_image_depth(file, PICTURE, camera(FocalSource.GIVEN))
    assert "forbids commercial use" in said


def test_depth_with_an_unknown_offset_is_refused(monkeypatch):
    affine = DepthMap(np.ones((60, 80), np.float32), Space.AFFINE_DISPARITY)

    class Seer:
        def predict(self, _):
            return affine

    monkeypatch.setattr(prior, "named_estimator", lambda *_: Seer())
    with pytest.raises(InputError, match="--prior x gives affine_disparity"):
        single_image_depth("x", PICTURE, camera(FocalSource.GIVEN))


def test_the_models_own_spread_is_believed_within_reason():
    spread = np.array([[0.3, 0.001, np.nan]], np.float32)
    depth = DepthMap(np.ones((1, 3), np.float32), Space.METRIC, spread=spread)
    np.testing.assert_allclose(as_prior(depth).spread, [[0.3, 0.02, SPREAD]])
    plain = DepthMap(np.ones((1, 3), np.float32), Space.METRIC)
    np.testing.assert_allclose(as_prior(plain).spread, SPREAD)
