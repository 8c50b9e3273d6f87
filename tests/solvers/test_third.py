"""What a third frame adds, and what is said where it adds nothing."""

import importlib.util
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from flexdepth.solvers.answer import Evidence, Kind, Region
from flexdepth.solvers.criterion import MotionKind
from flexdepth.solvers.ego_motion import CameraMotion
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.region_solver import solved_regions
from flexdepth.solvers.seen import ThirdFrame
from flexdepth.solvers.third import with_third
from flexdepth.solvers.world import World, along_of, sight_of

_SPEC = importlib.util.spec_from_file_location("worlds", Path(__file__).parent / "worlds.py")
worlds = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(worlds)
Box, abs_rel, view = worlds.Box, worlds.abs_rel, worlds.view

TURN = cv2.Rodrigues(np.array([0.004, -0.01, 0.002]))[0]
STEP = np.array([-0.25, -0.03, -0.12])
BACK = TURN.T, -TURN.T @ STEP
PATCH = np.zeros((worlds.HEIGHT, worlds.WIDTH), bool)
PATCH[15:25, 20:40] = True
"""Of the wall: both frames show it."""


def third_of(seen, noise=0.01):
    deviation = np.where(seen.hidden, np.nan, noise).astype(np.float32)
    return ThirdFrame(seen.flow.astype(np.float32), deviation)


def still_world(seen):
    """Return the world as flow says it, were all still and the camera's motion known."""
    pose = Pose(TURN, STEP / np.linalg.norm(STEP))
    camera = CameraMotion(MotionKind.GENERAL, pose, None, None, {}, 1.0, 1.0)
    sight = sight_of(seen)
    along = along_of(sight, camera)
    spread = np.where(sight.trusted, along.spread * sight.noise, np.inf)
    labels = np.zeros(spread.shape, np.int32)
    region = Region(0, Kind.STATIC, Evidence.CAMERA, 1.0, 0.0, labels.size)
    rotation = np.broadcast_to(pose.rotation, (*labels.shape, 3, 3))
    translation = np.broadcast_to(pose.translation, (*labels.shape, 3))
    return World(
        sight, camera, labels, (region,), along.inverse_depth, spread, rotation, translation
    )


def strayed(motion, along, across):
    """Return flow as the camera's motion makes it, but for what strays in the patch.

    Args:
        motion: R and t of the camera.
        along: Parallax that is added, in that which there is.
        across: Pixels off the epipolar line.
    """
    rotation, translation = motion
    flow = view(rotation, translation).flow
    parallax = flow - view(rotation, np.zeros(3)).flow
    line = parallax / np.linalg.norm(parallax, axis=-1, keepdims=True)
    off = along * parallax + across * np.stack([-line[..., 1], line[..., 0]], -1)
    return np.where(PATCH[..., None], flow + off, flow).astype(np.float32)


@pytest.mark.parametrize("wrong", ["target", "third"])
def test_of_two_depths_the_one_with_the_smaller_residual_in_its_own_noise_stands(wrong):
    # What is right is off its line by .3 pixels, its noise; what is wrong by .04, four times that.
    off = {True: (1.0, 0.04), False: (0.0, 0.3)}
    noise = {True: np.full(PATCH.shape, 0.01), False: np.where(PATCH, 0.3, 0.01)}
    here, there = wrong == "target", wrong == "third"
    seen = replace(
        view(TURN, STEP).seen(),
        flow=strayed((TURN, STEP), *off[here]),
        noise=noise[here].astype(np.float32),
    )
    third = ThirdFrame(strayed(BACK, *off[there]), noise[there].astype(np.float32))
    found = with_third(still_world(seen), seen, third)
    depth = np.linalg.norm(STEP) / found.inverse_depth
    np.testing.assert_allclose(depth[PATCH], worlds.WALL, rtol=0.02)


@pytest.mark.parametrize("wrong", ["target", "third"])
def test_on_what_moves_the_more_certain_of_two_depths_stands(wrong):
    # The box goes farther in the frame that is right, so that the static world's lines favour the
    # other one.
    near, far = (0.2, 0, 0), (-0.6, 0, 0)
    ways = (near, far) if wrong == "target" else (far, near)
    seen = view(TURN, STEP, Box(), ways[0])
    before = view(*BACK, Box(), ways[1])
    world = solved_regions(seen.seen(), 2.0)
    inner = np.zeros_like(PATCH)
    inner[50:60, 60:72] = True
    assert (inner & seen.mover & ~seen.hidden & ~before.hidden)[inner].all()
    spread = np.where(inner, 0.2 if wrong == "target" else 1e-4, world.shape_spread)
    third = third_of(before)
    if wrong == "target":
        own = np.where(inner, 2 * world.inverse_depth, world.inverse_depth)
        world = replace(world, inverse_depth=own, shape_spread=spread)
    else:
        world = replace(world, shape_spread=spread)
        third.flow[inner] += (3.0, 0.0)
    found = with_third(world, seen.seen(), third)
    depth = np.linalg.norm(STEP) / found.inverse_depth
    np.testing.assert_allclose(depth[inner], Box().z, rtol=0.05)


def test_a_third_frame_that_tells_nothing_is_said_to_and_changes_nothing():
    went, stayed = view(TURN, STEP), view(TURN, np.zeros(3))
    unmatched = third_of(view(*BACK))
    unmatched.noise[3:] = np.nan
    for seen, third, said in (
        (stayed, third_of(view(*BACK)), "has not travelled from the key frame to the target"),
        (went, third_of(view(BACK[0], np.zeros(3))), "has not travelled from the key frame to it"),
        (went, unmatched, "too little of what is still is found in it"),
    ):
        world = solved_regions(seen.seen(), 2.0)
        found = with_third(world, seen.seen(), third)
        (line,) = found.notes
        assert line.startswith("the third frame adds nothing: ")
        assert said in line
        np.testing.assert_array_equal(found.inverse_depth, world.inverse_depth)


def test_a_third_frame_without_depth_in_common_is_said_to_add_nothing():
    seen = view(TURN, STEP).seen()
    world = still_world(seen)
    world = replace(world, inverse_depth=np.full_like(world.inverse_depth, np.nan))
    found = with_third(world, seen, third_of(view(*BACK)))
    (line,) = found.notes
    assert "too little has depth both in it and in the target" in line


def test_a_third_frame_that_helps_needs_no_words():
    seen = view(TURN, STEP)
    world = solved_regions(seen.seen(), 2.0)
    assert with_third(world, seen.seen(), third_of(view(*BACK))).notes == ()
