"""The dense energy, its derivatives, and the steps that lower it."""

import cv2
import numpy as np
import pytest

from flexdepth.solvers.conjugate import solved
from flexdepth.solvers.curvature import linear, times
from flexdepth.solvers.field import Field, Scales, Terms, data_residual, energy
from flexdepth.solvers.levenberg import State, moved, step
from flexdepth.solvers.rotations import axis_angles

HEIGHT, WIDTH, FOCAL = 6, 7, 70.0
SCALES = Scales(2.0, 1.0, 0.5, 0.7, 3.0, 5.0)


def turned(twists):
    return np.array([cv2.Rodrigues(each)[0] for each in twists.reshape(-1, 3)]).reshape(
        *twists.shape, 3
    )


@pytest.fixture
def problem():
    """A field of random motions, in two regions, and terms that disagree with it."""
    random = np.random.default_rng(0)
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    key = np.stack([(column - WIDTH / 2) / FOCAL, (row - HEIGHT / 2) / FOCAL], -1)
    key = np.concatenate([key, np.ones((HEIGHT, WIDTH, 1))], -1)
    shape = HEIGHT, WIDTH
    field = Field(
        0.2 + 0.01 * random.normal(size=shape),
        turned(random.normal(0, 0.02, (*shape, 3))),
        np.array([0.5, -0.2, 0.3]) + 0.01 * random.normal(size=(*shape, 3)),
    )
    labels = np.zeros(shape, np.int32)
    labels[:, 4:] = 1
    terms = Terms(
        key=key,
        target=key[..., :2] + random.normal(0, 0.03, (*shape, 2)),
        focal=np.array([FOCAL, 1.1 * FOCAL]),
        unit=0.6 * FOCAL,
        lever=20.0,
        certain=random.uniform(1, 3, shape),
        labels=labels,
        region_rotation=np.array([np.eye(3)] * 2),
        region_translation=np.array([[0.5, -0.2, 0.3]] * 2),
        region_certain=np.array([2.0, 0.5]),
        depth=np.full(shape, 0.21),
        depth_certain=random.uniform(0, 2, shape),
    )
    return field, terms


def test_the_gradient_is_that_of_finite_differences(problem):
    field, terms = problem
    found = linear(field, terms, SCALES).gradient
    there = np.zeros_like(found)
    for at in np.ndindex(*found.shape):
        little = np.zeros_like(found)
        little[at] = 1e-5
        ahead, back = (energy(moved(field, terms, way * little), terms, SCALES) for way in (1, -1))
        there[at] = (ahead - back) / 2e-5
    np.testing.assert_allclose(found, there, atol=1e-7)


def matrix(at, damping):
    size = at.gradient.size
    columns = np.zeros((size, size))
    for k in range(size):
        unit, out = np.zeros(size), np.empty_like(at.gradient)
        unit[k] = 1
        times(at, damping, unit.reshape(out.shape), out)
        columns[:, k] = out.ravel()
    return columns


def test_the_curvature_is_symmetric_and_no_step_goes_up_hill_in_it(problem):
    full = matrix(linear(*problem, SCALES), 0.0)
    np.testing.assert_allclose(full, full.T, atol=1e-12)
    assert np.linalg.eigvalsh(full).min() > 0


def test_conjugate_gradients_solve_their_own_equations(problem):
    at = linear(*problem, SCALES)
    change, count = solved(at, 0.01, 300, 1e-9)
    np.testing.assert_allclose(matrix(at, 0.01) @ change.ravel(), -at.gradient.ravel(), atol=1e-6)
    assert count < 150


def test_each_step_lowers_the_energy_and_leaves_the_state_before_it_alone(problem):
    field, terms = problem
    before = [each.copy() for each in field]
    state, energies = State(field), [energy(field, terms, SCALES)]
    for _ in range(5):
        state = step(state, terms, SCALES)
        energies.append(state.energy)
    assert (np.diff(energies) <= 0).all()
    assert energies[-1] < 0.7 * energies[0]
    for one, other in zip(before, field, strict=True):
        np.testing.assert_array_equal(one, other)
    again = step(State(field), terms, SCALES)
    assert again.energy == energies[1]


def test_the_true_field_leaves_nothing_of_its_own_flow(problem):
    field, terms = problem
    there = np.einsum("hwab,hwb->hwa", field.rotation, terms.key)
    there += field.inverse_depth[..., None] * field.translation
    exact = terms._replace(target=there[..., :2] / there[..., 2:])
    out = np.empty(6)
    for at in np.ndindex(HEIGHT, WIDTH):
        data_residual(field, exact, *at, out)
        assert np.abs(out[:2]).max() < 1e-9


def test_each_region_nearer_and_slower_by_a_factor_of_its_own_is_the_same_flow(problem):
    field, terms = problem
    # A factor for each region: flow ties no thing's scale to another's, which is why scale is
    # sought beside the flow. Were only ρ or only t scaled, flow would be another by whole pixels.
    factor = np.array([3.7, 0.6])[terms.labels]
    slower = field.translation * factor[..., None]
    scaled = Field(field.inverse_depth / factor, field.rotation, slower)
    one, other, half = np.empty(6), np.empty(6), np.empty(6)
    for at in np.ndindex(HEIGHT, WIDTH):
        data_residual(field, terms, *at, one)
        data_residual(scaled, terms, *at, other)
        np.testing.assert_allclose(one[:2], other[:2], atol=1e-9)
        data_residual(field._replace(translation=slower), terms, *at, half)
        assert np.abs(one[:2] - half[:2]).max() > 1
    free = terms._replace(region_certain=np.zeros(2), depth_certain=np.zeros((HEIGHT, WIDTH)))
    apart = SCALES._replace(field_certain=0.0, planar_certain=0.0)
    assert energy(scaled, free, apart) == pytest.approx(energy(field, free, apart), rel=1e-9)
    assert energy(scaled, terms, SCALES) > 1.1 * energy(field, terms, SCALES)


def test_one_motion_everywhere_and_two_that_part_cost_little_or_a_bounded_sum(problem):
    _, terms = problem
    quiet = terms._replace(
        certain=np.zeros_like(terms.certain),
        region_certain=np.zeros(2),
        depth_certain=np.zeros_like(terms.certain),
    )
    rigid = Field(
        np.full((HEIGHT, WIDTH), 0.2),
        np.broadcast_to(np.eye(3), (HEIGHT, WIDTH, 3, 3)).copy(),
        np.broadcast_to([0.5, -0.2, 0.3], (HEIGHT, WIDTH, 3)).copy(),
    )
    assert energy(rigid, quiet, SCALES) < 1e-12
    for columns in (slice(3, None), slice(None)):
        split = rigid.translation.copy()
        split[3:, columns] += (40.0, 0, 0)
        parted = energy(rigid._replace(translation=split), quiet, SCALES)
        edges = WIDTH if columns == slice(None) else WIDTH - 3 + HEIGHT - 3
        # Geman and McClure's function is at most s²: each edge along the border costs no more.
        assert parted == pytest.approx(edges * 3.0 * 1.0 / 2, rel=0.01)


def test_axis_and_angle_are_those_of_rodrigues_formula_and_nothing_at_the_identity():
    random = np.random.default_rng(1)
    twists = random.normal(0, 0.5, (20, 3))
    np.testing.assert_allclose(axis_angles(turned(twists)), twists, atol=1e-12)
    tiny = 1e-12 * twists
    np.testing.assert_allclose(axis_angles(turned(tiny)), tiny, atol=1e-18)
    np.testing.assert_array_equal(axis_angles(np.eye(3)), np.zeros(3))
