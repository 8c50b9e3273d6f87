import pytest
import torch
from torch.autograd import gradcheck
from torch.testing import assert_close

from flexdepth.geometry.sampling import bilinear, inside, inverse_distance, pixel_centres


def ramp(height: int = 6, width: int = 9) -> torch.Tensor:
    """Return x, y and 3x - 2y + 1 as maps, counted from the first pixel's centre."""
    row, column = torch.meshgrid(
        torch.arange(height).double(), torch.arange(width).double(), indexing="ij"
    )
    return torch.stack([column, row, 3 * column - 2 * row + 1])


def point(x: float, y: float) -> torch.Tensor:
    """Return a point counted from the first pixel's centre, as the package counts."""
    return torch.tensor([[x + 0.5, y + 0.5]], dtype=torch.float64)


@pytest.mark.parametrize("sample", [bilinear, inverse_distance])
def test_pixel_centres_have_the_pixels_values(sample):
    maps = torch.randn(2, 5, 7, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    at = pixel_centres(maps[0]).flatten(0, 1)
    assert_close(sample(maps, at).mT.reshape(maps.shape), maps, rtol=0, atol=1e-10)


def test_functions_linear_in_x_and_y_are_kept():
    at = torch.rand(50, 2, dtype=torch.float64, generator=torch.Generator().manual_seed(1))
    at = at * torch.tensor([8.0, 5.0]) + 0.5
    x, y = (at - 0.5).unbind(-1)
    expected = torch.stack([x, y, 3 * x - 2 * y + 1], -1)
    assert_close(bilinear(ramp(), at), expected, rtol=0, atol=1e-12)


def test_the_mean_by_distance_does_not_keep_them():
    # Erratum of (5.25): f = x at (2.25, 3.5) is 2.383.
    assert inverse_distance(ramp(), point(2.25, 3.5))[0, 0].item() == pytest.approx(2.383, abs=5e-4)
    assert bilinear(ramp(), point(2.25, 3.5))[0, 0].item() == pytest.approx(2.25, abs=1e-12)


def test_the_mean_by_distance_jumps_between_cells():
    # Erratum of (5.25), f = y² as y passes 3: from the squares of rows 2, 3 to those of rows 3, 4.
    squares = (ramp()[1:2]) ** 2
    below, above = (inverse_distance(squares, point(2.5, 3 + e)).item() for e in (-1e-9, 1e-9))
    assert above - below > 3
    low, high = (bilinear(squares, point(2.5, 3 + e)).item() for e in (-1e-9, 1e-9))
    assert low == pytest.approx(high, abs=1e-6)


def test_the_middle_of_four_pixels_is_their_mean():
    maps = torch.tensor([[[1.0, 2.0], [4.0, 9.0]]], dtype=torch.float64)
    for sample in (bilinear, inverse_distance):
        assert sample(maps, point(0.5, 0.5)).item() == pytest.approx(4)


@pytest.mark.parametrize("sample", [bilinear, inverse_distance])
def test_no_points_have_no_values(sample):
    assert sample(ramp(), torch.zeros(0, 2, dtype=torch.float64)).shape == (0, 3)
    assert sample(ramp()[None], torch.zeros(1, 0, 2, dtype=torch.float64)).shape == (1, 0, 3)


def test_beyond_the_edge_the_edge_goes_on():
    at = torch.tensor([[-5.0, 3.0], [40.0, 3.0]], dtype=torch.float64)
    assert_close(bilinear(ramp(), at)[:, 0], torch.tensor([0.0, 8.0], dtype=torch.float64))
    assert_close(inside(at, 6, 9), torch.tensor([False, False]))
    assert inside(pixel_centres(ramp()[0]).flatten(0, 1), 6, 9).all()


@pytest.mark.parametrize("sample", [bilinear, inverse_distance])
def test_batches_are_singles(sample):
    generator = torch.Generator().manual_seed(2)
    maps = torch.randn(3, 2, 4, 5, 6, dtype=torch.float64, generator=generator)
    at = torch.rand(3, 2, 7, 2, dtype=torch.float64, generator=generator) * 5
    together = sample(maps, at)
    assert together.shape == (3, 2, 7, 4)
    assert_close(together[2, 1], sample(maps[2, 1], at[2, 1]))


@pytest.mark.parametrize("sample", [bilinear, inverse_distance])
def test_gradients_are_those_of_finite_differences(sample):
    generator = torch.Generator().manual_seed(3)
    maps = torch.randn(2, 4, 5, dtype=torch.float64, generator=generator, requires_grad=True)
    at = torch.tensor([[1.3, 2.2], [3.7, 1.1]], dtype=torch.float64, requires_grad=True)
    assert gradcheck(sample, (maps, at))


def test_the_gradient_at_a_pixel_centre_is_finite():
    at = point(2.0, 3.0).requires_grad_(True)
    for sample in (bilinear, inverse_distance):
        (gradient,) = torch.autograd.grad(sample(ramp(), at).sum(), at)
        assert gradient.isfinite().all()
