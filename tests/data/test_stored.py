import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.data.stored import (
    Codes,
    StoredPair,
    StoredPairs,
    depth_from_disparity,
    gray,
    known,
    named,
    partners,
    planar,
)
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.errors import InputError

CAMERA = Intrinsics.centred(4, 3, 2.0, FocalSource.GIVEN)


def test_codes_become_metres_unknown_and_sky(tmp_path, codes):
    path = codes(tmp_path / "a.png", [[0, 100, 250], [65535, 7, 1]])
    seen = Codes(path, 100.0, unknown=(0, 7), sky=65535).values()
    nan, inf = np.nan, np.inf
    np.testing.assert_array_equal(seen, np.array([[nan, 1.0, 2.5], [inf, nan, 0.01]], np.float32))


def test_what_is_no_positive_number_is_unknown():
    seen = known(np.array([1.5, 0.0, -2.0, np.inf, np.nan]))
    assert np.isnan(seen[1:]).all()
    assert seen[0] == 1.5


def test_the_distance_of_a_wall_ahead_is_its_depth_times_the_length_of_the_ray():
    # Pixel (3, 2) of 4 x 3 has its centre at (3.5, 2.5): 0.75 right and 0.5 down for f = 2.
    distance = np.full((3, 4), 10.0, np.float32)
    assert planar(distance, CAMERA)[2, 3] == pytest.approx(10 / np.sqrt(1 + 0.75**2 + 0.5**2))


@given(st.floats(0.5, 50), st.floats(300, 900), st.floats(-40, 40))
def test_a_flat_wall_is_flat_whatever_camera_measured_its_distances(metres, focal, aside):
    camera = Intrinsics(focal, 0.9 * focal, 160 + aside, 120 - aside, FocalSource.GIVEN)
    column, row = np.meshgrid(np.arange(320) + 0.5, np.arange(240) + 0.5)
    rays = np.stack(
        [
            (column - camera.centre_x) / camera.focal_x,
            (row - camera.centre_y) / camera.focal_y,
            np.ones_like(row),
        ]
    )
    distance = np.linalg.norm(metres * rays, axis=0).astype(np.float32)
    np.testing.assert_allclose(planar(distance, camera), metres, rtol=1e-5)


def test_depth_is_focal_times_baseline_by_disparity_and_offset():
    disparity = np.array([10.0, 0.0, -30.0, np.inf, np.nan], np.float32)
    seen = depth_from_disparity(disparity, 120.0, 20.0)
    np.testing.assert_allclose(seen[:2], [4.0, 6.0])
    assert np.isnan(seen[2:]).all()
    assert np.isnan(depth_from_disparity(np.zeros(1, np.float32), 120.0)).all()


def test_files_are_found_below_a_folder_and_behind_links(tmp_path, picture):
    picture(tmp_path / "elsewhere" / "a_07.png")
    (tmp_path / "root" / "deep").mkdir(parents=True)
    (tmp_path / "root" / "deep" / "link").symlink_to(tmp_path / "elsewhere")
    found = named(tmp_path / "root", r"deep/(.+)/(\w)_\d+\.png", "deep/X/a_NN.png")
    assert list(found) == ["link/a"]
    with pytest.raises(InputError, match=r"root: looked for b\.png; there are none"):
        named(tmp_path / "root", r"b\.png", "b.png")
    with pytest.raises(InputError, match=r"nowhere: no such folder; it should hold b\.png"):
        named(tmp_path / "nowhere", r"b\.png", "b.png")


def test_partners_come_in_the_order_of_their_keys_and_a_lonely_file_is_named(tmp_path):
    a, b = (
        {"2": tmp_path / "a2", "1": tmp_path / "a1"},
        {"1": tmp_path / "b1", "2": tmp_path / "b2"},
    )
    assert [key for key, *_ in partners(a, b, "a needs a b")] == ["1", "2"]
    with pytest.raises(InputError, match="b3: has no partner; every a needs a b"):
        partners(a, {**b, "3": tmp_path / "b3"}, "a needs a b")


def test_a_pair_of_another_size_than_its_camera_or_its_depth_is_named(tmp_path, picture, codes):
    image = picture(tmp_path / "i.png", 8, 6)
    fits, narrow = (
        codes(tmp_path / "d.png", width=8, height=6),
        codes(tmp_path / "n.png", width=7, height=6),
    )
    good = StoredPairs((StoredPair("a", image, Codes(fits, 1000.0), CAMERA, (8, 6)),))
    assert len(good) == 1
    assert (good[0].truth.values == 1.0).all()
    assert good[0].truth.intrinsics == CAMERA
    with pytest.raises(InputError, match=r"n\.png: holds 7x6 values, its image .*i\.png has 8x6"):
        StoredPair("a", image, Codes(narrow, 1000.0), CAMERA).read()
    with pytest.raises(InputError, match=r"i\.png: wanted 9x6.* got 8x6"):
        StoredPair("a", image, Codes(fits, 1000.0), CAMERA, (9, 6)).read()


def test_a_picture_in_colour_or_with_16_bits_is_no_gray_map(tmp_path, picture, codes):
    path = tmp_path / "g.png"
    cv2.imwrite(str(path), np.arange(6, dtype=np.uint8).reshape(2, 3))
    assert gray(path).tolist() == [[0, 1, 2], [3, 4, 5]]
    for other in (picture(tmp_path / "c.png"), codes(tmp_path / "s.png")):
        with pytest.raises(InputError, match="cannot be read as a gray picture of 8 bits"):
            gray(other)
