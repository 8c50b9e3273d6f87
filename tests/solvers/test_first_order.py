"""Chapter 5's objective: its terms, and that it does not find depth."""

from collections.abc import Iterator
from dataclasses import asdict

import numpy as np
import pytest
import torch

from flexdepth.geometry.camera import Camera
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.solvers.dissertation import (
    OBJECTIVES,
    TABLE_5_1,
    Fields,
    Form,
    Scale,
    Terms,
    View,
    Weights,
    as_written,
    corrected,
    total,
)
from flexdepth.solvers.first_order import Clues, FirstOrder, descent, first_order, viewed
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.two_frame import TwoFrameSettings, two_frame

HEIGHT, WIDTH, FOCAL = 24, 32, 30.0
CAMERA = Intrinsics.centred(WIDTH, HEIGHT, FOCAL, FocalSource.GIVEN)
TABLE = {
    "sparse_perspective": 1.0,
    "dense_perspective": 1.0,
    "sparse_epipolar": 0.01,
    "dense_epipolar": 0.01,
    "sparse_flow": 0.1,
    "dense_flow": 0.1,
    "motion_boundaries": 1.0,
    "synchrony": 1.0,
    "mean_length": 0.1,
    "depth_scale": 1e-4,
    "depth_range": 1.0,
}
"""Table 5.1, as it is printed."""


def street() -> tuple[np.ndarray, np.ndarray, Pose]:
    """Return depth and flow of a floor and a wall, and the motion of the camera that sees them."""
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    ray = np.stack([(column - WIDTH / 2) / FOCAL, (row - HEIGHT / 2) / FOCAL, 0 * row + 1], -1)
    depth = np.minimum(1.5 / np.maximum(ray[..., 1], 1e-3), 12.0) - 2.0 * (column > 24)
    angle = 0.03
    rotation = np.array(
        [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    )
    pose = Pose(rotation, np.array([-0.6, 0.02, -0.3]))
    there = (depth[..., None] * ray) @ rotation.T + pose.translation
    seen = FOCAL * there[..., :2] / there[..., 2:] + (WIDTH / 2, HEIGHT / 2)
    return depth, seen - np.stack([column, row], -1), pose


def seen() -> Seen:
    _, flow, _ = street()
    noise = np.full((HEIGHT, WIDTH), 0.02, np.float32)
    return Seen(flow.astype(np.float32), noise, CAMERA)


def view(matches: int = 0) -> View:
    _, flow, _ = street()
    generator = np.random.default_rng(0)
    column, row = generator.integers(0, WIDTH, matches), generator.integers(0, HEIGHT, matches)
    key = np.stack([column, row], -1) + 0.5
    return View(
        Camera(
            torch.tensor([FOCAL, FOCAL]).double(), torch.tensor([WIDTH / 2, HEIGHT / 2]).double()
        ),
        torch.from_numpy(flow),
        torch.ones(HEIGHT, WIDTH, dtype=torch.bool),
        torch.from_numpy(key),
        torch.from_numpy(key + flow[row, column]),
        None,
    )


def true_fields(form: Form, length: float | None = None) -> Fields:
    """Return the truth, scaled so that |t| is `length`; as written, t is that of R (X - t)."""
    depth, flow, pose = street()
    t = pose.translation if form is Form.CORRECTED else -pose.rotation.T @ pose.translation
    factor = 1.0 if length is None else length / np.linalg.norm(t)
    turn = torch.tensor([0.0, 0.03, 0.0], dtype=torch.float64)

    def everywhere(vector: torch.Tensor) -> torch.Tensor:
        return vector[:, None, None].expand(3, HEIGHT, WIDTH)

    return Fields(
        torch.from_numpy(depth * factor),
        everywhere(turn),
        everywhere(torch.from_numpy(factor * t)),
        torch.from_numpy(flow),
    )


SCALE = Scale(1.0, 0.1, 1000.0, 0.9)


def test_the_weights_are_those_of_table_5_1():
    assert asdict(TABLE_5_1) == TABLE


@pytest.mark.parametrize("form", Form)
def test_there_are_eleven_terms_and_their_weighted_sum_is_minimised(form):
    terms = OBJECTIVES[form](true_fields(form), view(5), SCALE)
    assert terms.keys() == TABLE.keys()
    assert all(value.shape == () and value >= 0 for value in terms.values())
    expected = sum(TABLE[name] * value.item() for name, value in terms.items())
    assert total(terms, TABLE_5_1).item() == pytest.approx(expected)


def test_the_truth_costs_the_corrected_form_nothing():
    terms = corrected(true_fields(Form.CORRECTED, length=1.0), view(20), SCALE)
    held = {name: value.item() for name, value in terms.items() if name != "depth_scale"}
    assert max(held.values()) < 1e-9


def test_the_truth_costs_the_written_form_what_its_errata_say():
    truth = true_fields(Form.AS_WRITTEN, length=0.01)
    terms = as_written(truth, view(20), Scale(0.01, 0.5, 80.0, 0.9))
    assert terms["dense_perspective"].item() < 1e-9
    # A rigid world is as little in synchrony as can be,
    assert terms["synchrony"].item() == 1
    # its essential matrix is not that of its motion,
    assert terms["dense_epipolar"].item() > 1e-6
    # and |t| = 0.01 puts all of it nearer than half a metre.
    assert terms["depth_range"].item() > 0.2


def test_a_match_weighs_what_the_pixel_under_it_does():
    wrong = true_fields(Form.CORRECTED, length=1.0)
    wrong = Fields(wrong.depth * 1.5, wrong.n, wrong.t, wrong.flow)
    every = view()
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    key = torch.from_numpy(np.stack([column.ravel(), row.ravel()], -1))
    all_matched = View(
        every.camera, every.flow, every.trusted, key, key + every.flow.flatten(0, 1), None
    )
    terms = corrected(wrong, all_matched, SCALE)
    assert terms["sparse_perspective"].item() == pytest.approx(terms["dense_perspective"].item())
    assert terms["sparse_epipolar"].item() == pytest.approx(
        terms["dense_epipolar"].item(), abs=1e-9
    )


@pytest.mark.parametrize("form", Form)
def test_pixels_whose_flow_is_not_trusted_cost_nothing(form):
    some = view()
    trusted = torch.rand(HEIGHT, WIDTH, generator=torch.Generator().manual_seed(0)) < 0.5
    rubbish = torch.where(trusted[..., None], some.flow, 1e3)
    fields = true_fields(form)
    clean = View(some.camera, some.flow, trusted, some.key, some.target, None)
    dirty = View(some.camera, rubbish, trusted, some.key, some.target, None)
    dirty_fields = Fields(fields.depth, fields.n, fields.t, rubbish)
    for name in ("dense_perspective", "dense_epipolar"):
        one, other = (
            OBJECTIVES[form](each, where, SCALE)[name].item()
            for each, where in ((fields, clean), (dirty_fields, dirty))
        )
        assert one == pytest.approx(other)


@pytest.mark.parametrize("form", Form)
def test_the_pixelwise_scale_is_not_in_the_data(form):
    # (D s, t s) with any s at each pixel explains the same flow.
    truth = true_fields(form)
    factor = 0.5 + torch.rand(HEIGHT, WIDTH, dtype=torch.float64)
    other = Fields(truth.depth * factor, truth.n, truth.t * factor, truth.flow)
    terms = OBJECTIVES[form](other, view(), SCALE)
    assert terms["dense_perspective"].item() < 1e-9


def descended(form: Form, iterations: int) -> Iterator[Terms]:
    single = view()
    single = View(
        Camera(single.camera.focal.float(), single.camera.centre.float()),
        single.flow.float(),
        single.trusted,
        single.key.float(),
        single.target.float(),
        None,
    )
    for _, terms in descent(single, FirstOrder(form=form, iterations=iterations)):
        yield terms


@pytest.mark.parametrize("form", Form)
def test_descent_lowers_the_objective(form):
    first, *_, last = descended(form, iterations=60)
    assert total(last, TABLE_5_1) < 0.8 * total(first, TABLE_5_1)


def error(depth: np.ndarray) -> float:
    """Return AbsRel after a median scale."""
    truth, _, _ = street()
    depth = depth * np.median(truth / depth)
    return float(np.mean(np.abs(depth - truth) / truth))


def test_it_explains_the_flow_and_does_not_find_depth():
    found = first_order(seen(), FirstOrder(form=Form.CORRECTED, iterations=200))
    assert np.median(found.residual) < 0.1
    assert error(found.depth) > 0.15
    right = two_frame(seen(), TwoFrameSettings(dense=None))
    depth = np.where(right.valid, right.depth, np.nanmedian(right.depth))
    assert error(depth) < 0.05


def test_as_written_it_leaves_the_flow_unexplained_even_from_the_true_motion():
    _, _, pose = street()
    found = first_order(seen(), FirstOrder(iterations=100, start=pose))
    assert np.median(found.residual) > 0.3
    assert error(found.depth) > 0.15


@pytest.mark.parametrize("form", Form)
def test_it_begins_with_the_motion_it_is_told(form):
    _, _, pose = street()
    found = first_order(seen(), FirstOrder(form=form, iterations=0, start=pose))
    way = pose.translation / np.linalg.norm(pose.translation)
    assert np.abs(found.translation - way).max() < 1e-5
    assert np.abs(found.rotation - (0, 0.03, 0)).max() < 1e-6
    assert not found.moving.any()


def test_the_same_seed_gives_the_same_depth_and_another_another():
    one, same, other = (
        first_order(seen(), FirstOrder(iterations=3, seed=seed)).depth for seed in (0, 0, 1)
    )
    assert (one == same).all()
    assert (one != other).any()


def test_unknown_flow_has_no_depth():
    known = seen()
    flow, noise = known.flow.copy(), known.noise.copy()
    flow[:4], noise[4:8] = np.nan, np.nan
    found = first_order(Seen(flow, noise, CAMERA), FirstOrder(iterations=2))
    assert np.isnan(found.depth[:8]).all()
    assert np.isfinite(found.depth[8:]).all()
    assert np.unique(found.unknown[:4]).tolist() == [1]
    assert np.unique(found.unknown[4:8]).tolist() == [2]


def test_flow_as_an_unknown_goes_where_the_matches_are():
    _, flow, _ = street()
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    key = np.stack([column.ravel(), row.ravel()], -1)
    blank = np.full((HEIGHT, WIDTH), 128, np.uint8)
    clues = Clues(key, key + flow.reshape(-1, 2), (blank, blank))
    wrong = Seen((flow + 0.5).astype(np.float32), seen().noise, CAMERA)
    asked = FirstOrder(form=Form.CORRECTED, iterations=80, rate=0.05)
    (begun, first), *_, (ended, last) = descent(viewed(wrong, clues), asked)
    assert last["sparse_flow"] < 0.5 * first["sparse_flow"]
    assert (ended.flow != begun.flow).any()


def waves(shift: float) -> np.ndarray:
    """Return upright waves, so many pixels to the right."""
    column = np.arange(WIDTH) + 0.5 - shift
    return np.tile(np.rint(128 + 60 * np.sin(column / 2)).astype(np.uint8), (HEIGHT, 1))


@pytest.mark.parametrize("form", Form)
def test_flow_as_an_unknown_goes_where_the_frames_look_alike(form):
    nothing = np.zeros((0, 2))
    clues = Clues(nothing, nothing, (waves(0), waves(0.5)))
    still = Seen(np.zeros((HEIGHT, WIDTH, 2), np.float32), seen().noise, CAMERA)
    alone = Weights(**(dict.fromkeys(TABLE, 0.0) | {"dense_flow": 0.1}))
    asked = FirstOrder(form=form, weights=alone, iterations=60)
    (_, first), *_, (ended, last) = descent(viewed(still, clues), asked)
    assert last["dense_flow"] < 0.5 * first["dense_flow"]
    assert ended.flow[..., 0].median().item() == pytest.approx(0.5, abs=0.3)


@pytest.mark.parametrize("form", Form)
def test_flow_is_given_where_no_frames_tell_it(form):
    _, flow, _ = street()
    key = np.array([[5.5, 7.5], [20.5, 10.5]])
    (begun, first), *_, (ended, last) = descent(
        viewed(seen(), Clues(key, key + 1.0)), FirstOrder(form=form, iterations=3)
    )
    assert (ended.flow == begun.flow).all()
    assert np.abs(ended.flow.numpy() - flow).max() < 1e-4
    assert first["sparse_flow"] == last["sparse_flow"] > 0
    assert first["dense_flow"] == last["dense_flow"] == 0


@pytest.mark.parametrize(
    "wrong", [{"depths": (3.0, 1.0)}, {"quantile": 0.0}, {"iterations": -1}], ids=str
)
def test_settings_that_mean_nothing_are_refused(wrong):
    with pytest.raises(InputError, match="the dissertation's objective wants"):
        FirstOrder(**wrong)
