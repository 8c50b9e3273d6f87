from dataclasses import replace
from math import cos, radians, sin

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Tensor
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.losses.virtual_normal import (
    PAPER_KITTI,
    PAPER_NYU,
    Triangles,
    VirtualNormal,
    central_camera,
    drawn,
    virtual_normal,
)
from flexdepth.sample import Frame, Prediction, Sample, Truth

ANY = Triangles(smallest_cosine=-1.0, largest_cosine=1.0, gap=0.0, edge=0.0, dropped=0.0)
"""Every triangle counts that is no point and has valid corners."""


def generator(seed: int) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def everywhere(depth: Tensor) -> Tensor:
    return torch.ones_like(depth, dtype=torch.bool)


def rough_scene(seed: int, shape: tuple[int, int, int]) -> tuple[Tensor, Tensor, Tensor]:
    """Return a smooth truth with a step, a prediction of it and a mask with holes."""
    images, height, width = shape
    g = generator(seed)
    y, x = torch.meshgrid(torch.arange(height), torch.arange(width), indexing="ij")
    slope = 0.02 * torch.randn(images, 2, 1, 1, generator=g, dtype=torch.float64)
    truth = 0.5 + slope[:, 0] * x / 4 + slope[:, 1] * y / 4 + 0.2 * (x > width // 2)
    truth = truth + 0.02 * torch.rand(shape, generator=g, dtype=torch.float64)
    depth = truth * (0.9 + 0.2 * torch.rand(shape, generator=g, dtype=torch.float64))
    return depth, truth, torch.rand(shape, generator=g) < 0.9


def points_of(image, places, focal, centre):
    rows, columns = np.divmod(places, image.shape[1])
    rays = (np.stack([columns, rows], 1) + 0.5 - centre) / focal
    return [
        np.array([*ray, 1.0]) * image.flat[place] for ray, place in zip(rays, places, strict=True)
    ]


def is_accepted(points, triangles):
    p1, p2, p3 = points
    # Cosines of the interior angles at P1, P2 and P3.
    pairs = [(p2 - p1, p3 - p1), (p1 - p2, p3 - p2), (p1 - p3, p2 - p3)]
    cosines = [a @ b / (np.linalg.norm(a) * np.linalg.norm(b) + 1e-8) for a, b in pairs]
    pointed = max(cosines) > triangles.largest_cosine or min(cosines) < triangles.smallest_cosine
    edges = np.array([p2 - p1, p3 - p1, p3 - p2])
    near = (np.abs(edges) < triangles.gap).any(0).all()
    return not pointed and not near and np.linalg.norm(edges, axis=1).min() > triangles.edge


def normal(points):
    p1, p2, p3 = points
    vector = np.cross(p2 - p1, p3 - p1)
    return vector / (np.linalg.norm(vector) or 0.01)


def reference(scene, lens, corners, triangles):
    """The loss one triangle after another, from the description in words."""
    errors = []
    for predicted, true, known in zip(*scene, strict=True):
        for places in corners.T:
            points = points_of(true, places, *lens)
            if known.flat[places].all() and is_accepted(points, triangles):
                turned = normal(points_of(predicted, places, *lens))
                errors.append(np.abs(turned - normal(points)).sum())
    errors.sort()
    return np.mean(errors[int(triangles.dropped * len(errors)) :]), len(errors)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    "triangles",
    [
        Triangles(share=0.5),
        Triangles(share=0.5, gap=0.03),
        replace(PAPER_NYU, share=0.5, edge=0.15),
        Triangles(share=0.5, smallest_cosine=-0.5, gap=0.05, edge=0.1, dropped=0.6),
    ],
)
def test_it_is_what_the_description_says_one_triangle_after_another(seed, triangles):
    depth, truth, valid = rough_scene(seed, (2, 16, 20))
    corners = drawn(16, 20, triangles.share, generator(seed + 10))
    camera = central_camera(20.0, depth)
    loss = virtual_normal(depth, truth, valid, camera, corners, triangles)
    scene = [x.numpy() for x in (depth, truth, valid)]
    expected, count = reference(scene, (20.0, [10.5, 8.5]), corners.numpy(), triangles)
    assert 10 < count < 2 * corners.shape[1]
    assert loss.item() == pytest.approx(expected, rel=1e-9)


def test_each_image_is_seen_through_its_own_camera():
    depth, truth, valid = rough_scene(5, (2, 12, 14))
    corners = drawn(12, 14, 0.5, generator(3))
    focal = torch.tensor([[20.0, 22.0], [35.0, 31.0]], dtype=torch.float64)
    centre = torch.tensor([[7.0, 5.0], [3.0, 9.5]], dtype=torch.float64)
    triangles = Triangles(dropped=0.0)
    both = virtual_normal(depth, truth, valid, Camera(focal, centre), corners, triangles)
    totals, counts = 0.0, 0
    for i in range(2):
        one = [x[i : i + 1].numpy() for x in (depth, truth, valid)]
        camera = (focal[i].numpy(), centre[i].numpy())
        mean, count = reference(one, camera, corners.numpy(), triangles)
        totals, counts = totals + count * mean, counts + count
    assert both.item() == pytest.approx(totals / counts, rel=1e-9)


@pytest.mark.parametrize("degrees", [5, 20, 45, 70])
def test_a_plane_tilted_about_the_vertical_axis(degrees):
    """Its normal is (sin t, 0, −cos t), that of a wall straight ahead (0, 0, −1)."""
    tilt = radians(degrees)
    camera = central_camera(60.0, torch.zeros(1, 40, 40, dtype=torch.float64))
    across = (torch.arange(40, dtype=torch.float64) - 20) / 60
    # Points with z = 1 + x tan t: z = 1 / (1 − ray tan t).
    tilted = (1 / (1 - across * np.tan(tilt))).expand(1, 40, 40)
    wall = torch.ones_like(tilted)
    corners = drawn(40, 40, 0.3, generator(1))
    triangles = Triangles(gap=0.0)
    for depth, truth in ((wall, tilted), (tilted, wall)):
        loss = virtual_normal(depth, truth, everywhere(depth), camera, corners, triangles)
        assert loss.item() == pytest.approx(sin(tilt) + 1 - cos(tilt), rel=1e-9)
    if degrees == 20:
        assert loss.item() == pytest.approx(0.4023275, abs=5e-8)


@given(st.floats(1e-3, 1e3))
def test_it_is_blind_to_the_scale_of_the_prediction(scale):
    depth, truth, valid = rough_scene(2, (2, 12, 14))
    camera, corners = central_camera(20.0, depth), drawn(12, 14, 0.5, generator(4))
    same = virtual_normal(scale * truth, truth, valid, camera, corners, Triangles())
    assert same.item() == pytest.approx(0, abs=1e-12)
    a, b = (
        virtual_normal(x, truth, valid, camera, corners, Triangles())
        for x in (depth, scale * depth)
    )
    assert_close(a, b)


@pytest.mark.parametrize(
    ("dropped", "expected"), [(0.0, 2.5), (0.25, 3.0), (0.5, 3.5), (0.99, 4.0)]
)
def test_the_smallest_errors_are_left_out(dropped, expected):
    # Walls ahead of which one corner's depth is wrong by more and more: four triangles of errors
    # e1 < e2 < e3 < e4, in the ratio that the whole loss is compared with.
    depth, truth = torch.ones(2, 4, 4, 4, dtype=torch.float64)
    for i, wrong in enumerate((1.01, 1.02, 1.03, 1.04)):
        depth[i, 3, 0] = wrong
    camera, corners = central_camera(4.0, depth), torch.tensor([[0], [3], [12]])
    alone = [
        virtual_normal(depth[[i]], truth[[i]], everywhere(depth[[i]]), camera, corners, ANY)
        for i in range(4)
    ]
    assert alone == sorted(alone)
    rank = int(4 * dropped)
    triangles = replace(ANY, dropped=dropped)
    loss = virtual_normal(depth, truth, everywhere(depth), camera, corners, triangles)
    assert_close(loss, torch.stack(alone[rank:]).mean())
    assert sum(range(rank + 1, 5)) / (4 - rank) == expected


@pytest.mark.parametrize(
    ("corners", "triangles", "counts"),
    [
        # Pixels of a wall 1 away, 0.1 apart, numbered along rows of 8. First a right angle and two
        # of 45 degrees, then 27, 63 and 90 degrees, then a line.
        ([0, 4, 32], Triangles(gap=0.0), True),
        ([0, 4, 16], Triangles(gap=0.0), False),
        ([0, 1, 2], Triangles(gap=0.0), False),
        # 53, 76 and 51 degrees.
        ([0, 4, 35], PAPER_NYU, True),
        # 11, 135 and 34 degrees.
        ([0, 4, 13], ANY, True),
        ([0, 4, 13], replace(ANY, smallest_cosine=cos(radians(134))), False),
        ([0, 4, 13], replace(ANY, smallest_cosine=cos(radians(136))), True),
        # Edges of 0.4, 0.4 and 0.57 against a least edge.
        ([0, 4, 32], replace(ANY, edge=0.399), True),
        ([0, 4, 32], replace(ANY, edge=0.401), False),
        # Edges of 0.2, 0.3 and 0.1 across, 0.1, 0.1 and 0.2 down and 0 ahead.
        ([1, 11, 16], replace(ANY, gap=0.0999), True),
        ([1, 11, 16], replace(ANY, gap=0.1001), False),
        # No edge across, none down, none ahead: though an edge is 0.4 long.
        ([0, 4, 32], Triangles(), False),
    ],
)
def test_triangles_that_are_too_pointed_or_too_small_do_not_count(corners, triangles, counts):
    truth = torch.ones(1, 8, 8, dtype=torch.float64)
    depth = truth.clone()
    depth[0, 0, :2] = torch.tensor([1.2, 1.3])
    camera, places = central_camera(10.0, depth), torch.tensor(corners)[:, None]
    loss = virtual_normal(depth, truth, everywhere(depth), camera, places, triangles)
    assert bool(loss > 0) == counts


def test_no_triangle_costs_nothing():
    depth, truth, _ = rough_scene(3, (2, 8, 8))
    depth.requires_grad_(True)
    camera, corners = central_camera(20.0, depth), drawn(8, 8, 0.5, generator(2))
    nothing = torch.zeros(2, 8, 8, dtype=torch.bool)
    refused = replace(ANY, edge=1e9)
    for valid, triangles in ((nothing, ANY), (~nothing, refused)):
        loss = virtual_normal(depth, truth, valid, camera, corners, triangles)
        assert loss.item() == 0
        assert not torch.autograd.grad(loss, depth)[0].any()


def test_a_predicted_triangle_without_area_has_a_finite_gradient():
    truth = torch.tensor([[[1.0, 2.0, 1.0]]], dtype=torch.float64)
    depth = torch.ones_like(truth).requires_grad_(True)
    corners = torch.tensor([[0], [1], [2]])
    loss = virtual_normal(depth, truth, everywhere(depth), central_camera(1.0, depth), corners, ANY)
    # The true normal is (0, ±1, 0) and the prediction's is zero.
    assert loss.item() == pytest.approx(1)
    assert torch.autograd.grad(loss, depth)[0].isfinite().all()


@pytest.mark.parametrize("rubbish", [0.0, -1.0, torch.nan, torch.inf])
def test_rubbish_in_invalid_pixels_touches_neither_value_nor_gradient(rubbish):
    depth, truth, valid = rough_scene(6, (2, 12, 14))
    camera, corners = central_camera(20.0, depth), drawn(12, 14, 0.5, generator(5))
    spoilt = depth.where(valid, rubbish).requires_grad_(True)
    depth.requires_grad_(True)
    wanted = virtual_normal(depth, truth, valid, camera, corners, Triangles())
    dirty = truth.where(valid, rubbish)
    got = virtual_normal(spoilt, dirty, valid, camera, corners, Triangles())
    assert_close(got, wanted)
    (gradient,) = torch.autograd.grad(got, spoilt)
    assert_close(gradient, torch.autograd.grad(wanted, depth)[0])
    assert not gradient[~valid].any()


def test_gradients_are_those_of_finite_differences():
    depth, truth, valid = rough_scene(7, (2, 6, 7))
    camera, corners = central_camera(20.0, depth), drawn(6, 7, 0.9, generator(6))
    assert torch.autograd.gradcheck(
        lambda d: virtual_normal(d, truth, valid, camera, corners, Triangles()),
        depth.requires_grad_(True),
    )


def test_corners_are_drawn_evenly_from_all_pixels():
    assert drawn(385, 385, 0.15, generator(0)).shape == (3, 22_233)
    counts = torch.bincount(drawn(3, 4, 1000.0, generator(0)).flatten(), minlength=12)
    # 3,000 of each are expected, with a standard deviation of 52.
    assert ((counts - 3000).abs() < 5 * 52).all()


def sample(draw: int = 0, name: str = "a") -> tuple[Prediction, Sample]:
    depth, truth, valid = rough_scene(8, (1, 24, 30))
    focal = torch.full((1, 2), 40.0, dtype=torch.float64)
    centre = torch.tensor([[15.5, 12.5]], dtype=torch.float64)
    frame = Frame(torch.zeros(1, 3, 24, 30), Camera(focal, centre))
    known = Sample((name,), frame, Truth(truth, valid, ~valid), draw=(draw,))
    return Prediction(depth, None), known


def test_the_same_draw_of_the_same_image_takes_the_same_triangles():
    loss = VirtualNormal(40.0)
    torch.manual_seed(1)
    first = loss(*sample())
    torch.manual_seed(2)
    assert torch.equal(loss(*sample()), first)
    for other in (
        loss(*sample(draw=1)),
        loss(*sample(name="b")),
        VirtualNormal(40.0, seed=1)(*sample()),
    ):
        assert not torch.equal(other, first)


def test_without_a_fixed_focal_length_the_image_s_own_camera_is_taken():
    own = VirtualNormal(focal=None)(*sample())
    # The sample's camera is that of the code: 40 pixels, through the centre of pixel (15, 12).
    assert_close(own, VirtualNormal(40.0)(*sample()))
    assert not torch.allclose(own, VirtualNormal(50.0)(*sample()))


def test_the_paper_s_edges_are_of_sixty_centimetres():
    assert PAPER_NYU.edge * 10 == pytest.approx(0.6)
    assert PAPER_KITTI.edge * 80 == pytest.approx(0.6)
    assert PAPER_KITTI.smallest_cosine == pytest.approx(-0.5)
