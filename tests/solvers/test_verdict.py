from dataclasses import replace

import numpy as np
import pytest

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.solvers.answer import Evidence, Kind, Region, Unknown
from flexdepth.solvers.criterion import MotionKind
from flexdepth.solvers.ego_motion import CameraMotion
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.verdict import answer
from flexdepth.solvers.world import World, sight_of

SHAPE = 6, 8
CAMERA = Intrinsics.centred(8, 6, 10.0, FocalSource.GIVEN)
WENT = CameraMotion(
    MotionKind.GENERAL, Pose(np.eye(3), np.array([-1.0, 0, 0])), None, None, {}, 1.0, 1.0
)


@pytest.fixture
def seen():
    """Flow of 2 pixels to the left: none in the first row, not to be trusted in the second."""
    flow, noise = np.tile(np.float32((-2, 0)), (*SHAPE, 1)), np.full(SHAPE, 0.1, np.float32)
    flow[0], noise[1] = np.nan, np.nan
    return Seen(flow, noise, CAMERA)


def world_of(sight):
    """Return a still world of which nothing is known, the camera's way apart."""
    return World(
        sight,
        WENT,
        np.zeros(SHAPE, np.int32),
        (Region(0, Kind.STATIC, Evidence.CAMERA, 1.0, 0.0, 48),),
        np.full(SHAPE, np.nan),
        np.full(SHAPE, np.inf),
        np.broadcast_to(np.eye(3), (*SHAPE, 3, 3)),
        np.broadcast_to((-1.0, 0.0, 0.0), (*SHAPE, 3)),
    )


def test_what_has_no_flow_or_none_to_be_trusted_says_so(seen):
    found = answer(world_of(sight_of(seen)), seen, 2.0)
    said = (Unknown.NO_FLOW, Unknown.OCCLUDED, *[Unknown.LOW_PARALLAX] * 4)
    np.testing.assert_array_equal(found.unknown, np.tile(said, (8, 1)).T)


def test_the_reason_goes_by_the_flow_that_was_used(seen):
    sight = sight_of(seen)
    trusted = sight.trusted.copy()
    # A second look has found the first two rows, and parted with the third.
    trusted[:2], trusted[2] = True, False
    found = answer(world_of(replace(sight, trusted=trusted)), seen, 2.0)
    assert (found.unknown[:2] == Unknown.LOW_PARALLAX).all()
    assert (found.unknown[2] == Unknown.OCCLUDED).all()
    np.testing.assert_array_equal(found.unknown == Unknown.OCCLUDED, np.isnan(found.noise))
