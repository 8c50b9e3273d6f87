import numpy as np
import pytest

from flexdepth.data.mid_air import MidAir, MidAirDepth
from flexdepth.runtime.errors import InputError


def test_half_floats_are_distances_and_the_infinite_is_sky(tmp_path, picture, codes):
    picture(tmp_path / "color_left" / "trajectory_0003" / "000007.JPEG", 1024, 1024)
    metres = np.full((1024, 1024), 100, np.float16)
    metres[0, 0] = np.inf
    codes(tmp_path / "depth" / "trajectory_0003" / "000007.PNG", metres.view(np.uint16))
    (pair,) = MidAir(tmp_path).load()
    assert pair.name == "trajectory_0003_000007"
    assert np.argwhere(pair.truth.sky).tolist() == [[0, 0]]
    # The last pixel of a row in the middle: its ray leads 511.5 right and 0.5 down for f = 512.
    edge = 100 / np.sqrt(1 + (511.5**2 + 0.5**2) / 512**2)
    assert pair.truth.values[512, 1023] == pytest.approx(edge, rel=1e-6)
    assert (pair.truth.intrinsics.focal_x, pair.truth.intrinsics.centre_x) == (512, 512)
    (plain,) = MidAir(tmp_path, MidAirDepth.DEPTH).load()
    assert plain.truth.values[512, 1023] == 100


def test_a_frame_without_a_partner_is_named(tmp_path, picture, codes):
    picture(tmp_path / "color_left" / "trajectory_0003" / "000007.JPEG", 8, 8)
    codes(tmp_path / "depth" / "trajectory_0003" / "000008.PNG")
    with pytest.raises(InputError, match=r"000007\.JPEG: has no partner"):
        MidAir(tmp_path).load()
