import json

import numpy as np
import pytest

from flexdepth.data.cityscapes import Cityscapes, CityscapesSplit, read_camera
from flexdepth.runtime.errors import InputError

STEM = "aachen_000000_000019"
CAMERA = {
    "extrinsic": {"baseline": 0.2, "pitch": 0.03},
    "intrinsic": {"fx": 2000.0, "fy": 2100.0, "u0": 1000.0, "v0": 500.0},
}


@pytest.fixture
def street(tmp_path, picture, codes):
    def path(kind, end):
        return tmp_path / kind / "train" / "aachen" / f"{STEM}_{end}"

    picture(path("leftImg8bit", "leftImg8bit.png"), 2048, 1024)
    stored = np.zeros((1024, 2048))
    stored[0, :3] = 1, 257, 256 * 40 + 1
    codes(path("disparity", "disparity.png"), stored)
    path("camera", "camera.json").parent.mkdir(parents=True)
    path("camera", "camera.json").write_text(json.dumps(CAMERA))
    return path


@pytest.mark.usefixtures("street")
def test_a_code_less_one_is_the_disparity_in_256ths(tmp_path):
    truth = Cityscapes(tmp_path).load()[0].truth
    assert np.argwhere(truth.valid).tolist() == [[0, 1], [0, 2]]
    np.testing.assert_allclose(truth.values[0, 1:3], [400.0, 10.0])
    camera = truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (
        2000,
        2100,
        1000.5,
        500.5,
    )


@pytest.mark.parametrize(
    ("kind", "end"),
    [("leftImg8bit", "leftImg8bit.png"), ("disparity", "disparity.png"), ("camera", "camera.json")],
)
def test_a_frame_that_lacks_something_is_named(tmp_path, street, kind, end):
    for other in ("leftImg8bit.png", "disparity.png", "camera.json"):
        path = street(other.split(".")[0], other)
        path.with_name(path.name.replace("019", "020")).write_bytes(path.read_bytes())
    street(kind, end).unlink()
    with pytest.raises(InputError, match=rf"{STEM}_\w+\.\w+: has no partner"):
        Cityscapes(tmp_path).load()


def test_another_split_and_a_camera_without_a_baseline_are_named(tmp_path, street):
    with pytest.raises(InputError, match="leftImg8bit/val: no such folder"):
        Cityscapes(tmp_path, CityscapesSplit.VAL).load()
    path = street("camera", "camera.json")
    for record, complaint in (
        ({**CAMERA, "extrinsic": {}}, "wanted intrinsic fx, fy, u0, v0 and extrinsic baseline"),
        ({**CAMERA, "extrinsic": {"baseline": 0}}, "wanted a baseline > 0"),
        ([], "a JSON record, got list"),
    ):
        path.write_text(json.dumps(record))
        with pytest.raises(InputError, match=rf"camera\.json: .*{complaint}"):
            read_camera(path)
    path.write_text("{")
    with pytest.raises(InputError, match=r"camera\.json: wanted a camera of Cityscapes in JSON"):
        read_camera(path)
