import struct
from pathlib import Path

import numpy as np
import pytest

from flexdepth.data.stated_folder import Measure, StatedFolder
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth


@pytest.fixture
def folder(tmp_path, picture, codes):
    for name in ("a", "b"):
        picture(tmp_path / "image" / f"{name}.jpg", 4, 2)
        codes(tmp_path / "depth" / f"{name}.png", [[0, 512, 65535, 60000], [1024] * 4])
    return tmp_path


def test_numbers_mean_what_is_stated(folder):
    setting = StatedFolder(
        folder, metres=1 / 512, unknown=(65535.0,), sky=60000.0, camera=(3.0, 4.0, 1.5, 0.5)
    )
    pairs = setting.load()
    assert [file.name for file in pairs.files] == ["a", "b"]
    nan, inf = np.nan, np.inf
    np.testing.assert_array_equal(pairs[1].truth.values, [[nan, 1, nan, inf], [2, 2, 2, 2]])
    camera = pairs[1].truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (3, 4, 2, 1)
    assert StatedFolder(folder).load()[0].truth.intrinsics is None


def test_distances_along_rays_become_depth(folder):
    setting = StatedFolder(
        folder, metres=1 / 512, measure=Measure.DISTANCE, camera=(3.0, 3.0, 1.5, 0.5)
    )
    # Pixel (3, 1): 1.5 right and 0.5 down for f = 3.
    assert setting.load()[0].truth.values[1, 3] == pytest.approx(2 / np.sqrt(1 + 0.25 + 1 / 36))
    with pytest.raises(InputError, match="distances along rays need the camera"):
        StatedFolder(folder, measure=Measure.DISTANCE).load()


def test_names_may_differ_in_all_but_their_groups(tmp_path, picture, codes):
    picture(tmp_path / "s1" / "rgb" / "frame_0001_c.png", 4, 2)
    codes(tmp_path / "s1" / "d" / "depth0001.png", width=4, height=2)
    setting = StatedFolder(
        tmp_path / "s1",
        Path("rgb"),
        Path("d"),
        image_name=r"frame_(\d+)_c\.png",
        depth_name=r"depth(\d+)\.png",
    )
    assert setting.load()[0].name == "0001"


def test_files_that_say_their_own_meaning_are_left_to_the_folder_that_reads_it(folder):
    depth = DepthMap(np.ones((2, 4), np.float32), Space.METRIC)
    write_depth(folder / "depth" / "a.png", depth)
    with pytest.raises(InputError, match=r"a\.png: says itself what its numbers mean"):
        StatedFolder(folder).load()[0]


def test_poses_and_flow_come_with_the_images(folder):
    (folder / "poses.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 5 0 1 0 0 0 0 1 0\n")
    (folder / "flow").mkdir()
    flow = np.full((2, 4, 2), 0.5, "<f4")
    (folder / "flow" / "a.flo").write_bytes(b"PIEH" + struct.pack("<2i", 4, 2) + flow.tobytes())
    setting = StatedFolder(folder, trajectory=Path("poses.txt"), flow=Path("flow"))
    assert setting.poses()[1][0, 3] == 5
    (pair,) = setting.flows()
    assert (pair.name, pair.occluded) == ("a", None)
    assert (pair.flow == 0.5).all()


def test_what_is_missing_or_was_not_given_is_named(folder):
    (folder / "poses.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
    (folder / "flow").mkdir()
    setting = StatedFolder(folder, trajectory=Path("poses.txt"), flow=Path("flow"))
    with pytest.raises(InputError, match=r"poses\.txt: holds 1 poses for 2 images"):
        setting.poses()
    with pytest.raises(InputError, match=r"a\.jpg: looked for .*a\.flo"):
        setting.flows()
    with pytest.raises(InputError, match="wanted poses"):
        StatedFolder(folder).poses()
    with pytest.raises(InputError, match="wanted flow"):
        StatedFolder(folder).flows()
    with pytest.raises(InputError, match="metres, the value of the stored number 1, is > 0"):
        StatedFolder(folder, metres=0.0).load()
    (folder / "depth" / "b.png").unlink()
    with pytest.raises(InputError, match=r"b\.jpg: has no partner"):
        StatedFolder(folder).load()
