import pytest
import torch
from torch.autograd import gradcheck
from torch.testing import assert_close

from flexdepth.geometry.pose import rotated
from flexdepth.losses.epipolar import epipolar, epipolar_as_written


def scene() -> tuple[torch.Tensor, ...]:
    generator = torch.Generator().manual_seed(1)

    def random(*size: int) -> torch.Tensor:
        return torch.rand(*size, generator=generator, dtype=torch.float64) - 0.5

    key = torch.cat([random(40, 2), torch.ones(40, 1)], -1)
    n, t = 0.2 * random(40, 3), random(40, 3)
    moved = rotated(n, (6 + 4 * random(40))[:, None] * key) + t
    return key, moved / moved[:, 2:], n, t


def test_a_step_aside_makes_rows_of_the_lines():
    # y = x + (any, .2): 0.2 in the written form at |t| = 1, shared by both frames in Sampson's.
    key = torch.tensor([[0.1, 0.0, 1.0]], dtype=torch.float64)
    target = torch.tensor([[0.4, 0.2, 1.0]], dtype=torch.float64)
    still, aside = torch.zeros_like(key), torch.tensor([[1.0, 0.0, 0.0]], dtype=torch.float64)
    assert epipolar_as_written(key, target, still, aside).item() == pytest.approx(0.2)
    assert epipolar(key, target, still, aside).item() == pytest.approx(0.2 / 2**0.5)


@pytest.mark.parametrize("loss", [epipolar, epipolar_as_written])
def test_the_true_motion_costs_nothing_whatever_the_depth(loss):
    assert loss(*scene()).max() < 1e-14


def test_the_written_form_rewards_a_vanishing_t_and_the_corrected_one_does_not():
    key, target, n, t = scene()
    target = target + torch.tensor([0.05, -0.02, 0.0])
    written, right = (loss(key, target, n, t) for loss in (epipolar_as_written, epipolar))
    assert_close(epipolar_as_written(key, target, n, 1e-3 * t), 1e-3 * written)
    assert_close(epipolar(key, target, n, 1e-3 * t), right)
    assert right.min() > 0
    assert not epipolar_as_written(key, target, n, 0 * t).any()


@pytest.mark.parametrize("loss", [epipolar, epipolar_as_written])
def test_gradients_are_those_of_finite_differences_and_finite_at_rest(loss):
    key, target, n, t = (x[:4].clone() for x in scene())
    target = target + torch.tensor([0.05, -0.02, 0.0])
    motion = n.requires_grad_(True), t.requires_grad_(True)
    assert gradcheck(lambda a, b: loss(key, target, a, b), motion)
    rest = torch.zeros_like(n, requires_grad=True), torch.zeros_like(t, requires_grad=True)
    for gradient in torch.autograd.grad(loss(key, key, *rest).sum(), rest):
        assert gradient.isfinite().all()
