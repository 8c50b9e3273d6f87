import numpy as np
import pytest

from flexdepth.data.scannet import ScanNet
from flexdepth.runtime.errors import InputError

POSE = "1 0 0 {}\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"


@pytest.fixture
def scan(tmp_path, picture, codes):
    root = tmp_path / "scene0000_00"
    for number in (0, 2, 10):
        picture(root / "color" / f"{number}.jpg", 1296, 968)
        codes(root / "depth" / f"{number}.png", fill=1000 + number)
        (root / "pose").mkdir(exist_ok=True)
        (root / "pose" / f"{number}.txt").write_text(POSE.format(number if number < 10 else "-inf"))
    (root / "intrinsic").mkdir()
    (root / "intrinsic" / "intrinsic_depth.txt").write_text(
        "577.87 0 319.5 0\n0 578 239.5 0\n0 0 1 0\n0 0 0 1\n"
    )
    return root


def test_colour_comes_at_the_size_of_depth_and_frames_by_number(scan):
    pairs = ScanNet(scan).load()
    assert [pairs[n].name for n in range(3)] == [f"scene0000_00_{n:06d}" for n in (0, 2, 10)]
    pair = pairs[2]
    assert pair.image.shape == (480, 640, 3)
    assert pair.truth.values[0, 0] == np.float32(1.01)
    camera = pair.truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (
        577.87,
        578,
        320,
        240,
    )


def test_a_lost_pose_is_none(scan):
    first, second, lost = ScanNet(scan).poses()
    assert (first[0, 3], second[0, 3], lost) == (0, 2, None)


def test_missing_and_resized_files_are_named(scan, picture):
    picture(scan / "color" / "2.jpg", 640, 480)
    with pytest.raises(InputError, match=r"2\.jpg: wanted 1296x968"):
        ScanNet(scan).load()[1]
    (scan / "depth" / "2.png").unlink()
    with pytest.raises(InputError, match=r"2\.jpg: has no partner"):
        ScanNet(scan).load()
    (scan / "intrinsic" / "intrinsic_depth.txt").unlink()
    with pytest.raises(InputError, match=r"intrinsic_depth\.txt: no such file"):
        ScanNet(scan).load()
