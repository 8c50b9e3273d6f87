from math import cos, pi, sin

import pytest
import torch
from torch import nn
from torch.nn.functional import avg_pool2d
from torch.testing import assert_close

from flexdepth.networks.guidance import PlanarGuidance, means, planar_depth, planes
from flexdepth.runtime.errors import InputError

SMALL = PlanarGuidance(patches=(4, 2), width=8, farthest=20.0)


def test_a_tilted_plane_worked_by_hand():
    # n = (0.6, 0, 0.8), 4 m; two columns at -1/4 and 1/4: 4 / 0.65 and 4 / 0.95.
    plane = torch.tensor([0.6, 0.0, 0.8, 4.0])[None, :, None, None]
    row = torch.tensor([4 / 0.65, 4 / 0.95])
    assert_close(planar_depth(plane, 2, 2, 2), torch.stack([row, row])[None])
    leaning = torch.tensor([0.0, 0.6, 0.8, 4.0])[None, :, None, None]
    assert_close(planar_depth(leaning, 2, 2, 2), torch.stack([row, row], 1)[None])


def test_planes_that_face_the_camera_are_steps():
    plane = torch.zeros(1, 4, 2, 3)
    plane[:, 2] = 1.0
    plane[:, 3] = torch.arange(6.0).reshape(2, 3)
    depth = planar_depth(plane, 4, 8, 12)
    assert depth.shape == (1, 8, 12)
    assert_close(depth, plane[:, 3].repeat_interleave(4, 1).repeat_interleave(4, 2))


def test_one_plane_over_two_patches_is_each_patch_s_own():
    generator = torch.Generator().manual_seed(0)
    raw = torch.randn(2, 3, 2, 2, generator=generator)
    together = planar_depth(planes(raw, 5.0), 4, 8, 7)
    alone = planar_depth(planes(raw[:, :, 1:, :1], 5.0), 4, 4, 4)
    assert_close(together[:, 4:, :4], alone)


def test_channels_of_zero_are_a_normal_at_thirty_degrees_half_way_to_the_farthest():
    tilt = pi / 6
    expected = torch.tensor([sin(tilt) * cos(pi), sin(tilt) * sin(pi), cos(tilt), 5.0])
    assert_close(planes(torch.zeros(1, 3, 1, 1), 10.0)[0, :, 0, 0], expected)


def test_normals_have_length_one_and_lean_at_most_sixty_degrees():
    generator = torch.Generator().manual_seed(1)
    found = planes(20 * torch.randn(2, 3, 9, 9, generator=generator), 7.0)
    assert_close(found[:, :3].norm(dim=1), torch.ones(2, 9, 9))
    assert (found[:, 2] >= 0.5 - 1e-6).all()
    assert ((found[:, 3] >= 0) & (found[:, 3] <= 7)).all()


def test_depth_has_the_gradient_of_finite_differences():
    generator = torch.Generator().manual_seed(2)
    raw = torch.randn(1, 3, 2, 2, generator=generator, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(lambda x: planar_depth(planes(x, 5.0), 3, 6, 5), raw)


def test_no_plane_passes_behind_the_camera():
    # As steep as can be and along the diagonal: 1/2 − √(3/4) √(1/2) < 0 in one corner.
    steep = planes(torch.tensor([99.0, -1.9459101, 0.0])[None, :, None, None], 10.0)
    assert_close(steep[0, 0], steep[0, 1])
    depth = planar_depth(steep, 64, 64, 64)
    assert (depth > 0).all()
    assert_close(depth[0, 0, 0], torch.tensor(5.0 / 0.05))


@pytest.mark.parametrize("size", [(8, 8), (7, 10), (1, 3), (9, 5)])
@pytest.mark.parametrize("patch", [1, 2, 4, 8])
def test_the_means_are_over_what_there_is_of_a_patch(patch, size):
    features = torch.randn(2, 3, *size)
    assert_close(means(features, patch), avg_pool2d(features, patch, ceil_mode=True))


@pytest.mark.parametrize("size", [(1, 1), (3, 5), (33, 20)])
def test_any_size_goes_in_and_depth_stays_in_range(size):
    depth = SMALL.build(4)(torch.randn(2, 4, *size))
    assert depth.shape == (2, *size)
    assert ((depth > 0) & (depth < 20)).all()


def test_there_is_a_depth_whatever_the_features():
    head = SMALL.build(4)
    nn.init.zeros_(head.fuse[-1].weight)
    nn.init.constant_(head.fuse[-1].bias, -1e4)
    assert_close(head(torch.randn(1, 4, 3, 3)), torch.full((1, 3, 3), 1e-3))


def test_every_guide_is_looked_at():
    head = SMALL.build(4)
    head(torch.rand(1, 4, 8, 8)).sum().backward()
    assert all(p.grad is not None and p.grad.any() for p in head.parameters())


def test_one_exported_program_serves_every_size():
    head = SMALL.build(4).eval()
    rows, columns = (torch.export.Dim(name, min=9, max=512) for name in ("rows", "columns"))
    program = torch.export.export(
        head, (torch.rand(2, 4, 16, 24),), dynamic_shapes=({2: rows, 3: columns},)
    ).module()
    features = torch.rand(2, 4, 19, 11)
    assert_close(program(features), head(features))


@pytest.mark.parametrize("change", [{"patches": (4, 0)}, {"farthest": 0.0}, {"nearest": 0.0}])
def test_a_patch_without_a_side_and_a_range_without_an_end_are_refused(change):
    with pytest.raises(InputError, match="planar guidance needs"):
        PlanarGuidance(**change)
