import h5py
import numpy as np
import pytest

from flexdepth.data.megadepth import MegaDepth, MegaDepthOrdinal
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError


@pytest.fixture
def landmark(tmp_path, picture):
    dense = tmp_path / "0000" / "dense0"
    for name, depth in (("a_o", [[0, 2.5], [7, 1]]), ("b_o", [[0, -1], [-2, -2]])):
        picture(dense / "imgs" / f"{name}.jpg", 2, 2)
        (dense / "depths").mkdir(exist_ok=True)
        with h5py.File(dense / "depths" / f"{name}.h5", "w") as file:
            file["depth"] = np.array(depth, np.float32)
    return dense


def test_depth_is_right_up_to_a_factor_and_an_order_is_no_depth(landmark):
    depth, order = MegaDepth(landmark.parents[1]).load()
    assert depth.name == "0000_dense0_a_o"
    assert depth.truth.space is Space.SCALE
    np.testing.assert_array_equal(depth.truth.values, [[np.nan, 2.5], [7, 1]])
    assert not order.truth.valid.any()


def test_an_order_is_two_regions(landmark):
    depth, order = MegaDepthOrdinal(landmark.parents[1]).load()
    assert order.nearer.tolist() == [[False, True], [False, False]]
    assert order.farther.tolist() == [[False, False], [True, True]]
    assert not (depth.nearer | depth.farther).any()


def test_missing_damaged_and_resized_files_are_named(landmark, picture):
    root = landmark.parents[1]
    picture(landmark / "imgs" / "b_o.jpg", 3, 2)
    for setting in (MegaDepth, MegaDepthOrdinal):
        with pytest.raises(InputError, match=r"b_o\.h5: holds 2x2 values"):
            setting(root).load()[1]
    path = landmark / "depths" / "a_o.h5"
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(InputError, match=r"a_o\.h5: cannot be read"):
        MegaDepth(root).load()[0]
    path.unlink()
    with pytest.raises(InputError, match=r"a_o\.jpg: has no partner"):
        MegaDepth(root).load()
