import numpy as np
import pytest

from flexdepth.data.kitti_velodyne import KittiObject, KittiVelodyne, LaserDepth, read_scan, seen
from flexdepth.runtime.errors import InputError

DATE, DRIVE = "2011_09_26", "2011_09_26_drive_0001_sync"
CAMERAS = """S_rect_02: 12 4
R_rect_00: 1 0 0 0 1 0 0 0 1
P_rect_02: 10 0 6 0 0 10 2 0 0 0 1 0
S_rect_03: 12 4
P_rect_03: 10 0 6 -5 0 10 2 0 0 0 1 0
"""
# The laser looks along x with y to the left and z up; the camera stands 0.27 m ahead of it.
LASER = "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 -0.27\n"
OBJECT = """P2: 10 0 6 0 0 10 2 0 0 0 1 0
R0_rect: 1 0 0 0 1 0 0 0 1
Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 -0.27
"""


def write_scan(path, points):
    path.parent.mkdir(parents=True, exist_ok=True)
    np.array([[*point, 0.5] for point in points], "<f4").tofile(path)


@pytest.fixture
def raw(tmp_path, picture):
    date = tmp_path / DATE
    drive = date / DRIVE
    for camera in ("02", "03"):
        picture(drive / f"image_{camera}" / "data" / "0000000005.png", 12, 4)
    write_scan(
        drive / "velodyne_points" / "data" / "0000000005.bin",
        [(5.27, 0.0, 0.0), (10.27, 0.0, 0.0), (-3.0, 0.0, 0.0), (5.27, 1.0, 0.0)],
    )
    (date / "calib_cam_to_cam.txt").write_text(CAMERAS)
    (date / "calib_velo_to_cam.txt").write_text(LASER)
    (tmp_path / "test_files.txt").write_text(f"{DATE}/{DRIVE} 5 l\n")
    return tmp_path


def test_a_point_ahead_lands_in_the_pixel_of_the_principal_point(raw):
    truth = KittiVelodyne(raw).load()[0].truth
    # Of the two points ahead the nearer counts; one metre to the left at five metres is two pixels.
    assert np.argwhere(truth.valid).tolist() == [[2, 4], [2, 6]]
    np.testing.assert_allclose(truth.values[2, [4, 6]], 5.0, rtol=1e-6)
    assert (truth.intrinsics.centre_x, truth.intrinsics.centre_y) == (6.5, 2.5)


def test_monodepth2_counts_from_the_laser_and_one_pixel_up_and_left(raw):
    truth = KittiVelodyne(raw, depth=LaserDepth.MONODEPTH2).load()[0].truth
    assert np.argwhere(truth.valid).tolist() == [[1, 3], [1, 5]]
    np.testing.assert_allclose(truth.values[1, [3, 5]], 5.27, rtol=1e-6)


def test_the_right_camera_sees_things_farther_to_the_left(raw):
    (raw / "test_files.txt").write_text(f"{DATE}/{DRIVE}/image_03/data/0000000005.png x 7\n")
    pair = KittiVelodyne(raw).load()[0]
    assert pair.name == f"{DRIVE}_image_03_0000000005"
    # Half a metre of baseline is one pixel at five metres, and half a pixel at ten.
    assert np.argwhere(pair.truth.valid).tolist() == [[2, 3], [2, 5], [2, 6]]


@pytest.mark.parametrize(
    ("lost", "complaint"),
    [
        (f"{DATE}/{DRIVE}/image_02/data/0000000005.png", "line 1: looked for .*0000000005.png or"),
        (f"{DATE}/{DRIVE}/velodyne_points/data/0000000005.bin", "line 1: looked for .*005.bin"),
        (f"{DATE}/calib_velo_to_cam.txt", "calib_velo_to_cam.txt: no such file"),
        (f"{DATE}/calib_cam_to_cam.txt", "calib_cam_to_cam.txt: no such"),
    ],
)
def test_a_missing_file_is_named(raw, lost, complaint):
    (raw / lost).unlink()
    with pytest.raises(InputError, match=complaint):
        KittiVelodyne(raw).load()


def test_a_scan_that_ends_within_a_point_is_named(raw):
    path = raw / DATE / DRIVE / "velodyne_points" / "data" / "0000000005.bin"
    path.write_bytes(path.read_bytes()[:-4])
    with pytest.raises(InputError, match=r"0005\.bin: .* by four are wanted, 15 are there"):
        KittiVelodyne(raw).load()[0]


def test_the_object_set_projects_as_the_raw_drives_do(tmp_path, picture):
    training = tmp_path / "training"
    picture(training / "image_2" / "000007.png", 12, 4)
    write_scan(training / "velodyne" / "000007.bin", [(5.27, 0.0, 0.0)])
    (training / "calib").mkdir()
    (training / "calib" / "000007.txt").write_text(OBJECT)
    truth = KittiObject(tmp_path).load()[0].truth
    assert np.argwhere(truth.valid).tolist() == [[2, 6]]
    assert truth.values[2, 6] == pytest.approx(5.0)
    (training / "calib" / "000007.txt").write_text(OBJECT.replace("R0_rect: 1", "R0_rect:"))
    with pytest.raises(InputError, match=r"000007\.txt: wanted R0_rect, 9 numbers, got 8"):
        KittiObject(tmp_path).load()
    (training / "calib" / "000007.txt").unlink()
    with pytest.raises(InputError, match=r"NNNNNN\.txt; there are none"):
        KittiObject(tmp_path).load()


def test_points_on_the_border_of_two_pixels_belong_to_the_later_one():
    projection = np.array([[0, -1.0, 0, 0], [0, 0, -1.0, 0], [1.0, 0, 0, 0]])
    points = np.array([[1.0, -0.5, -0.49], [1.0, -0.49, -0.5]])
    found = seen(points, projection, (2, 2), LaserDepth.CAMERA)
    assert np.argwhere(np.isfinite(found)).tolist() == [[0, 1], [1, 0]]


def test_real_scans_cover_a_street_in_metres(samples):
    real = samples / "driving_kitti_object"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    pairs = KittiObject(real).load()
    assert len(pairs) == 3
    for pair in pairs:
        known = pair.truth.values[pair.truth.valid]
        assert 0.039 < pair.truth.valid.mean() < 0.046
        assert 2 < known.min() < known.max() < 80
        # The road is nearer the lower it is seen.
        lowest, above = (
            np.nanmedian(pair.truth.values[rows]) for rows in (slice(-40, None), slice(-120, -80))
        )
        assert lowest < 0.7 * above
    scan = read_scan(real / "training" / "velodyne" / "000000.bin")
    assert 110_000 < len(scan) < 130_000
