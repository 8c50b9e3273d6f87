import numpy as np
import pytest

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.solvers.two_frame import Seen, TwoFrameSettings, Unknown, two_frame

CAMERA = Intrinsics.centred(80, 60, 70.0, FocalSource.GIVEN)
REGIONS = TwoFrameSettings(dense=None)


def rays(camera=CAMERA, shape=(60, 80)):
    row, column = np.mgrid[: shape[0], : shape[1]] + 0.5
    x = (column - camera.centre_x) / camera.focal_x
    y = (row - camera.centre_y) / camera.focal_y
    return np.stack([x, y, np.ones_like(x)], -1)


def flow_to(there, camera=CAMERA):
    """Return the flow of the pixels whose points are at `there` in the target camera."""
    said = there[..., :2] / there[..., 2:]
    shift = said - rays(camera, there.shape[:2])[..., :2]
    return (shift * (camera.focal_x, camera.focal_y)).astype(np.float32)


def relief(seed=0):
    """Return smooth depth between 3 and 9."""
    row, column = np.mgrid[:60, :80] / 60
    phase = np.random.default_rng(seed).uniform(0, 6, 2)
    return 6 + 1.5 * np.sin(5 * column + phase[0]) + 1.5 * np.cos(4 * row + phase[1])


def quiet(flow, noise=0.01):
    return Seen(flow, np.full(flow.shape[:2], noise, np.float32), CAMERA)


def test_a_still_world_is_one_region_with_its_depth(rotation):
    depth, away = relief(), np.array([0.3, -0.2, 0.1])
    seen = quiet(flow_to(rays() * depth[..., None] @ rotation.T + away))
    found = two_frame(seen, REGIONS)
    assert found.valid.mean() > 0.99
    np.testing.assert_allclose(
        found.depth[found.valid] * np.linalg.norm(away), depth[found.valid], rtol=1e-2
    )
    assert not found.moving.any()
    assert len(found.regions) == 1
    assert np.nanmax(found.residual) < 1e-2


def test_what_has_no_depth_says_why(rotation):
    depth = relief()
    flow = flow_to(rays() * depth[..., None] @ rotation.T + (0.3, -0.2, 0.1))
    flow[5, 7] = np.nan
    noise = np.full(depth.shape, 0.01, np.float32)
    noise[9, 9] = np.nan
    found = two_frame(Seen(flow, noise, CAMERA), REGIONS)
    assert found.unknown[5, 7] == Unknown.NO_FLOW
    assert found.unknown[9, 9] == Unknown.OCCLUDED
    assert np.isnan(found.depth[5, 7])


def test_a_camera_that_stays_leaves_all_without_parallax(rotation):
    seen = quiet(flow_to(rays() @ rotation.T))
    found = two_frame(seen, REGIONS)
    assert (found.unknown == Unknown.LOW_PARALLAX).all()
    assert np.isnan(found.depth).all()
    assert np.isinf(found.spread).all()


def test_maps_of_other_sizes_are_refused():
    flow = np.zeros((60, 80, 2), np.float32)
    with pytest.raises(InputError, match="flow of 60x79"):
        Seen(flow, np.ones((60, 79), np.float32), CAMERA)
    with pytest.raises(InputError, match="above 0"):
        Seen(flow, np.zeros((60, 80), np.float32), CAMERA)
