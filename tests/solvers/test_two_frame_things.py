"""What moves by itself: its region, motion, scale, and what is said where that cannot be known."""

import importlib.util
from pathlib import Path

import cv2
import numpy as np
import pytest

from flexdepth.solvers.two_frame import (
    Evidence,
    Kind,
    Prior,
    Stereo,
    ThirdFrame,
    TwoFrameSettings,
    Unknown,
    two_frame,
)

_SPEC = importlib.util.spec_from_file_location("worlds", Path(__file__).parent / "worlds.py")
worlds = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(worlds)
Box, abs_rel, view = worlds.Box, worlds.abs_rel, worlds.view

REGIONS = TwoFrameSettings(dense=None)
TURN = cv2.Rodrigues(np.array([0.004, -0.01, 0.002]))[0]
STEP = np.array([-0.25, -0.03, -0.12])


def flow_said(found):
    """Return the flow that depth and motion of every pixel say."""
    rays = worlds.rays()
    axis = found.rotation.reshape(-1, 3)
    turned = np.array(
        [cv2.Rodrigues(a)[0] @ x for a, x in zip(axis, rays.reshape(-1, 3), strict=True)]
    )
    there = turned.reshape(rays.shape) + found.translation / found.depth[..., None]
    return (there[..., :2] / there[..., 2:] - rays[..., :2]) * worlds.FOCAL


@pytest.fixture(scope="module")
def standing():
    seen = view(TURN, STEP, Box(), (0.2, 0, 0))
    return seen, two_frame(seen.seen(), REGIONS)


def test_a_box_that_slides_over_the_floor_is_one_rigid_thing_that_stands_on_it(standing):
    seen, found = standing
    both = ~seen.hidden
    assert (found.moving == seen.mover)[both].mean() > 0.995
    assert len(found.regions) == 2
    assert (found.regions[1].kind, found.regions[1].evidence) == (Kind.RIGID, Evidence.CONTACT)
    assert abs_rel(found.depth, seen.depth, both & seen.mover) < 0.01
    assert abs_rel(found.depth, seen.depth, both & ~seen.mover) < 1e-3


def test_depth_and_motion_say_the_flow_that_was_seen(standing):
    seen, found = standing
    off = np.abs(flow_said(found) - seen.flow)[found.valid]
    assert np.median(off) < 1e-4
    assert np.nanmedian(found.residual[found.valid]) < 1e-4


def test_the_motion_of_the_box_is_its_own(standing):
    seen, found = standing
    at = tuple(np.argwhere(seen.mover & ~seen.hidden)[50])
    # X is at R (X + way) + t.
    true = (TURN @ (0.2, 0, 0) + STEP) / np.linalg.norm(STEP)
    np.testing.assert_allclose(found.translation[at], true, atol=0.03)
    np.testing.assert_allclose(found.rotation[at], (0.004, -0.01, 0.002), atol=1e-3)


def test_without_a_camera_that_moves_a_movers_scale_is_unknown():
    seen = view(TURN, np.zeros(3), Box(), (0.2, 0, 0))
    found = two_frame(seen.seen(), REGIONS)
    inner = seen.mover & ~seen.hidden & found.moving
    assert inner.sum() > 0.9 * seen.mover.sum()
    assert (found.unknown[inner] == Unknown.SCALE).all()
    assert np.isnan(found.depth[inner]).all()
    assert found.regions[1].evidence is Evidence.UNKNOWN
    assert np.isinf(found.regions[1].scale_spread)


def test_what_is_in_the_air_is_said_less_surely_than_what_stands(standing):
    _, found = standing
    seen = view(TURN, STEP, Box(foot=0.6), (0.2, 0.1, 0))
    airborne = two_frame(seen.seen(), REGIONS).regions[1]
    assert airborne.evidence is Evidence.ORDERING
    assert airborne.confidence < 0.5 * found.regions[1].confidence
    assert airborne.scale_spread > 2 * found.regions[1].scale_spread


def test_a_car_that_keeps_to_the_epipolar_lines_is_caught_by_the_ground_it_has_sunk_into():
    # It goes three quarters of the camera's way, so that it seems to be at 16 instead of 4.
    seen = view(np.eye(3), np.array([-0.4, 0, -0.4]), Box(x=0.2), (0.3, 0, 0.3))
    found = two_frame(seen.seen(), REGIONS)
    both = ~seen.hidden
    assert found.moving[seen.mover & both].mean() > 0.95
    assert abs_rel(found.depth, seen.depth, seen.mover & both) < 0.05
    parked = view(np.eye(3), np.array([-0.4, 0, -0.4]), Box(x=0.2))
    assert not two_frame(parked.seen(), REGIONS).moving.any()


def test_around_the_point_that_the_camera_drives_to_there_is_no_depth():
    seen = view(np.eye(3), np.array([0, 0, -0.5]))
    found = two_frame(seen.seen(0.1), REGIONS)
    middle = found.unknown[43:47, 58:62]
    assert np.isin(middle, (Unknown.LOW_PARALLAX, Unknown.BEHIND)).mean() > 0.8
    assert np.isnan(found.depth[found.unknown == Unknown.LOW_PARALLAX]).all()


def test_a_third_frame_halves_the_error_of_what_the_target_hides():
    seen = view(TURN, STEP, Box(), (0.5, 0, 0))
    before = view(TURN.T, -TURN.T @ STEP, Box(), (-0.5, 0, 0))
    noise = np.where(before.hidden, np.nan, 0.01).astype(np.float32)
    third = ThirdFrame(before.flow.astype(np.float32), noise)
    two, three = (two_frame(seen.seen(**more), REGIONS) for more in ({}, {"third": third}))
    hidden = seen.hidden & ~before.hidden
    assert hidden.sum() > 300
    assert abs_rel(three.depth, seen.depth, hidden) < abs_rel(two.depth, seen.depth, hidden) / 2
    assert abs_rel(three.depth, seen.depth, ~seen.hidden) < 0.01


@pytest.mark.parametrize("step", [STEP, np.zeros(3)])
def test_stereo_fixes_every_scale_in_metres(step):
    seen = view(TURN, step, Box(foot=0.6), (0.2, 0.1, 0))
    right = view(np.eye(3), np.array([-0.5, 0, 0]), Box(foot=0.6))
    noise = np.where(right.hidden, np.nan, 0.05).astype(np.float32)
    stereo = Stereo(right.flow.astype(np.float32), noise, 0.5)
    found = two_frame(seen.seen(stereo=stereo), REGIONS)
    assert found.metric
    inner = seen.mover & ~seen.hidden & ~right.hidden
    np.testing.assert_allclose(found.depth[inner], 4.0, rtol=0.03)
    assert found.regions[1].evidence is Evidence.STEREO
    both = ~seen.hidden & ~right.hidden
    assert np.median(np.abs(found.depth[both] / seen.depth[both] - 1)) < 0.02


def bumpy(seen, factor=3.0):
    """Return a prior in a unit of its own, wrong by up to a twentieth."""
    wave = 1 + 0.05 * np.sin(30 * worlds.rays()[..., 0])
    return Prior(seen.depth * factor * wave, np.full(seen.depth.shape, 0.1), False)


def test_the_prior_carries_what_geometry_does_not_and_its_share_is_shown():
    seen = view(TURN, STEP, Box(), (0.2, 0, 0))
    found = two_frame(seen.seen(prior=bumpy(seen)), REGIONS)
    assert found.valid.all()
    assert found.prior_share[seen.hidden].min() > 0.9
    static = ~seen.hidden & ~seen.mover
    assert np.median(found.prior_share[static]) < 0.05
    assert abs_rel(found.depth, seen.depth, static) < 0.01
    assert abs_rel(found.depth, seen.depth, seen.hidden & ~seen.mover) < 0.08
    assert not found.metric


def test_a_prior_in_metres_gives_metres_where_the_focal_length_is_known():
    seen = view(TURN, STEP, Box(), (0.2, 0, 0))
    prior = Prior(seen.depth, np.full(seen.depth.shape, 0.1), True)
    found = two_frame(seen.seen(prior=prior), REGIONS)
    assert found.metric
    np.testing.assert_allclose(np.median(found.depth / seen.depth), 1, rtol=0.02)
    still = ~found.moving
    np.testing.assert_allclose(
        found.translation[still], np.broadcast_to(STEP, (still.sum(), 3)), rtol=0.03
    )


def test_where_the_camera_has_stayed_all_depth_is_the_priors():
    seen = view(TURN, np.zeros(3), Box(), (0.2, 0, 0))
    found = two_frame(seen.seen(prior=bumpy(seen, 1.0)), REGIONS)
    said, still = bumpy(seen, 1.0).depth, ~found.moving
    np.testing.assert_allclose(found.depth[still], said[still], rtol=1e-6)
    assert found.prior_share[still].min() > 0.99
    # The mover's flow says that it is flat, the prior where.
    np.testing.assert_allclose(found.depth[~still], said[~still], rtol=0.12)
    assert found.regions[1].evidence is Evidence.PRIOR


def test_sky_is_what_the_prior_says_it_is_where_geometry_does_not_know():
    seen = view(TURN, STEP)
    prior = bumpy(seen)
    prior.depth[:20] = np.inf
    told = seen.seen(prior=prior)
    told.flow[:20] = np.nan
    found = two_frame(told, REGIONS)
    assert (found.unknown[:20] == Unknown.SKY).all()
    assert np.isposinf(found.depth[:20]).all()


def test_what_is_seen_to_be_near_is_no_sky_whatever_the_prior_says():
    seen = view(TURN, STEP)
    prior = bumpy(seen)
    prior.depth[:20] = np.inf
    found = two_frame(seen.seen(prior=prior), REGIONS)
    clear = ~seen.hidden[:20]
    assert np.isfinite(found.depth[:20][clear]).mean() > 0.98
    assert abs_rel(found.depth[:20], seen.depth[:20], clear) < 0.02
