import pytest
import torch
from torch.autograd import gradcheck
from torch.testing import assert_close

from flexdepth.losses.flow import brightness_as_written, photometric, sparse_flow
from flexdepth.losses.gauge import depth_range, depth_scale, mean_length


def test_the_mean_length_is_held_on_average_only():
    t = torch.tensor([[3.0, 4.0, 0.0], [0.0, 0.0, 1.0]])
    assert mean_length(t, 0.01).item() == pytest.approx(2.99)
    assert mean_length(t, 5.0).item() == pytest.approx(2)
    some_vanish = torch.tensor([[0.02, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert mean_length(some_vanish, 0.01).item() == pytest.approx(0, abs=1e-8)


def test_its_gradient_is_finite_where_t_vanishes():
    t = torch.zeros(4, 3, requires_grad=True)
    (gradient,) = torch.autograd.grad(mean_length(t, 0.01), t)
    assert gradient.isfinite().all()


def test_depth_costs_what_it_is_out_of_range_by():
    depth = torch.tensor([[0.5, 1.0, 7.0, 80.0, 83.0]])
    assert_close(depth_range(depth, 1.0, 80.0), torch.tensor([(0.5 + 3) / 5]))
    assert_close(depth_scale(depth), depth.mean(-1))


def test_a_match_costs_what_the_flow_misses_it_by():
    flow = torch.tensor([[1.0, 2.0], [0.0, 0.0]])
    shift = torch.tensor([[1.5, 1.0], [0.0, -3.0]])
    assert_close(sparse_flow(flow, shift), torch.tensor([1.5, 3.0]))


def textured(shift: float) -> torch.Tensor:
    column = torch.arange(20, dtype=torch.float64).expand(1, 10, 20)
    return 0.5 + 0.4 * torch.sin(0.4 * (column - shift))


@pytest.mark.parametrize("shift", [0.0, 1.0, 3.0])
def test_true_flow_keeps_the_brightness(shift):
    flow = torch.zeros(10, 20, 2, dtype=torch.float64)
    flow[..., 0] = shift
    error, inside = photometric(textured(0), textured(shift), flow)
    assert error[inside].max() < 1e-12
    assert_close(inside, torch.arange(20).expand(10, 20) + shift <= 19)


def test_the_linear_form_holds_for_small_flow_only():
    # Erratum of (5.32). A tenth of a pixel and four pixels of a wave of 16 pixels.
    left = []
    for shift in (0.1, 4.0):
        flow = torch.zeros(10, 20, 2, dtype=torch.float64)
        flow[..., 0] = shift
        error = brightness_as_written(textured(0), textured(shift), flow)
        still = brightness_as_written(textured(0), textured(shift), 0 * flow)
        assert error.shape == (9, 19)
        left.append((error.mean() / still.mean()).item())
    assert left[0] < 0.3
    assert left[1] > 0.4


def test_a_slope_of_a_tenth_and_flow_of_two_worked_by_hand():
    row, column = torch.meshgrid(torch.arange(4.0), torch.arange(5.0), indexing="ij")
    key = (0.1 * column + 0.05 * row)[None]
    flow = torch.tensor([2.0, -1.0]).expand(4, 5, 2)
    # 0.1 · 2 - 0.05 · 1 + 0.3.
    got = brightness_as_written(key, key + 0.3, flow)
    assert_close(got, torch.full((3, 4), 0.45))


def test_gradients_by_flow_are_those_of_finite_differences():
    generator = torch.Generator().manual_seed(0)
    key, target = torch.rand(2, 2, 5, 6, dtype=torch.float64, generator=generator)
    flow = torch.rand(5, 6, 2, dtype=torch.float64, generator=generator).requires_grad_(True)
    assert gradcheck(lambda x: photometric(key, target, x)[0], flow)
    assert gradcheck(lambda x: brightness_as_written(key, target, x), flow)


def test_batches_are_singles():
    generator = torch.Generator().manual_seed(1)
    key, target = torch.rand(2, 3, 2, 1, 5, 6, generator=generator)
    flow = torch.rand(3, 2, 5, 6, 2, generator=generator)
    for loss in (lambda *x: photometric(*x)[0], brightness_as_written):
        assert_close(loss(key, target, flow)[2, 1], loss(key[2, 1], target[2, 1], flow[2, 1]))
