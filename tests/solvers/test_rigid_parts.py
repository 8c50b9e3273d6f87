"""A rigid thing that was taken for a part of what bends."""

import cv2
import numpy as np

from flexdepth.solvers.answer import Kind
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.region_motion import region_motion
from flexdepth.solvers.rigid_parts import split
from flexdepth.solvers.sight import Sight

HEIGHT, WIDTH, FOCAL = 60, 80, 70.0
STILL = Pose(np.eye(3), np.array([0.3, 0.0, 0.0]))
LEFT = np.arange(WIDTH)[None] < 40 + np.zeros((HEIGHT, 1))


def sight(noise, *, bends):
    """Return two halves: the left moves by one pose before a slanted plane, the right may bend."""
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    key = np.stack([(column - 40) / FOCAL, (row - 30) / FOCAL, np.ones((HEIGHT, WIDTH))], -1)
    inverse = 1 + 0.3 * key[..., 0] + 0.2 * np.sin(6 * key[..., 1])
    turn = cv2.Rodrigues(np.array([0.0, 0.05, 0.02]))[0]
    there = key @ turn.T + inverse[..., None] * (0.05, 0.02, 0.01)
    target = there / there[..., 2:]
    if bends:
        target[..., 1] += np.where(LEFT, 0.0, 0.03 * np.sin(25 * key[..., 0] + 15 * key[..., 1]))
    target[..., :2] += np.random.default_rng(0).normal(0, noise / FOCAL, (HEIGHT, WIDTH, 2))
    flow = (target - key)[..., :2] * FOCAL
    known = np.ones((HEIGHT, WIDTH), bool)
    return Sight(key, target, flow, np.full(known.shape, noise), known, np.full(2, FOCAL))


def parted(seen):
    labels = np.ones((HEIGHT, WIDTH), np.int32)
    motion = region_motion(seen.pixels(labels == 1), STILL, 0.01)
    cut = np.where(LEFT, 3, 5).astype(np.int32)
    return split(labels, {1: motion}, cut, seen, (STILL, 0.01))


def test_a_rigid_half_leaves_the_half_that_bends():
    labels, motions = parted(sight(0.02, bends=True))
    np.testing.assert_array_equal(labels, np.where(LEFT, 2, 1))
    assert (motions[1].kind, motions[2].kind) == (Kind.FLEXIBLE, Kind.RIGID)


def test_what_is_rigid_is_left_whole():
    labels, motions = parted(sight(0.02, bends=False))
    assert (labels == 1).all()
    assert list(motions) == [1]
