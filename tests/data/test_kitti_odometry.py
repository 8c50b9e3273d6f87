import numpy as np
import pytest

from flexdepth.data.kitti_odometry import KittiOdometry
from flexdepth.runtime.errors import InputError

CALIBRATION = """P0: 700 0 600 0 0 700 180 0 0 0 1 0
P1: 700 0 600 -378 0 700 180 0 0 0 1 0
P2: 700 0 600 42 0 700 180 0 0 0 1 0
P3: 700 0 600 -336 0 700 180 0 0 0 1 0
"""


@pytest.fixture
def drive(tmp_path, picture):
    for camera in (0, 1):
        for number in (0, 1):
            picture(tmp_path / "sequences/06" / f"image_{camera}" / f"{number:06d}.png", 12, 4)
    (tmp_path / "sequences/06/calib.txt").write_text(CALIBRATION)
    (tmp_path / "poses").mkdir()
    (tmp_path / "poses/06.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 2 0 0 1 3\n")
    return tmp_path


def test_each_image_has_its_pose_and_the_right_camera_stands_to_the_right(drive):
    left, right = (KittiOdometry(drive, 6, camera).load() for camera in (0, 1))
    assert len(left) == 2
    assert left[1].name == "06_000001"
    assert left[1].world_from_camera[:3, 3].tolist() == [1, 2, 3]
    # P1 holds -f b = -378 for f = 700.
    np.testing.assert_allclose(right[1].world_from_camera[:3, 3], [1.54, 2, 3])
    assert (left[0].camera.focal_x, left[0].camera.centre_x) == (700, 600.5)


def test_images_beyond_the_poses_and_missing_cameras_are_named(drive):
    (drive / "poses/06.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
    with pytest.raises(InputError, match=r"06\.txt: holds 1 poses, but .*000001\.png needs more"):
        KittiOdometry(drive, 6, 0).load()
    (drive / "sequences/06/calib.txt").write_text(CALIBRATION.replace("P0", "Q0"))
    (drive / "poses/06.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n" * 2)
    with pytest.raises(InputError, match=r"calib\.txt: wanted P0, 12 numbers, got 0"):
        KittiOdometry(drive, 6, 0).load()


def test_the_real_car_drives_forward(tmp_path, samples):
    real = samples / "driving_kitti_odometry_gray51"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    folder = tmp_path / "sequences" / "06"
    folder.mkdir(parents=True)
    (folder / "image_0").symlink_to(real / "image_l")
    rows = (real / "calib.txt").read_text().splitlines()
    (folder / "calib.txt").write_text("".join(f"P{n}: {row}\n" for n, row in enumerate(rows[:2])))
    (tmp_path / "poses").mkdir()
    (tmp_path / "poses" / "06.txt").symlink_to(real / "poses.txt")
    views = KittiOdometry(tmp_path, 6, 0).load()
    assert len(views) == 51
    assert views[0].image.shape == (370, 1226, 3)
    step = np.linalg.inv(views[0].world_from_camera) @ views[1].world_from_camera
    assert 1.0 < step[2, 3] < 1.4
    assert np.abs(step[:2, 3]).max() < 0.1
