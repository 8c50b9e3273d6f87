import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexdepth.data.folder import Pair
from flexdepth.data.perpendicular import FACTORS, flat_patches, right_angles
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space

IMAGE = np.zeros((480, 640, 3), np.uint8)


def plane(normal, distance, focal=500.0, centre=(320.0, 240.0), stretch=1.0):
    """Return the depth of the plane normal · X = distance."""
    camera = Intrinsics(focal, focal * stretch, *centre, FocalSource.GIVEN)
    column, row = np.meshgrid(np.arange(640) + 0.5, np.arange(480) + 0.5)
    across = (column - camera.centre_x) / camera.focal_x
    down = (row - camera.centre_y) / camera.focal_y
    slope = normal[0] * across + normal[1] * down + normal[2]
    depth = np.where(slope > 1e-3, distance / np.where(slope > 1e-3, slope, 1), np.nan)
    return Pair("a", IMAGE, DepthMap(depth.astype(np.float32), Space.METRIC, camera))


@settings(max_examples=15)
@given(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(1, 9), st.floats(0.8, 1.2))
def test_a_patch_has_the_normal_of_its_plane(x, y, distance, stretch):
    normal = np.array([x, y, 1.0])
    found = flat_patches(plane(normal, distance, centre=(300.0, 250.0), stretch=stretch))
    assert len(found) == 30 * 40
    # With the camera's own focal length (a f, b f, c) is normal / distance.
    np.testing.assert_allclose(found, np.tile(normal / distance, (1200, 1)), atol=2e-3)


def test_bent_and_holey_patches_are_left_out():
    pair = plane((0, 0, 1), 2.0)
    values = pair.truth.values.copy()
    values[:16, :16] = np.nan
    values[16:32, :16] += np.linspace(0, 1, 16, dtype=np.float32) ** 2
    bent = Pair("a", IMAGE, DepthMap(values, Space.METRIC, pair.truth.intrinsics))
    assert len(flat_patches(bent)) == 30 * 40 - 2
    lost = Pair("a", IMAGE, DepthMap(values, Space.METRIC))
    assert len(flat_patches(lost)) == 0
    assert right_angles(lost) is None


@pytest.mark.parametrize("wrong", [0.6, 1.0, 1.5])
def test_rooms_have_most_right_angles_at_their_true_focal_length(rooms, wrong):
    shares = []
    for pair in rooms:
        camera = pair.truth.intrinsics
        stated = Intrinsics(
            camera.focal_x * wrong,
            camera.focal_y * wrong,
            camera.centre_x,
            camera.centre_y,
            FocalSource.GIVEN,
        )
        truth = DepthMap(pair.truth.values, Space.METRIC, stated)
        shares.append(right_angles(Pair(pair.name, pair.image, truth)))
    best = FACTORS[np.mean(shares, axis=0).argmax()]
    assert best == pytest.approx(1 / wrong, rel=0.05)


def test_a_single_wall_has_no_right_angles():
    assert right_angles(plane((0.2, 0.1, 1.0), 3.0)).max() == 0
