import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.data.folder import Pair
from flexdepth.data.transforms import Crop, as_sample, cropped, mirrored, resized
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space

ROWS, COLUMNS = 24, 32


def tilted_plane():
    """A plane z = 1 / (0.2 + 0.1 x/z + 0.3 y/z), so that 1/z is affine in the image."""
    camera = Intrinsics(30.0, 30.0, 15.0, 13.0, FocalSource.GIVEN)
    return Pair(
        "plane",
        np.zeros((ROWS, COLUMNS, 3), np.uint8),
        DepthMap(plane(camera, COLUMNS, ROWS), Space.METRIC, camera),
    )


def plane(camera, columns, rows):
    row, column = np.mgrid[:rows, :columns] + 0.5
    x, y = (column - camera.centre_x) / camera.focal_x, (row - camera.centre_y) / camera.focal_y
    return (1 / (0.2 + 0.1 * x + 0.03 * y)).astype(np.float32)


def assert_still_the_plane(pair, tolerance):
    rows, columns = pair.truth.values.shape
    expected = plane(pair.truth.intrinsics, columns, rows)
    assert pair.truth.values == pytest.approx(expected, rel=tolerance)


@given(st.integers(0, 20), st.integers(0, 12), st.integers(1, 12), st.integers(1, 12))
def test_cropping_moves_the_camera_with_the_image(left, top, width, height):
    assert_still_the_plane(cropped(tilted_plane(), (left, top, width, height)), 1e-6)


def test_resizing_by_a_whole_factor_moves_the_camera_with_the_image():
    half = resized(tilted_plane(), COLUMNS // 2, ROWS // 2)
    assert half.image.shape == (ROWS // 2, COLUMNS // 2, 3)
    assert_still_the_plane(half, 0.02)


def test_depth_is_never_interpolated():
    pair = tilted_plane()
    found = resized(pair, 20, 17).truth.values
    assert np.isin(found, pair.truth.values).all()


def test_a_mirrored_pair_seen_in_a_mirror_is_the_pair():
    pair = tilted_plane()
    twice = mirrored(mirrored(pair))
    assert np.array_equal(twice.truth.values, pair.truth.values)
    assert twice.truth.intrinsics == pair.truth.intrinsics


def test_mirroring_mirrors_the_camera():
    once = mirrored(tilted_plane())
    camera = once.truth.intrinsics
    assert camera.centre_x == COLUMNS - 15.0
    straight = Intrinsics(30.0, 30.0, COLUMNS - camera.centre_x, 13.0, FocalSource.GIVEN)
    assert once.truth.values[:, ::-1] == pytest.approx(plane(straight, COLUMNS, ROWS))


@given(st.integers(0, 1000), st.sampled_from([(16, 12), (16, 16), (40, 12), (12, 40)]))
def test_a_random_crop_has_the_wanted_size_and_keeps_metres(seed, size):
    pair = tilted_plane()
    out = Crop()(np.random.default_rng(seed), pair, *size)
    assert out.image.shape == (*size[::-1], 3)
    assert np.isin(out.truth.values, pair.truth.values).all()
    focal = out.truth.intrinsics.focal_in_diagonals(*size)
    assert focal >= pair.truth.intrinsics.focal_in_diagonals(COLUMNS, ROWS) * 0.93


def test_a_sample_knows_valid_from_sky_from_unknown():
    pair = tilted_plane()
    values = pair.truth.values.copy()
    values[0, :3] = np.inf, np.nan, 0.0
    sample = as_sample(Pair("x", pair.image, DepthMap(values, Space.METRIC, pair.truth.intrinsics)))
    assert sample.truth.valid[0, :4].tolist() == [False, False, False, True]
    assert sample.truth.sky[0, :4].tolist() == [True, False, False, False]
    assert sample.truth.depth.isfinite().all()
    assert (sample.truth.depth > 0).all()
    assert sample.key.camera.centre.tolist() == [15.0, 13.0]
