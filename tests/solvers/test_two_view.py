import numpy as np
import pytest

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.two_view import static_depth

SMALL = Intrinsics(100.0, 100.0, 30.0, 20.0, FocalSource.GIVEN)
RIGHT = Pose(np.eye(3), np.array([-1.0, 0, 0]))
"""The camera goes right by 1: points go left in it."""
FORWARD = Pose(np.eye(3), np.array([0.0, 0, -1]))


def flow_of(depth, pose, camera=SMALL):
    row, column = np.mgrid[: depth.shape[0], : depth.shape[1]] + 0.5
    x = (column - camera.centre_x) / camera.focal_x * depth
    y = (row - camera.centre_y) / camera.focal_y * depth
    there = np.stack([x, y, depth], -1) @ pose.rotation.T + pose.translation
    across = camera.focal_x * there[..., 0] / there[..., 2] + camera.centre_x - column
    return np.stack(
        [across, camera.focal_y * there[..., 1] / there[..., 2] + camera.centre_y - row], -1
    ).astype(np.float32)


def quiet(shape, noise=1e-3):
    return np.full(shape, noise, np.float32)


def test_a_step_to_the_side_shows_focal_over_depth():
    flow = np.full((40, 60, 2), (-5, 0), np.float32)
    found = static_depth(flow, quiet((40, 60), 0.5), SMALL, RIGHT)
    np.testing.assert_allclose(found.parallax, 5, rtol=1e-6)
    np.testing.assert_allclose(found.depth, 20, rtol=1e-6)
    # 0.5 px of 5.
    np.testing.assert_allclose(found.spread, 0.1, rtol=1e-6)
    assert found.valid.all()


def test_any_motion_gives_the_depth_of_a_scene_back(rotation):
    depth = np.random.default_rng(0).uniform(3, 12, (40, 60))
    for away in ((0.3, -0.2, 0.9), (0, 0, -1), (0.8, 0.6, 0)):
        pose = Pose(rotation, np.array(away))
        found = static_depth(flow_of(depth, pose), quiet((40, 60)), SMALL, pose)
        assert found.valid.mean() > 0.97
        np.testing.assert_allclose(found.depth[found.valid], depth[found.valid], rtol=1e-2)
        assert np.abs(found.across).max() < 1e-4


def test_depth_is_not_invented_where_the_camera_drives_to():
    found = static_depth(
        flow_of(np.full((40, 60), 10.0), FORWARD), quiet((40, 60), 0.2), SMALL, FORWARD
    )
    row, column = np.mgrid[:40, :60] + 0.5
    # At depth 10 a point moves outwards by a ninth of its distance from the middle; 0.4 px are
    # wanted, so 3.6 pixels around it are left out.
    distance = np.hypot(row - 20, column - 30)
    np.testing.assert_array_equal(found.valid, distance / 9 > 0.4)
    assert np.isnan(found.depth[~found.valid]).all()
    assert (found.spread[~found.valid] > 0.4).all()


def test_the_spread_is_that_of_depths_under_noise():
    random = np.random.default_rng(0)
    pose = Pose(np.eye(3), np.array([-0.8, 0, -0.6]))
    flow = flow_of(np.full((40, 60), 8.0), pose)
    noisy = flow + random.normal(0, 0.1, flow.shape).astype(np.float32)
    found = static_depth(noisy, quiet((40, 60), 0.1), SMALL, pose)
    off = (found.depth - 8) / 8 / found.spread
    assert np.std(off[found.spread < 0.1]) == pytest.approx(1, abs=0.1)
    assert found.across.std() == pytest.approx(0.1, abs=0.01)


def test_points_behind_the_camera_have_no_depth():
    backwards = np.full((40, 60, 2), (5, 0), np.float32)
    found = static_depth(backwards, quiet((40, 60)), SMALL, RIGHT)
    np.testing.assert_allclose(found.parallax, -5, rtol=1e-6)
    assert not found.valid.any()


def test_a_camera_that_has_stayed_tells_no_depth(rotation):
    for turned in (np.eye(3), rotation):
        stayed = Pose(turned, np.zeros(3))
        flow = flow_of(np.full((40, 60), 5.0), stayed)
        flow[3, 4] += (3, 4)
        found = static_depth(flow, quiet((40, 60)), SMALL, stayed)
        assert not found.valid.any()
        assert (found.parallax == 0).all()
        assert np.isnan(found.depth).all()
        assert np.isinf(found.spread).all()
        assert found.across[3, 4] == pytest.approx(5, abs=1e-4)
        assert np.delete(found.across, 3 * 60 + 4).max() < 1e-4


@pytest.mark.parametrize("pose", [RIGHT, Pose(np.eye(3), np.zeros(3))])
def test_unknown_flow_stays_unknown(pose):
    flow = np.full((40, 60, 2), (-5, 0), np.float32)
    flow[0, 0] = np.nan
    noise = quiet((40, 60))
    noise[1, 1] = np.nan
    found = static_depth(flow, noise, SMALL, pose)
    for at in ((0, 0), (1, 1)):
        assert not found.valid[at]
        assert np.isnan([found.depth[at], found.parallax[at], found.across[at]]).all()
        assert np.isinf(found.spread[at])
