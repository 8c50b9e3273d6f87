import numpy as np
import pytest

from flexdepth.runtime.errors import InputError
from flexdepth.solvers.correspondences import Correspondences, from_flow, pixel_centres, rays


def test_the_first_pixel_is_seen_half_a_pixel_from_the_corner(camera):
    assert pixel_centres(3, 4)[0, 0].tolist() == [0.5, 0.5]
    assert pixel_centres(3, 4)[2, 1].tolist() == [1.5, 2.5]
    np.testing.assert_allclose(rays(np.array([320.0, 240.0]), camera), (0, 0, 1))
    np.testing.assert_allclose(rays(np.array([820.0, -20.0]), camera), (1, -0.5, 1))


def test_flow_is_thinned_to_a_grid_of_valid_pixels(camera):
    flow = np.full((40, 60, 2), (3, -1), np.float32)
    valid = np.ones((40, 60), bool)
    valid[:20] = False
    flow[~valid] = np.nan
    noise = np.where(valid, np.float32(0.25), np.float32(np.nan))
    seen = from_flow(flow, valid, noise, camera, most=300)
    assert len(seen) == 300
    assert (seen.key[:, 1] > 20).all()
    np.testing.assert_allclose(seen.target - seen.key, [[3, -1]] * 300)
    np.testing.assert_allclose(seen.noise, 0.25)
    assert len(from_flow(flow, valid, noise, camera)) == 1200


def test_the_noisiest_flow_of_each_part_tells_no_motion(camera):
    flow = np.zeros((40, 60, 2), np.float32)
    noise = np.tile(np.linspace(0.1, 1, 10, dtype=np.float32)[:, None], (4, 60))
    noise[:20] *= 100
    seen = from_flow(flow, np.ones((40, 60), bool), noise, camera)
    assert len(seen) == 32 * 60
    np.testing.assert_allclose(seen.noise.max(), 80)
    np.testing.assert_allclose(np.unique(seen.key[:, 1] // 10), range(4))


def test_what_no_motion_can_be_found_from_is_refused(camera):
    key, noise = np.random.default_rng(0).uniform(0, 480, (20, 2)), np.full(20, 0.1)
    with pytest.raises(InputError, match=r"at least 16 points .* got 15"):
        Correspondences(key[:15], key[:15], noise[:15], camera)
    with pytest.raises(InputError, match="must be finite"):
        Correspondences(key, np.where(key > 400, np.nan, key), noise, camera)
    for wrong in (0.0, -1.0, np.nan):
        with pytest.raises(InputError, match="noise of matched points must be finite and above 0"):
            Correspondences(key, key, np.full(20, wrong), camera)
    with pytest.raises(InputError, match="got 0"):
        from_flow(
            np.zeros((9, 9, 2), np.float32),
            np.zeros((9, 9), bool),
            np.ones((9, 9), np.float32),
            camera,
        )
