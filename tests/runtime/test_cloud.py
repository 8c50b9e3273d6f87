import json
import struct
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.runtime.cloud import Cloud, Mesh, mesh, points, write_glb, write_ply
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError

CAMERA = Intrinsics(2.0, 4.0, 1.0, 2.0, FocalSource.GIVEN)
SKY, UNKNOWN = np.inf, np.nan


def metric(depth, camera=CAMERA):
    return DepthMap(np.asarray(depth, np.float32), Space.METRIC, camera)


def picture(height, width):
    """A picture whose red is the row and green the column."""
    rows, columns = np.mgrid[:height, :width] % 256
    return np.stack([rows, columns, np.full_like(rows, 7)], -1).astype(np.uint8)


def read_glb(path):
    """The JSON and the binary chunk of a binary glTF."""
    content = path.read_bytes()
    magic, version, length, size = struct.unpack("<4sIII", content[:16])
    assert (magic, version, length) == (b"glTF", 2, len(content))
    return json.loads(content[20 : 20 + size]), content[20 + size + 8 :]


def accessor(tree, binary, index, dtype, width):
    """One array of a binary glTF."""
    chosen = tree["accessors"][index]
    view = tree["bufferViews"][chosen["bufferView"]]
    count = chosen["count"] * width
    return np.frombuffer(binary, dtype, count, view["byteOffset"]).reshape(-1, width)


def test_points_lie_at_depth_times_the_ray_through_the_pixel_centre():
    found = points(metric([[4, 4], [8, 8]]), picture(2, 2))
    # x = z (u - 1)/2, y = z (v - 2)/4 with u, v = 0.5 and 1.5.
    expected = [[-1, -1.5, 4], [1, -1.5, 4], [-2, -1, 8], [2, -1, 8]]
    np.testing.assert_allclose(found.positions, expected)
    assert found.positions.dtype == np.float32
    np.testing.assert_array_equal(found.colours[:, :2], [[0, 0], [0, 1], [1, 0], [1, 1]])


def test_sky_the_unknown_and_what_lies_behind_give_no_points():
    found = points(metric([[SKY, UNKNOWN], [-1, 3]]), picture(2, 2))
    assert found.positions[:, 2].tolist() == [3]


def test_what_is_known_badly_gives_no_points():
    unsure = np.array([[0.05, 0.51], [0.5, UNKNOWN]], np.float32)
    found = points(replace(metric([[1, 2], [3, 4]]), spread=unsure), picture(2, 2))
    assert found.positions[:, 2].tolist() == [1, 3, 4]


def test_flying_pixels_give_no_points():
    depth = np.tile([2.0] * 10 + [3.0] + [6.0] * 10, (10, 1))
    assert set(points(metric(depth), picture(10, 21)).positions[:, 2]) == {2, 6}


@given(st.integers(1, 70), st.integers(1, 70), st.integers(1, 300))
def test_a_large_map_is_thinned_evenly_to_the_number_asked_for(height, width, most):
    found = points(metric(np.ones((height, width))), picture(height, width), most)
    assert 1 <= len(found.positions) <= most
    for axis in (0, 1):
        kept = np.unique(found.colours[:, axis])
        assert len(set(np.diff(kept.astype(int)))) <= 1
    if height * width <= most:
        assert len(found.positions) == height * width


def test_thinned_points_keep_their_place_in_space():
    depth = np.random.default_rng(3).uniform(2, 2.01, (8, 12))
    every = points(metric(depth), picture(8, 12))
    some = points(metric(depth), picture(8, 12), 20)
    where = {
        tuple(colour): tuple(at) for colour, at in zip(every.colours, every.positions, strict=True)
    }
    assert len(some.positions) > 5
    assert all(
        where[tuple(c)] == tuple(p) for c, p in zip(some.colours, some.positions, strict=True)
    )


@pytest.mark.parametrize("space", [Space.AFFINE_DEPTH, Space.AFFINE_DISPARITY])
@pytest.mark.parametrize("make", [points, mesh])
def test_affine_maps_have_no_points(space, make):
    with pytest.raises(InputError, match=str(space)):
        make(DepthMap(np.ones((2, 2), np.float32), space, CAMERA), picture(2, 2))


def test_a_map_without_a_camera_has_no_points():
    with pytest.raises(InputError, match="focal length"):
        points(metric(np.ones((2, 2)), None), picture(2, 2))


def test_a_picture_of_another_size_is_refused():
    with pytest.raises(InputError, match="2 x 2"):
        points(metric(np.ones((2, 2))), picture(2, 3))


def test_fewer_than_one_point_is_refused():
    with pytest.raises(InputError, match="max_points"):
        points(metric(np.ones((2, 2))), picture(2, 2), 0)


def test_a_wall_is_two_triangles_for_each_square_of_pixels_facing_the_camera():
    found = mesh(metric(np.full((3, 4), 2.0)), picture(3, 4))
    assert len(found.triangles) == 2 * 2 * 3
    a, b, c = (found.positions[found.triangles[:, k]] for k in range(3))
    # Each triangle is half a pixel of 2/2 by 2/4 metres; its normal points back to the camera.
    np.testing.assert_allclose(np.cross(b - a, c - a), np.tile([0, 0, -0.5], (12, 1)))


def test_no_triangle_crosses_a_step():
    depth = np.tile([2.0] * 5 + [6.0] * 5, (6, 1))
    found = mesh(metric(depth), picture(6, 10))
    across = np.ptp(found.positions[found.triangles][..., 2], axis=1)
    assert (across == 0).all()
    assert len(found.triangles) == 2 * 2 * 4 * 5


def test_a_grazing_floor_is_one_surface():
    camera = Intrinsics.centred(40, 40, 30.0, FocalSource.GIVEN)
    depth = np.full((40, 40), SKY)
    depth[22:] = (1.5 * 30 / (np.arange(22, 40) + 0.5 - 20))[:, None]
    assert len(mesh(metric(depth, camera), picture(40, 40)).triangles) == 2 * 17 * 39


def test_points_without_a_triangle_are_left_out_of_the_mesh():
    depth = np.full((4, 4), UNKNOWN)
    depth[0, :2], depth[1, 0], depth[3, 3] = 2, 2, 2
    found = mesh(metric(depth), picture(4, 4))
    assert len(found.positions) == 3
    np.testing.assert_array_equal(found.colours[found.triangles[0], :2], [[0, 0], [1, 0], [0, 1]])


CLOUD = Cloud(
    np.array([[1, 2, 3], [-1, 0.5, 8]], np.float32),
    np.array([[255, 0, 10], [188, 20, 30]], np.uint8),
)
TRIANGLE = Mesh(
    np.array([[0, 0, 2], [0, 1, 2], [1, 0, 2]], np.float32),
    np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255]], np.uint8),
    np.array([[0, 1, 2]], np.int32),
)


def test_a_ply_keeps_the_axes_and_the_colours(tmp_path):
    write_ply(tmp_path / "a.ply", CLOUD)
    assert (tmp_path / "a.ply").read_bytes().startswith(b"ply\nformat binary_little_endian 1.0\n")
    back = trimesh.load(tmp_path / "a.ply")
    np.testing.assert_array_equal(back.vertices, CLOUD.positions)
    np.testing.assert_array_equal(back.colors[:, :3], CLOUD.colours)


def test_a_ply_keeps_the_triangles(tmp_path):
    write_ply(tmp_path / "a.ply", TRIANGLE)
    back = trimesh.load(tmp_path / "a.ply", process=False)
    np.testing.assert_array_equal(back.faces, TRIANGLE.triangles)
    np.testing.assert_array_equal(back.vertices, TRIANGLE.positions)
    np.testing.assert_array_equal(back.visual.vertex_colors[:, :3], TRIANGLE.colours)


def test_a_glb_is_y_up_and_looks_along_minus_z_in_linear_colours(tmp_path):
    write_glb(tmp_path / "a.glb", CLOUD)
    tree, binary = read_glb(tmp_path / "a.glb")
    (primitive,) = tree["meshes"][0]["primitives"]
    assert primitive["mode"] == 0
    assert "KHR_materials_unlit" in tree["materials"][primitive["material"]]["extensions"]
    where = accessor(tree, binary, primitive["attributes"]["POSITION"], "<f4", 3)
    np.testing.assert_array_equal(where, [[1, -2, -3], [-1, -0.5, -8]])
    colour = accessor(tree, binary, primitive["attributes"]["COLOR_0"], "u1", 4)
    # sRGB 188 is half the light of 255: ((188/255 + 0.055)/1.055)^2.4 = 0.503.
    np.testing.assert_array_equal(colour, [[255, 0, 1, 255], [128, 2, 3, 255]])
    assert all("matrix" not in node for node in tree["nodes"])


def test_a_glb_keeps_the_triangles(tmp_path):
    write_glb(tmp_path / "a.glb", TRIANGLE)
    tree, binary = read_glb(tmp_path / "a.glb")
    (primitive,) = tree["meshes"][0]["primitives"]
    assert primitive["mode"] == 4
    corners = accessor(tree, binary, primitive["indices"], "<u4", 1)
    np.testing.assert_array_equal(corners.reshape(-1, 3), TRIANGLE.triangles)


@pytest.mark.parametrize("write", [write_ply, write_glb])
def test_nothing_to_write_is_said_with_the_name_of_the_file(tmp_path, write):
    empty = points(metric(np.full((2, 2), SKY)), picture(2, 2))
    with pytest.raises(InputError, match=r"a\.out.*sky"):
        write(tmp_path / "a.out", empty)
    assert not list(tmp_path.iterdir())
