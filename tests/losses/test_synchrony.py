import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.autograd import gradcheck
from torch.testing import assert_close

from flexdepth.geometry.field import slopes
from flexdepth.losses.synchrony import synchrony, synchrony_as_written

ROW, COLUMN = torch.meshgrid(
    torch.arange(12, dtype=torch.float64), torch.arange(16, dtype=torch.float64), indexing="ij"
)
ONE, OTHER = (
    torch.tensor(x, dtype=torch.float64)
    for x in ([0.1, 0.0, -0.2, 1.0, 0.5, 0.0], [0.0, 0.3, 0.1, -1.0, 0.2, 0.7])
)


def step(where: torch.Tensor) -> torch.Tensor:
    """Return a motion that is one thing here and another there."""
    return torch.where(where, ONE[:, None, None], OTHER[:, None, None])


STEPS = {
    "vertical": step(COLUMN < 7),
    "horizontal": step(ROW < 5),
    "diagonal": step(COLUMN < ROW),
    "other diagonal": step(COLUMN + ROW < 11),
    "constant": step(COLUMN < 100),
}


@pytest.mark.parametrize("name", STEPS)
def test_constant_motions_and_steps_between_them_are_synchronous(name):
    assert synchrony(*slopes(STEPS[name])).abs().max() < 1e-12


def test_all_that_depends_on_one_number_of_the_pixel_is_synchronous():
    # Not by forward differences of a curved function, but by its true slopes.
    phase = 0.3 * COLUMN + 0.2 * ROW
    slope = ONE[:, None, None] * phase.cos()
    assert synchrony(0.3 * slope, 0.2 * slope).abs().max() < 1e-12


def test_a_flexible_motion_need_not_be_synchronous():
    # The theorem's counterexample: n1 = x, t2 = y. Slopes e1 and e5: det 1, trace 2, √½.
    motion = torch.zeros(6, 12, 16, dtype=torch.float64)
    motion[0], motion[4] = COLUMN, ROW
    got = synchrony(*slopes(motion))
    assert_close(got, torch.full((11, 15), 0.5**0.5, dtype=torch.float64), rtol=0, atol=2e-6)


@pytest.mark.parametrize("name", ["constant", "vertical", "horizontal"])
def test_the_written_form_costs_most_where_all_is_rigid(name):
    # Erratum of (5.41): |cos| is undefined at slopes of zero, and torch says 0.
    got = synchrony_as_written(*slopes(STEPS[name]))
    assert_close(got, torch.ones_like(got))


def test_the_written_form_is_zero_where_both_slopes_see_the_step_alone():
    got = synchrony_as_written(*slopes(STEPS["other diagonal"]))
    changes = slopes(STEPS["other diagonal"])[0].abs().sum(0) > 0
    assert got[changes].max() < 1e-12
    assert_close(got[~changes], torch.ones_like(got[~changes]))


def test_the_written_form_pulls_without_bound_on_small_noise():
    noise = torch.randn(2, 6, 8, 8, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    steepest = []
    for size in (1e-2, 1e-4):
        across, down = (size * noise).requires_grad_(True).unbind(0)
        (gradient,) = torch.autograd.grad(synchrony_as_written(across, down).sum(), across)
        steepest.append(gradient.abs().max().item())
    assert steepest[1] / steepest[0] == pytest.approx(100, rel=0.1)


def test_the_corrected_form_pulls_nowhere_on_a_constant_field():
    flat = torch.zeros(2, 6, 3, 4, dtype=torch.float64, requires_grad=True)
    (gradient,) = torch.autograd.grad(synchrony(*flat.unbind(0)).sum(), flat)
    assert not gradient.any()


slope_pairs = st.lists(st.floats(-3, 3), min_size=12, max_size=12)


@given(slope_pairs)
def test_it_lies_between_the_smaller_singular_value_and_that_over_the_root_of_two(numbers):
    pair = torch.tensor(numbers, dtype=torch.float64).reshape(2, 6)
    got = synchrony(*pair[:, :, None, None], floor=1e-18).item()
    least = torch.linalg.svdvals(pair)[-1].item()
    assert least / 2**0.5 - 1e-7 <= got <= least + 1e-7


@given(slope_pairs, st.floats(0, 6.28))
def test_turning_the_picture_changes_nothing(numbers, angle):
    pair = torch.tensor(numbers, dtype=torch.float64).reshape(2, 6)
    angle = torch.tensor(angle, dtype=torch.float64)
    turn = torch.stack([angle.cos(), -angle.sin(), angle.sin(), angle.cos()]).reshape(2, 2)
    one, other = (synchrony(*each[:, :, None, None]) for each in (pair, turn @ pair))
    assert_close(one, other, rtol=1e-9, atol=1e-7)


def test_gradients_are_those_of_finite_differences():
    pair = torch.randn(2, 6, 2, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(1))
    assert gradcheck(lambda x: synchrony(x[0], x[1]), pair.requires_grad_(True))


def test_batches_are_singles():
    across, down = torch.randn(2, 3, 2, 6, 4, 5, generator=torch.Generator().manual_seed(2))
    together = synchrony(across, down)
    assert together.shape == (3, 2, 4, 5)
    assert_close(together[2, 1], synchrony(across[2, 1], down[2, 1]))
