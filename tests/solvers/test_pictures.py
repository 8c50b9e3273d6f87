import numpy as np
import pytest

from flexdepth.solvers.criterion import MotionKind
from flexdepth.solvers.ego_motion import CameraMotion
from flexdepth.solvers.pictures import standing, told_by_pictures
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.things import Sight

SIZE = 60, 80
FOCAL = np.array([80.0, 80.0])


@pytest.fixture
def camera():
    """A camera that has gone to the right."""
    pose = Pose(np.eye(3), np.array([-1.0, 0.0, 0.0]))
    return CameraMotion(MotionKind.GENERAL, pose, None, None, {}, 1.0, 1.0)


def sight_of(flow: np.ndarray) -> Sight:
    """Return what is seen where flow is known everywhere."""
    row, column = np.mgrid[: SIZE[0], : SIZE[1]] + 0.5
    rays = np.ones((*SIZE, 3))
    rays[..., 0], rays[..., 1] = (column - 40) / 80, (row - 30) / 80
    there = rays.copy()
    there[..., :2] += flow / 80
    return Sight(rays, there, flow, np.full(SIZE, 0.1), np.ones(SIZE, bool), FOCAL)


def test_what_has_texture_moves_and_what_has_none_is_not_known_to(camera):
    key = np.random.default_rng(0).integers(0, 256, SIZE).astype(np.uint8)
    key[:20] = 200  # A sky.
    target = np.roll(key, -2, axis=1)  # Flow of what stands: 2 pixels to the left.
    target[30:50, 20:40] = key[27:47, 22:42]  # A thing has gone 3 down as well.
    flow = np.zeros((*SIZE, 2))
    flow[..., 0] = -2
    labels = np.zeros(SIZE, np.int32)
    labels[5:15, 20:60], labels[27:47, 22:42] = 1, 2
    flow[5:15, 20:60, 1], flow[27:47, 22:42, 1] = 2, 3
    frames = tuple(np.repeat(each[..., None], 3, axis=2) for each in (key, target))
    told = told_by_pictures(labels, sight_of(flow), standing(sight_of(flow), camera), frames)
    assert (told[5:15, 20:60] == 0).all()
    assert (told[27:47, 22:42] == 2).all()
