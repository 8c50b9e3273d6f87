"""What moves by itself: its region, motion, scale, and what is said where that cannot be known."""

import importlib.util
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from flexdepth.runtime.depthmap import FocalSource
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


def test_what_moves_level_tells_its_scale_to_a_camera_that_rises_though_its_foot_is_not_seen():
    # Its foot, 1.4 below the camera at 2.5, is beneath the picture, which ends at 1.07.
    car = Box(z=2.5, width=1.0, height=1.6)
    seen = view(TURN, np.array([-0.1, -0.25, 0.05]), car, (0.2, 0, 0.05))
    found = two_frame(seen.seen(), REGIONS)
    assert seen.mover[-1].any()
    assert (found.regions[1].kind, found.regions[1].evidence) == (Kind.RIGID, Evidence.MOTION)
    assert abs_rel(found.depth, seen.depth, seen.mover & ~seen.hidden) < 0.03
    assert found.regions[1].confidence > 0.5


def test_what_hides_its_foot_below_the_picture_is_nearer_than_the_ground_at_its_edge():
    # It moves level, as the camera does, so that every scale is level. Its foot is 1.4 below the
    # camera at 2.5; where the picture ends the floor is 3.3 to 3.8 off.
    seen = view(TURN, np.array([-0.25, 0.0, -0.12]), Box(z=2.5, width=1.0, height=1.6), (0.2, 0, 0))
    found = two_frame(seen.seen(), REGIONS)
    assert found.regions[1].evidence is not Evidence.CONTACT
    assert found.regions[1].confidence < 0.5
    said = found.depth * np.median((seen.depth / found.depth)[~seen.mover & ~seen.hidden])
    assert 1.6 < np.median(said[seen.mover & ~seen.hidden]) < 3.4


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
    # The wall, 12 m off, has .043 pixels of parallax for each pixel from the middle: less than
    # two deviations, .2, up to 4 pixels from it; and behind the camera, below -.2, is one in 60.
    seen = view(np.eye(3), np.array([0, 0, -0.5]))
    found = two_frame(seen.seen(0.1), REGIONS)
    assert (found.unknown[43:47, 58:62] == Unknown.LOW_PARALLAX).mean() > 0.8
    low = found.unknown == Unknown.LOW_PARALLAX
    assert np.isnan(found.depth[low]).all()
    row, column = np.nonzero(low)
    assert np.hypot(row - 44.5, column - 59.5).max() < 15


def test_what_goes_against_the_cameras_way_is_said_to_be_behind_it():
    seen = view(np.eye(3), np.array([0, 0, -0.5]))
    told = seen.seen()
    # Five pixels: too few to be a thing. What is before a camera that drives on flows outwards.
    patch = np.s_[20, 80:85]
    assert (told.flow[patch] * (worlds.rays()[patch][..., :2])).sum(-1).min() > 0
    told.flow[patch] *= -1
    found = two_frame(told, REGIONS)
    assert (found.unknown[patch] == Unknown.BEHIND).all()
    assert np.isnan(found.depth[patch]).all()
    assert (found.unknown == Unknown.BEHIND).sum() == 5


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


def few(seen):
    """Return flow of 4 pixels: too few to tell a factor."""
    flow = np.full(seen.flow.shape, np.nan, np.float32)
    flow[10:12, 10:12] = seen.flow[10:12, 10:12]
    return flow


def test_stereo_that_hardly_sees_the_static_world_gives_no_metres_and_says_so(standing):
    seen, alone = standing
    right = view(np.eye(3), np.array([-0.5, 0, 0]), Box())
    stereo = Stereo(few(right), np.full(seen.depth.shape, 0.05, np.float32), 0.5)
    found = two_frame(seen.seen(stereo=stereo), REGIONS)
    assert not found.metric
    np.testing.assert_array_equal(found.depth, alone.depth)
    np.testing.assert_array_equal(found.translation, alone.translation)
    (line,) = found.notes
    assert line.startswith("the right picture adds nothing: ")


def test_stereo_of_a_camera_that_stays_needs_no_factor_but_a_disparity():
    seen = view(TURN, np.zeros(3))
    right = view(np.eye(3), np.array([-0.5, 0, 0]))
    noise = np.full(seen.depth.shape, 0.05, np.float32)
    found = two_frame(seen.seen(stereo=Stereo(few(right), noise, 0.5)), REGIONS)
    assert found.metric
    np.testing.assert_allclose(found.depth[10:12, 10:12], worlds.WALL, rtol=0.02)
    nothing = np.full(right.flow.shape, np.nan, np.float32)
    found = two_frame(seen.seen(stereo=Stereo(nothing, noise, 0.5)), REGIONS)
    assert not found.metric
    assert len(found.notes) == 1


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


def test_the_prior_tells_how_near_a_thing_is_that_neither_contact_nor_motion_bind():
    # It rises and comes nearer: at no scale does it stay or move level.
    seen = view(TURN, STEP, Box(), (0.1, -0.1, 0.2))
    alone, found = (two_frame(seen.seen(prior=each), REGIONS) for each in (None, bumpy(seen)))
    shown = seen.mover & ~seen.hidden
    assert abs_rel(found.depth, seen.depth, shown) < 0.1 * abs_rel(alone.depth, seen.depth, shown)
    assert alone.regions[1].evidence is Evidence.ORDERING
    assert found.regions[1].evidence is Evidence.PRIOR
    assert found.regions[1].scale_spread < alone.regions[1].scale_spread


def test_a_far_wall_that_the_prior_has_wrong_stays_where_its_parallax_puts_it():
    seen = view(TURN, 0.2 * STEP)
    wall = seen.depth == worlds.WALL
    told = np.full(seen.depth.shape, 0.1)
    shown = seen.seen(noise=0.04, prior=Prior(np.where(wall, 0.6, 1.0) * seen.depth, told))
    alone = two_frame(replace(shown, prior=None))
    found = two_frame(shown)
    assert abs_rel(found.depth, seen.depth, wall & alone.valid) < 1.05 * abs_rel(
        alone.depth, seen.depth, wall & alone.valid
    )


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


@pytest.mark.parametrize("source", FocalSource)
def test_a_prior_gives_metres_only_where_somebody_knows_the_focal_length(source):
    seen = view(TURN, STEP)
    prior = Prior(seen.depth, np.full(seen.depth.shape, 0.1), True)
    shown = seen.seen(prior=prior)
    found = two_frame(replace(shown, camera=replace(shown.camera, source=source)), REGIONS)
    assert found.metric is (source in (FocalSource.EXIF, FocalSource.GIVEN))
    way = 1.0 if found.metric else np.linalg.norm(STEP)
    np.testing.assert_allclose(np.median(found.depth / seen.depth) * way, 1, rtol=0.02)


def test_a_prior_that_nothing_ties_to_the_cameras_way_gives_no_metres_and_no_depth(standing):
    seen, alone = standing
    depth = np.full(seen.depth.shape, np.nan)
    depth[10:12, 10:12] = seen.depth[10:12, 10:12]
    prior = Prior(depth, np.full(depth.shape, 0.01), True)
    found = two_frame(seen.seen(prior=prior), REGIONS)
    assert not found.metric
    assert found.prior_share.max() == 0
    np.testing.assert_allclose(found.depth, alone.depth, rtol=1e-9)
    (line,) = found.notes
    assert line.startswith("the single-image depth is left out: ")


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
