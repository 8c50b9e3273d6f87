import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.surface import flying, inverse_depth, normals, normals_picture, rays, steps

CAMERA = Intrinsics(50.0, 40.0, 30.0, 20.0, FocalSource.GIVEN)
PIXELS = np.arange(40)[:, None], np.arange(60)[None, :]


def metric(depth, camera=CAMERA):
    return DepthMap(np.asarray(depth, np.float32), Space.METRIC, camera)


def plane(normal, distance):
    """Depth of the plane n·X = −distance, whose normal points towards the camera."""
    along = rays(*PIXELS, CAMERA) @ np.asarray(normal, np.float32)
    facing = along < 0
    return np.where(facing, -distance / np.where(facing, along, -1), np.nan).astype(np.float32)


def row(*values):
    """A map whose forty rows are all the same."""
    return np.tile(np.asarray(values, np.float32), (40, 1))


def test_the_ray_of_a_pixel_goes_through_its_centre():
    ray = rays(np.array([[19]]), np.array([[79]]), CAMERA)
    np.testing.assert_allclose(ray[0, 0], [(79.5 - 30) / 50, (19.5 - 20) / 40, 1], atol=1e-6)


def test_a_wall_that_faces_the_camera_has_a_normal_straight_back():
    found = normals(metric(np.full((40, 60), 3.0)))
    np.testing.assert_allclose(found, np.broadcast_to([0, 0, -1], found.shape), atol=1e-6)


def test_a_floor_one_metre_below_has_a_normal_straight_up():
    depth = np.full((40, 60), np.nan, np.float32)
    depth[25:] = (40.0 / (np.arange(25, 40) + 0.5 - 20))[:, None]
    found = normals(metric(depth))
    assert np.isnan(found[:25]).all()
    np.testing.assert_allclose(found[25:], np.broadcast_to([0, -1, 0], (15, 60, 3)), atol=1e-4)


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.1, 100.0))
def test_every_plane_keeps_its_own_normal(x, y, distance):
    normal = np.array([x, y, -1.5]) / np.linalg.norm([x, y, -1.5])
    depth = plane(normal, distance)
    found = normals(metric(depth))
    assert np.array_equal(np.isnan(found).any(-1), np.isnan(depth))
    seen = ~np.isnan(depth)
    # Inverse depth carries 1e-7 of itself, a slope some 50 pixels of focal length times that.
    np.testing.assert_allclose(found[seen], np.tile(normal, (seen.sum(), 1)), atol=2e-4)


def test_at_a_step_each_surface_keeps_its_own_normal():
    near, far = plane([0.6, 0.0, -0.8], 1.0), plane([0.0, -0.6, -0.8], 5.0)
    left = np.arange(60)[None, :] < 30
    found = normals(metric(np.where(left, near, far)))
    np.testing.assert_allclose(found[:, :30], np.tile([0.6, 0, -0.8], (40, 30, 1)), atol=1e-3)
    np.testing.assert_allclose(found[:, 30:], np.tile([0, -0.6, -0.8], (40, 30, 1)), atol=1e-3)


def test_sky_and_the_unknown_have_no_normal_and_spoil_no_neighbour():
    depth = np.full((40, 60), 3.0, np.float32)
    depth[:10], depth[20, 30], depth[25, 30] = np.inf, np.nan, -1
    found = normals(metric(depth))
    unknown = ~np.isfinite(depth) | (depth < 0)
    assert np.isnan(found[unknown]).all()
    np.testing.assert_allclose(found[~unknown], np.tile([0, 0, -1], ((~unknown).sum(), 1)))


def test_a_large_map_worked_in_bands_has_the_normals_of_one_plane():
    camera = Intrinsics.centred(1100, 1100, 880.0, FocalSource.GIVEN)
    v = (np.arange(1100) + 0.5 - 550) / 880
    depth = np.broadcast_to((2 / (0.8 - 0.6 * v))[:, None], (1100, 1100))
    found = normals(metric(depth, camera))
    np.testing.assert_allclose(found, np.broadcast_to([0, 0.6, -0.8], found.shape), atol=1e-3)


def test_a_single_pixel_has_no_normal():
    assert np.isnan(normals(metric([[2.0]]))).all()


@pytest.mark.parametrize("space", [Space.AFFINE_DEPTH, Space.AFFINE_DISPARITY])
def test_normals_are_refused_where_an_offset_is_unknown(space):
    with pytest.raises(InputError, match=str(space)):
        normals(DepthMap(np.ones((4, 4), np.float32), space, CAMERA))


def test_normals_are_refused_without_a_camera():
    with pytest.raises(InputError, match="intrinsics"):
        normals(metric(np.ones((4, 4)), None))


def test_the_picture_of_normals_is_red_right_green_up_and_blue_towards_the_camera():
    unit = np.array([[[0, 0, -1], [1, 0, 0], [0, -1, 0], [np.nan] * 3]], np.float32)
    expected = [[[128, 128, 255], [255, 128, 128], [128, 255, 128], [0, 0, 0]]]
    np.testing.assert_array_equal(normals_picture(unit), expected)


def test_a_clean_step_has_no_flying_pixels():
    assert not flying(row(*[2.0] * 30, *[6.0] * 30)).any()


@pytest.mark.parametrize("between", [[3.0], [2.5, 4.0]])
def test_the_pixels_between_two_surfaces_fly_and_no_others(between):
    depth = row(*[2.0] * 20, *between, *[6.0] * 20)
    expected = np.zeros(depth.shape, bool)
    expected[:, 20 : 20 + len(between)] = True
    np.testing.assert_array_equal(flying(depth), expected)
    np.testing.assert_array_equal(flying(np.ascontiguousarray(depth.T)), expected.T)


def test_pixels_between_a_roof_and_the_sky_fly():
    found = flying(row(*[10.0] * 20, 25.0, *[np.inf] * 20))
    assert found[:, 20].all()
    assert found.sum() == 40


def test_a_thin_pole_does_not_fly():
    assert not flying(row(*[6.0] * 20, 2.0, *[6.0] * 20)).any()


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_no_plane_flies_or_breaks_at_any_angle(x, y):
    depth = plane(np.array([x, y, -0.02]), 1.0)
    assert not flying(depth).any()
    seen = np.pad(~np.isnan(depth), ((0, 0), (1, 1)))
    # Two pixels alone in their row have no slope beside them that could foretell theirs.
    told = seen[:, 1:-2] & seen[:, 2:-1] & (seen[:, :-3] | seen[:, 3:])
    assert not steps(inverse_depth(depth))[told].any()


def test_a_row_breaks_at_a_step_and_at_the_sky_only():
    depth = row(2.0, 2.0, 2.02, 6.0, 6.0, np.inf, np.inf)
    found = steps(inverse_depth(depth))
    np.testing.assert_array_equal(found, np.tile([0, 0, 1, 0, 1, 1], (40, 1)).astype(bool))


def test_a_row_breaks_on_both_sides_of_a_pole():
    found = steps(inverse_depth(row(6.0, 6.0, 2.0, 6.0, 6.0)))
    np.testing.assert_array_equal(found[0], [False, True, True, False])
