from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.data.folder import Pair
from flexdepth.data.recipes import KittiCrop, NyuCrop
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space

ROWS, COLUMNS, FOCAL = 48, 64, 30.0
CAMERA = Intrinsics(FOCAL, FOCAL, 29.0, 21.0, FocalSource.GIVEN)
ACROSS, DOWN = 0.1, 0.03

recipes = st.sampled_from([NyuCrop(), KittiCrop(skipped_rows=5)])
sizes = st.sampled_from([(48, 40), (32, 32), (48, 72), (96, 24)])


def inverse_plane(camera, columns, rows, mirror):
    """1 / z of the plane 0.3 z + 0.1 x + 0.03 y = 1, or of its mirror image."""
    row, column = np.mgrid[:rows, :columns] + 0.5
    x, y = (column - camera.centre_x) / camera.focal_x, (row - camera.centre_y) / camera.focal_y
    return 0.3 + (-ACROSS if mirror else ACROSS) * x + DOWN * y


def slanted_plane():
    """The plane, in a picture that gets redder from left to right."""
    image = np.zeros((ROWS, COLUMNS, 3), np.uint8)
    image[..., 0] = 2 * np.arange(COLUMNS)
    depth = (1 / inverse_plane(CAMERA, COLUMNS, ROWS, mirror=False)).astype(np.float32)
    return Pair("plane", image, DepthMap(depth, Space.METRIC, CAMERA))


def numbered_rows(rows, columns):
    """A pair whose depth is the number of the row, counted from 1."""
    depth = np.repeat(np.arange(1, rows + 1, dtype=np.float32)[:, None], columns, axis=1)
    camera = Intrinsics(500.0, 510.0, 300.0, 200.0, FocalSource.GIVEN)
    image = np.full((rows, columns, 3), 7, np.uint8)
    return Pair("rows", image, DepthMap(depth, Space.METRIC, camera))


def is_mirrored(pair):
    seen = np.where(pair.truth.valid, pair.image[..., 0].astype(float), np.nan)
    bottom = seen[-1][np.isfinite(seen[-1])]
    return bool(bottom[0] > bottom[-1])


@given(recipes, sizes, st.integers(0, 10**6))
def test_a_plane_stays_the_same_plane_divided_by_the_ratio(recipe, size, seed):
    out = recipe(np.random.default_rng(seed), slanted_plane(), *size)
    camera = out.truth.intrinsics
    assert out.image.shape == (*size[::-1], 3)
    ratio = min(
        recipe.ratios, key=lambda r: abs(camera.focal_x / FOCAL - size[0] / round(size[0] / r))
    )
    mirror = is_mirrored(out)
    expected = ratio * inverse_plane(camera, *size, mirror)
    error = np.abs(1 / out.truth.values - expected)[out.truth.valid]
    half_a_source_pixel = 0.5 * (ACROSS + DOWN) / FOCAL
    assert error.max() <= ratio * half_a_source_pixel + 1e-5
    assert camera.focal_x == pytest.approx(ratio * FOCAL, rel=0.03)
    assert camera.focal_y == pytest.approx(ratio * FOCAL, rel=0.03)


@given(recipes, sizes, st.integers(0, 10**6))
def test_unknown_depth_is_exactly_the_grey_that_was_added(recipe, size, seed):
    pair = numbered_rows(ROWS, COLUMNS)
    out = recipe(np.random.default_rng(seed), pair, *size)
    added = (out.image == 128).all(-1)
    seen = (out.image == 7).all(-1)
    border = ~added & ~seen  # where grey and picture meet, resizing blends them
    assert not out.truth.valid[added].any()
    assert out.truth.valid[seen].all()
    assert border.sum() <= 2 * sum(size)


@pytest.mark.parametrize("recipe", [NyuCrop(), KittiCrop()])
def test_every_ratio_and_both_hands_occur_as_often_as_the_others(recipe):
    rng, pair = np.random.default_rng(0), slanted_plane()
    draws = [recipe(rng, pair, 32, 32) for _ in range(700)]
    sides = Counter(round(32 * FOCAL / out.truth.intrinsics.focal_x) for out in draws)
    assert sides.keys() == {round(32 / ratio) for ratio in recipe.ratios}
    share = 700 / len(recipe.ratios)
    assert all(0.6 * share < count < 1.5 * share for count in sides.values())
    assert 0.4 < np.mean([is_mirrored(out) for out in draws]) < 0.6


def test_the_ratios_are_those_of_chapter_3():
    assert NyuCrop().ratios == (1.0, 0.92, 0.86, 0.8, 0.75, 0.7, 0.67)
    assert KittiCrop().ratios == (1.0, 1.1, 1.2, 1.3, 1.4, 1.5)


def test_a_short_image_is_padded_on_top_worked_by_hand():
    """At 0.75, 384 pixels show 512 rows of 480: 32 are added, which become 24."""
    pair = numbered_rows(480, 640)
    out = NyuCrop(ratios=(0.75,))(np.random.default_rng(3), pair, 384, 384)
    assert (out.image[:23] == 128).all()
    assert (out.image[25:] == 7).all()
    assert out.truth.valid.sum(0).tolist() == [360] * 384
    assert not out.truth.valid[:24].any()
    assert out.truth.values[-1, 0] in (479 / 0.75, 480 / 0.75)
    camera = out.truth.intrinsics
    assert (camera.focal_x, camera.focal_y) == pytest.approx((375.0, 382.5))
    assert camera.centre_y == pytest.approx((200 + 32) * 0.75)


def test_a_narrow_image_is_padded_on_its_left():
    out = NyuCrop(ratios=(1.0,))(np.random.default_rng(0), numbered_rows(40, 30), 36, 40)
    assert not is_mirrored(out)
    assert out.truth.valid[0].tolist() == [False] * 6 + [True] * 30
    assert out.truth.intrinsics.centre_x == 306.0


@pytest.mark.parametrize(
    ("ratio", "first_rows"),
    [(1.0, {None}), (1.1, {0}), (1.2, set(range(50, 56))), (1.5, set(range(50, 120)))],
)
def test_a_street_is_cut_below_row_50_where_there_is_room(ratio, first_rows):
    """Of 375 rows, 384 pixels show 384, 349, 320 or 256."""
    rng, pair = np.random.default_rng(1), numbered_rows(375, 520)
    found = set()
    for _ in range(400 if ratio > 1.2 else 60):
        top = KittiCrop(ratios=(ratio,))(rng, pair, 512, 384).truth.values[0, 0] * ratio
        found.add(None if np.isnan(top) else round(top) - 1)
    assert found <= first_rows
    assert {min(first_rows, key=str), max(first_rows, key=str)} <= found or ratio == 1.5
    assert len(found) > 0.9 * len(first_rows)


@given(recipes, sizes, st.integers(0, 10**6))
def test_depth_is_never_interpolated(recipe, size, seed):
    pair = numbered_rows(ROWS, COLUMNS)
    steps = np.where(pair.truth.values % 2 == 0, 1, 1000).astype(np.float32)
    pair = Pair("steps", pair.image, DepthMap(steps, Space.METRIC, pair.truth.intrinsics))
    out = recipe(np.random.default_rng(seed), pair, *size)
    known = np.unique(out.truth.values[out.truth.valid])
    assert len(known) <= 2
    assert known[-1] == pytest.approx(1000 * known[0], rel=1e-5) or len(known) == 1


def test_sky_stays_sky():
    pair = numbered_rows(ROWS, COLUMNS)
    values = np.full((ROWS, COLUMNS), np.inf, np.float32)
    pair = Pair("sky", pair.image, DepthMap(values, Space.METRIC, pair.truth.intrinsics))
    assert KittiCrop()(np.random.default_rng(0), pair, 32, 32).truth.sky.all()
