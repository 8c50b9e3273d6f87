import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.synth.shapes import (
    blob,
    box,
    cushion,
    draped,
    joined,
    prism,
    quad,
    revolved,
    rods,
    surface,
    tilt,
    tube,
    turn,
    wire,
)


def area(mesh):
    a, b, c = np.moveaxis(mesh.corners, 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def texture_area(mesh):
    a, b, c = np.moveaxis(mesh.uv, 1, 0)
    p, q = (b - a).T, (c - a).T
    return np.abs(p[0] * q[1] - p[1] * q[0]).sum() / 2


def test_a_box_has_the_surface_of_a_box_and_its_texture_is_in_metres():
    mesh = box((1, 2, 3), (2, 3, 5))
    assert area(mesh) == pytest.approx(2 * (6 + 10 + 15))
    assert texture_area(mesh) == pytest.approx(62)
    low, high = mesh.corners.min((0, 1)), mesh.corners.max((0, 1))
    assert low == pytest.approx([0, 0.5, 0.5])
    assert high == pytest.approx([2, 3.5, 5.5])


def test_a_quad_spans_its_two_sides():
    mesh = quad((1, 0, 0), (3, 0, 0), (0, 0, 2))
    assert area(mesh) == pytest.approx(6)
    assert mesh.uv.max((0, 1)) == pytest.approx([3, 2])


def test_a_quarter_turn_takes_z_to_x():
    assert turn(np.pi / 2) @ (0, 0, 1) == pytest.approx([1, 0, 0])
    assert tilt(np.pi / 2) @ (0, 1, 0) == pytest.approx([0, 0, 1])


@given(st.floats(-7, 7))
def test_turning_keeps_lengths_and_heights(yaw):
    rotation = turn(yaw)
    assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-12)
    assert rotation @ (0, 1, 0) == pytest.approx([0, 1, 0])


def test_a_prism_of_a_square_is_a_cube():
    mesh = prism([(0, 0), (1, 0), (1, 1), (0, 1)], 1)
    assert area(mesh) == pytest.approx(6)


def test_a_fine_cylinder_has_the_surface_of_a_cylinder():
    assert area(revolved([(2, 0), (2, 5)], 400)) == pytest.approx(2 * np.pi * 2 * 5, rel=1e-3)


def test_a_tube_ends_a_radius_beyond_its_ends():
    mesh = tube((0, 0, 0), (0, 4, 0), (0.5, 0.25))
    assert mesh.corners[..., 1].min() == pytest.approx(-0.5)
    assert mesh.corners[..., 1].max() == pytest.approx(4.25)


def test_a_smooth_blob_is_an_ellipsoid():
    mesh = blob(np.random.default_rng(0), (2, 4, 6), 0.0)
    radius = np.linalg.norm(mesh.corners / (1, 2, 3), axis=-1)
    assert radius == pytest.approx(np.ones_like(radius))


def test_a_cushion_fills_its_box():
    mesh = cushion((0, 1, 0), (2, 1, 4), 0.3, 11)
    assert mesh.corners.max((0, 1)) == pytest.approx([1, 1.5, 2], abs=0.02)


def test_every_cell_of_a_surface_becomes_two_triangles():
    grid = np.random.default_rng(0).normal(size=(4, 6, 3))
    assert len(surface(grid).corners) == 3 * 5 * 2


def test_joined_meshes_keep_every_triangle():
    assert len(joined([quad((0, 0, 0), (1, 0, 0), (0, 1, 0))] * 3).corners) == 6


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=9), st.floats(0.001, 0.05))
def test_a_wire_keeps_its_distance_from_its_line(heights, radius):
    line = np.stack([np.arange(len(heights)), heights, 0 * np.asarray(heights)], 1)
    corners = wire(line, radius).corners.reshape(-1, 1, 3)
    away = np.linalg.norm(corners - line, axis=2).min(1)
    assert away == pytest.approx(np.full(len(away), radius), abs=1e-9)


def test_rods_lead_from_each_start_to_its_end():
    starts = np.array([[0.0, 0, 0], [5, 0, 0]])
    ends = np.array([[0.0, 2, 0], [5, 0, 3]])
    corners = rods(starts, ends, 0.01).corners
    assert len(corners) == 2 * 6
    # Three sides of √3 radius at the start and half of it at the end, along 5 m in all.
    assert area(rods(starts, ends, 0.01)) == pytest.approx(5 * 3 * 3**0.5 * 0.0075, rel=0.01)
    assert corners.reshape(-1, 3).min(0) == pytest.approx([0, 0, 0], abs=0.011)
    assert corners.reshape(-1, 3).max(0) == pytest.approx([5, 2, 3], abs=0.011)


def test_land_is_textured_by_its_ground_plan():
    x, z = np.meshgrid(np.arange(3.0), np.arange(4.0))
    land = draped(np.stack([x, x * z, z], -1))
    assert len(land.corners) == 2 * 2 * 3
    assert (land.uv == land.corners[..., [0, 2]]).all()
