import pytest
import torch
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.depth import DepthBins
from flexdepth.losses.squared import Squared, mean_square, root_mean_square
from flexdepth.sample import Frame, Prediction, Sample, Truth

BINS = DepthBins(10, 0.01, 2.0, unit=10.0)


def sample(metres: torch.Tensor, valid: torch.Tensor, focal: float = 1.0) -> Sample:
    # 3 by 4 pixels: the diagonal is 5, so the focal length is `focal` diagonals.
    camera = Camera(torch.full((1, 2), 5 * focal), torch.zeros(1, 2))
    return Sample(("a",), Frame(torch.zeros(1, 3, 3, 4), camera), Truth(metres, valid, ~valid))


def two_errors() -> tuple[Prediction, Sample]:
    """Return a prediction off by 3 m and 4 m where the truth, 10 m, is known."""
    metres = torch.full((1, 3, 4), 10.0)
    depth = metres.clone()
    depth[0, 0, 0], depth[0, 0, 1], depth[0, 2, 3] = 13.0, 6.0, torch.nan
    valid = torch.zeros(1, 3, 4, dtype=torch.bool)
    valid[0, 0, :2] = True
    return Prediction(depth / 10, None, bins=BINS), sample(metres, valid)


@pytest.mark.parametrize(
    ("loss", "expected"),
    [
        (Squared(), 0.125),
        (Squared(mean="root"), 0.125**0.5),
        (Squared(unit="metres"), 12.5),
        (Squared(mean="root", unit="metres"), 12.5**0.5),
    ],
)
def test_errors_of_three_and_four_metres_worked_by_hand(loss, expected):
    # Scaled, 0.3 and 0.4: (0.09 + 0.16) / 2; in metres (9 + 16) / 2.
    assert loss(*two_errors()).item() == pytest.approx(expected)


def test_metres_are_those_of_the_camera_that_took_the_image():
    known = torch.ones(1, 3, 4, dtype=torch.bool)
    seen = sample(torch.full((1, 3, 4), 10.0), known, focal=2.0)
    # A canonical 6 m at half the camera's focal length is 12 m through it, 2 m too far.
    prediction = Prediction(torch.full((1, 3, 4), 6.0), 1.0)
    assert Squared(unit="metres")(prediction, seen).item() == pytest.approx(4.0)
    assert Squared()(prediction, seen).item() == pytest.approx(1.0)


def test_without_an_error_the_root_has_gradient_zero():
    depth = torch.full((1, 2, 2), 3.0, requires_grad=True)
    root = root_mean_square(depth, depth.detach(), torch.ones(1, 2, 2, dtype=torch.bool))
    assert root.item() == 0
    assert not torch.autograd.grad(root.sum(), depth)[0].any()


@pytest.mark.parametrize("loss", [mean_square, root_mean_square])
def test_gradients_are_those_of_finite_differences(loss):
    generator = torch.Generator().manual_seed(6)
    depth, truth = 0.5 + torch.rand(2, 2, 3, 4, generator=generator, dtype=torch.float64)
    valid = torch.rand(2, 3, 4, generator=generator) < 0.7
    assert torch.autograd.gradcheck(lambda d: loss(d, truth, valid), depth.requires_grad_(True))


def test_each_image_has_its_own_mean():
    depth, truth = torch.tensor([[[2.0, 5.0]], [[1.0, 1.0]]]), torch.ones(2, 1, 2)
    valid = torch.tensor([[[True, False]], [[True, True]]])
    assert_close(mean_square(depth, truth, valid), torch.tensor([1.0, 0.0]))
