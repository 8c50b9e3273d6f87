import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.autograd import gradcheck
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.epipolar import epipolar_product, sampson
from flexdepth.geometry.field import norm, slopes
from flexdepth.geometry.pose import cross_matrix, rotation_exp
from flexdepth.geometry.sampling import pixel_centres
from flexdepth.geometry.warp import induced_flow, moved, warped

FOCAL, CENTRE = [500.0, 520.0], [160.0, 120.0]


def double(*values: float) -> torch.Tensor:
    return torch.tensor(values, dtype=torch.float64)


def camera() -> Camera:
    return Camera(double(*FOCAL), double(*CENTRE))


def scene(count: int = 200) -> tuple[torch.Tensor, ...]:
    """Return rays, depths and a motion of each point of its own."""
    generator = torch.Generator().manual_seed(0)

    def random(*size: int) -> torch.Tensor:
        return torch.rand(*size, generator=generator, dtype=torch.float64)

    pixels = random(count, 2) * double(320, 240)
    return (
        camera().unproject(pixels),
        2 + 8 * random(count),
        0.2 * random(count, 3) - 0.1,
        random(count, 3) - 0.5,
    )


@given(st.tuples(st.floats(0, 320), st.floats(0, 240)), st.floats(0.1, 100))
def test_a_ray_times_any_depth_is_seen_where_it_came_from(pixel, depth):
    ray = camera().unproject(double(*pixel)[None])
    seen, ahead = camera().project(depth * ray)
    assert ahead.all()
    assert_close(seen[0], double(*pixel))


def test_the_principal_point_looks_straight_ahead():
    assert_close(camera().unproject(double(*CENTRE)[None]), double(0, 0, 1)[None])


def test_a_point_behind_is_told_and_finite():
    points = torch.stack([double(1, 2, 0), double(1, 2, -3)]).requires_grad_(True)
    seen, ahead = camera().project(points)
    assert not ahead.any()
    (gradient,) = torch.autograd.grad(seen.sum(), points)
    assert seen.isfinite().all()
    assert gradient.isfinite().all()


def test_a_step_aside_moves_a_plane_by_focal_over_depth():
    # 0.1 m at 5 m and 500 pixels: 10 pixels to the left.
    depth = torch.full((12, 16), 5.0, dtype=torch.float64)
    t = double(-0.1, 0, 0).expand(12, 16, 3)
    flow, ahead = induced_flow(depth, torch.zeros_like(t), t, camera())
    assert ahead.all()
    assert_close(flow, double(-10, 0).expand(12, 16, 2))


def test_standing_still_reproduces_the_picture():
    picture = torch.rand(3, 12, 16, dtype=torch.float64, generator=torch.Generator().manual_seed(4))
    still = torch.zeros(12, 16, 3, dtype=torch.float64)
    flow, _ = induced_flow(torch.ones(12, 16, dtype=torch.float64), still, still, camera())
    seen, inside = warped(picture, flow)
    assert inside.all()
    assert_close(seen, picture)


def test_a_picture_moved_by_one_pixel_is_found_again():
    picture = torch.rand(3, 12, 16, dtype=torch.float64, generator=torch.Generator().manual_seed(5))
    flow = double(1, 0).expand(12, 16, 2)
    seen, inside = warped(picture.roll(1, -1), flow)
    assert_close(seen[..., :-1], picture[..., :-1])
    assert_close(inside, torch.arange(16).expand(12, 16) < 15)


def test_motion_and_essential_matrix_are_of_one_convention():
    key, depth, n, t = scene()
    target = moved(key, depth, n, t)
    target = target / target[:, 2:]
    off = sampson(key, target, n, t, double(*FOCAL))
    assert off.abs().max() < 1e-9  # pixels
    # By the matrix, written out for each point.
    essential = cross_matrix(t) @ rotation_exp(n)
    product = torch.einsum("ni,nij,nj->n", target, essential, key)
    assert_close(epipolar_product(key, target, n, t), product, rtol=0, atol=1e-13)


def test_the_written_motion_does_not_go_with_the_written_essential_matrix():
    # Erratum of (5.3), (5.6): X_target = R (X_key - t) has E = -R [t]x. By 6 degrees of turn and
    # about a pixel and a half of error at 500 pixels of focal length.
    key, depth, _, _ = scene()
    n = double(0.06, -0.08, 0.03).expand_as(key)
    t = double(1.0, 0.2, 0.5).expand_as(key)
    written = moved(key, depth, n, -(rotation_exp(n) @ t[..., None])[..., 0])
    target = written / written[:, 2:]
    wrong = sampson(key, target, n, t, double(500, 500))
    assert 0.5 < wrong.square().mean().sqrt() < 3
    right = sampson(key, target, n, -(rotation_exp(n) @ t[..., None])[..., 0], double(500, 500))
    assert right.abs().max() < 1e-9


def test_sampson_is_the_product_over_the_length_of_its_gradient():
    key, _, n, t = scene()
    target = key + 0.1 * torch.randn(200, 3, generator=torch.Generator().manual_seed(6)).double()
    target[:, 2] = 1
    # By the matrix and autograd: yᵀ E x as a function of the four pixel coordinates.
    pixels = [camera().project(each)[0].requires_grad_(True) for each in (key, target)]
    one, other = (camera().unproject(each) for each in pixels)
    essential = cross_matrix(t) @ rotation_exp(n)
    product = torch.einsum("ni,nij,nj->n", other, essential, one)
    slope = torch.cat(torch.autograd.grad(product.sum(), pixels), -1).norm(dim=-1)
    assert_close(sampson(key, target, n, t, double(*FOCAL)), product / slope)


def test_sampson_tells_pixels_and_does_not_change_with_the_length_of_t():
    key, _, _, _ = scene()
    still = torch.zeros_like(key)
    aside = double(1, 0, 0).expand_as(key)
    # A step to the side: lines are rows. One pixel off in the target is shared by both frames.
    target = key + double(0.3, 1 / 520, 0)
    expected = torch.full((200,), 1 / 2**0.5, dtype=torch.float64)
    assert_close(sampson(key, target, still, aside, double(*FOCAL)).abs(), expected)
    assert_close(sampson(key, target, still, 1e-3 * aside, double(*FOCAL)).abs(), expected)


def test_sampson_and_its_gradient_are_finite_where_nothing_moves():
    key, _, n, t = scene(5)
    nothing = torch.zeros_like(t).requires_grad_(True)
    turn = torch.zeros_like(n).requires_grad_(True)
    off = sampson(key, key, turn, nothing, double(1, 1))
    assert_close(off, torch.zeros(5, dtype=torch.float64))
    for gradient in torch.autograd.grad(off.sum(), (turn, nothing)):
        assert gradient.isfinite().all()
        assert gradient.abs().max() < 10


def test_gradients_of_warping_are_those_of_finite_differences():
    depth = (3 + torch.rand(3, 4, dtype=torch.float64)).requires_grad_(True)
    n = (0.05 * torch.randn(3, 4, 3, dtype=torch.float64)).requires_grad_(True)
    t = torch.randn(3, 4, 3, dtype=torch.float64).requires_grad_(True)
    small = Camera(double(5, 5), double(2, 1.5))
    assert gradcheck(lambda *motion: induced_flow(*motion, small)[0], (depth, n, t))
    key = small.unproject(pixel_centres(depth).flatten(0, 1))
    target = (key + 0.1).detach()
    flat = (n.flatten(0, 1), t.flatten(0, 1))
    assert gradcheck(lambda a, b: sampson(key, target, a, b, double(5, 5)), flat)


def test_slopes_are_the_rise_to_the_next_pixel():
    row, column = torch.meshgrid(torch.arange(3.0), torch.arange(4.0), indexing="ij")
    across, down = slopes((2 * column - 5 * row)[None])
    assert_close(across, torch.full((1, 2, 3), 2.0))
    assert_close(down, torch.full((1, 2, 3), -5.0))


@pytest.mark.parametrize("batch", [(), (2,), (2, 3)])
def test_lengths_have_a_gradient_of_zero_at_zero(batch):
    vectors = torch.zeros(*batch, 3, requires_grad=True)
    lengths = norm(vectors)
    assert lengths.shape == batch
    (gradient,) = torch.autograd.grad(lengths.sum(), vectors)
    assert not gradient.any()
    assert norm(torch.tensor([3.0, 0.0, 4.0])).item() == 5
