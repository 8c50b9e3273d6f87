from dataclasses import dataclass

import numpy as np

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.solvers.criterion import MotionKind
from flexdepth.solvers.ego_motion import CameraMotion
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.still import looked_again
from flexdepth.solvers.world import sight_of

SIZE = 40, 50
CAMERA = Intrinsics.centred(50, 40, 60.0, FocalSource.GIVEN)
WENT = CameraMotion(
    MotionKind.GENERAL, Pose(np.eye(3), np.array([-1.0, 0, 0])), None, None, {}, 1.0, 1.0
)
STAYED = CameraMotion(MotionKind.STILL, Pose(np.eye(3), np.zeros(3)), None, None, {}, 1.0, 1.0)


@dataclass
class Found:
    """What a search has found, and what it was told."""

    flow: np.ndarray
    noise: np.ndarray
    told: np.ndarray | None = None

    def __call__(self, _rotation, _translation, flow):
        self.told = flow
        return self


def everything(found):
    """Return two frames with flow of 2 pixels to the left, trusted but for one corner."""
    flow = np.tile(np.float32((-2, 0)), (*SIZE, 1))
    noise = np.full(SIZE, 0.1, np.float32)
    noise[:10, :10] = np.nan
    return Seen(flow, noise, CAMERA, search=found)


def search():
    """Return a search that finds 3 pixels to the left, but not in the last rows."""
    noise = np.full(SIZE, 0.2, np.float32)
    noise[30:] = np.nan
    return Found(np.tile(np.float32((-3, 0)), (*SIZE, 1)), noise)


def test_what_is_found_is_seen_where_nothing_moves():
    found = search()
    seen, labels = everything(found), np.zeros(SIZE, np.int32)
    labels[25:, 20:40] = 1  # Less than half of it may stand still.
    after, sight = looked_again(seen, sight_of(seen), labels, WENT)
    assert np.isnan(found.told[:10, :10]).all()
    assert np.isfinite(found.told[10:]).all()
    np.testing.assert_array_equal(after, labels)
    assert sight.trusted.all()
    assert (sight.flow[:25, :, 0] == -3).all()
    assert (sight.noise[:25] == np.float32(0.2)).all()
    assert (sight.flow[30:, :, 0] == -2).all()
    assert (sight.flow[25:, 20:40, 0] == -2).all()
    np.testing.assert_allclose(sight.target[0, 0, :2], ((0.5 - 3 - 25) / 60, (0.5 - 20) / 60))


def test_what_may_as_well_stand_still_does_not_move():
    seen, labels = everything(search()), np.zeros(SIZE, np.int32)
    labels[10:25, 20:40], labels[32:38, 5:15] = 1, 2
    after, sight = looked_again(seen, sight_of(seen), labels, WENT)
    assert (after[10:25, 20:40] == 0).all()
    assert (after[32:38, 5:15] == 2).all()
    assert (sight.flow[10:25, 20:40, 0] == -3).all()


def test_without_a_search_or_parallax_nothing_changes():
    labels = np.ones(SIZE, np.int32)
    for found, camera in ((None, WENT), (search(), STAYED)):
        seen = everything(found)
        sight = sight_of(seen)
        after, again = looked_again(seen, sight, labels, camera)
        assert after is labels
        assert again is sight
