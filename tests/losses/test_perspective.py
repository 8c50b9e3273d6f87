from math import pi, sin

import pytest
import torch
from torch.autograd import gradcheck
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.pose import rotated
from flexdepth.losses.perspective import perspective, perspective_as_written

CAMERA = Camera(torch.tensor([500.0, 500.0]).double(), torch.tensor([320.0, 240.0]).double())
STILL = torch.zeros(1, 3, dtype=torch.float64)
ONE = torch.ones(1, dtype=torch.float64)


def rays(*rows: tuple[float, float, float]) -> torch.Tensor:
    return torch.tensor(rows, dtype=torch.float64)


def scene() -> tuple[torch.Tensor, ...]:
    generator = torch.Generator().manual_seed(0)

    def random(*size: int) -> torch.Tensor:
        return torch.rand(*size, generator=generator, dtype=torch.float64)

    key = CAMERA.unproject(random(50, 2) * 400)
    return key, 2 + 8 * random(50), 0.2 * random(50, 3), random(50, 3) - 0.5


def test_it_is_the_chord_of_the_angle_between_the_rays():
    ahead = rays((0, 0, 1))
    for angle in (1e-4, 0.1, 1.0, 3.0):
        n = angle * rays((0, 1, 0))
        wanted = 2 * sin(angle / 2)
        assert perspective(ahead, ahead, ONE, n, STILL).item() == pytest.approx(wanted, rel=1e-9)


def test_a_point_straight_behind_costs_two():
    ahead = rays((0, 0, 1))
    assert perspective(ahead, ahead, ONE, STILL, rays((0, 0, -3))).item() == pytest.approx(2)
    assert perspective(ahead, ahead, ONE, pi * rays((1, 0, 0)), STILL).item() == pytest.approx(2)


def test_the_true_motion_costs_nothing_and_the_written_convention_has_its_own():
    key, depth, n, t = scene()
    moved = rotated(n, depth[:, None] * key) + t
    target = moved / moved[:, 2:]
    assert perspective(key, target, depth, n, t).max() < 1e-14
    pixels, seen = (CAMERA.project(each)[0] for each in (key, target))
    # X_target = R (X - t') with t' = -Rᵀ t.
    own = -rotated(-n, t)
    assert perspective_as_written(pixels, seen, depth, n, own, CAMERA).max() < 1e-12
    assert perspective_as_written(pixels, seen, depth, n, t, CAMERA).max() > 1e-4


def displaced(pixel: tuple[float, float], way: tuple[float, float], dtype: torch.dtype) -> float:
    """Return the written cost of a still point whose match is off by so many pixels."""
    camera = Camera(CAMERA.focal.to(dtype), CAMERA.centre.to(dtype))
    key = torch.tensor([pixel], dtype=dtype)
    target = key + torch.tensor([way], dtype=dtype)
    still = STILL.to(dtype)
    return perspective_as_written(key, target, ONE.to(dtype), still, still, camera).item()


def test_one_pixel_costs_250_000_times_less_along_the_ray_from_the_corner_than_across():
    # |p| = 500: 1 / 2|p|² = 2e-6 across, 1 / 2|p|⁴ = 8e-12 along.
    across = displaced((300, 400), (0.8, -0.6), torch.float64)
    along = displaced((300, 400), (0.6, 0.8), torch.float64)
    assert across == pytest.approx(2.0e-6, rel=0.01)
    assert along == pytest.approx(8.0e-12, rel=0.01)
    assert across / along == pytest.approx(2.5e5, rel=0.01)


def test_single_precision_does_not_see_20_pixels_along_that_ray():
    assert displaced((300, 400), (12, 16), torch.float32) == pytest.approx(0, abs=6.1e-8)
    assert displaced((300, 400), (12, 16), torch.float64) == pytest.approx(3e-9, rel=0.1)


def cost_of(way: tuple[float, float]) -> float:
    key = torch.tensor([[300.0, 400.0]], dtype=torch.float64)
    target = key + torch.tensor([way], dtype=torch.float64)
    one, other = (CAMERA.unproject(each) for each in (key, target))
    return perspective(one, other, ONE, STILL, STILL).item()


def test_between_rays_a_pixel_costs_about_the_same_every_way():
    assert 1.0 < cost_of((0.8, -0.6)) / cost_of((0.6, 0.8)) < 1.3


def test_single_precision_sees_a_hundredth_of_a_pixel_between_rays():
    key = torch.tensor([[300.0, 400.0]])
    camera = Camera(CAMERA.focal.float(), CAMERA.centre.float())
    rays = [camera.unproject(each) for each in (key, key + torch.tensor([[0.01, 0.0]]))]
    got = perspective(*rays, ONE.float(), STILL.float(), STILL.float()).item()
    assert got == pytest.approx(cost_of((0.01, 0)), rel=0.1)


def test_gradients_are_those_of_finite_differences_and_finite_where_nothing_moves():
    key, depth, n, t = (x[:4].clone() for x in scene())
    target = key + 0.1
    motion = [x.requires_grad_(True) for x in (depth, n, t)]
    assert gradcheck(lambda *x: perspective(key, target, *x), motion)
    pixels, seen = (CAMERA.project(each)[0] for each in (key, target))
    assert gradcheck(lambda *x: perspective_as_written(pixels, seen, *x, CAMERA), motion, atol=1e-7)
    still = [x.clone().requires_grad_(True) for x in (ONE, STILL, STILL)]
    loss = perspective(key[:1], key[:1], *still).sum()
    loss = loss + perspective_as_written(pixels[:1], pixels[:1], *still, CAMERA).sum()
    for gradient in torch.autograd.grad(loss, still):
        assert gradient.isfinite().all()


def test_batches_are_singles():
    key, depth, n, t = (x.reshape(2, 5, 5, *x.shape[1:]) for x in scene())
    target = key + 0.05
    together = perspective(key, target, depth, n, t)
    assert together.shape == (2, 5, 5)
    alone = perspective(key[1, 2], target[1, 2], depth[1, 2], n[1, 2], t[1, 2])
    assert_close(together[1, 2], alone)
