import shutil

import cv2
import numpy as np
import pytest

from flexdepth.data.kitti_2015 import Kitti2015Flow, Kitti2015Stereo, read_flow
from flexdepth.runtime.errors import InputError

CALIBRATION = """S_rect_02: {width} {height}
P_rect_02: 720 0 600 40 0 720 180 0 0 0 1 0
P_rect_03: 720 0 600 -320 0 720 180 0 0 0 1 0
"""


@pytest.fixture
def training(tmp_path, picture, codes):
    folder = tmp_path / "training"
    for name in ("000001_10", "000001_11"):
        picture(folder / "image_2" / f"{name}.png", 4, 2)
    codes(folder / "disp_occ_0" / "000001_10.png", [[0, 256 * 36, 0, 0], [0, 0, 0, 128]])
    (folder / "calib_cam_to_cam").mkdir()
    (folder / "calib_cam_to_cam" / "000001.txt").write_text(CALIBRATION.format(width=4, height=2))
    every, visible = (np.zeros((2, 4, 3), np.uint16) for _ in range(2))
    every[0, 0] = (1, 32768 - 128, 32768 + 64)  # blue, green, red: known, v = -2, u = 1
    every[1, 1] = (1, 32768, 32768)
    visible[1, 1] = (1, 32768, 32768)
    for name, flow in (("flow_occ", every), ("flow_noc", visible)):
        (folder / name).mkdir()
        cv2.imwrite(str(folder / name / "000001_10.png"), flow)
    return folder


def test_depth_is_the_baseline_by_the_disparity(training):
    truth = Kitti2015Stereo(training.parent).load()[0].truth
    # (40 + 320) px m / 36 px and / 0.5 px.
    assert truth.values[0, 1] == pytest.approx(10.0)
    assert truth.values[1, 3] == pytest.approx(720.0)
    assert truth.valid.sum() == 2


def test_flow_is_in_64ths_from_the_middle_of_16_bits(training):
    pair = Kitti2015Flow(training.parent).load()[0]
    assert pair.flow[0, 0].tolist() == [1, -2]
    assert pair.flow[1, 1].tolist() == [0, 0]
    assert np.isfinite(pair.flow[..., 0]).sum() == 2
    assert np.argwhere(pair.occluded).tolist() == [[0, 0]]


@pytest.mark.parametrize(
    ("setting", "lost"),
    [
        (Kitti2015Stereo, "disp_occ_0/000001_10.png"),
        (Kitti2015Stereo, "calib_cam_to_cam/000001.txt"),
        (Kitti2015Flow, "image_2/000001_11.png"),
        (Kitti2015Flow, "flow_noc/000001_10.png"),
    ],
)
def test_a_missing_file_is_named(training, setting, lost):
    (training / lost).unlink()
    shutil.copy(training / "image_2" / "000001_10.png", training / "image_2" / "000002_10.png")
    with pytest.raises(InputError, match=r"there are none|has no partner"):
        setting(training.parent).load()


def test_cameras_the_wrong_way_round_and_flow_of_8_bits_are_named(training, picture):
    calibration = training / "calib_cam_to_cam" / "000001.txt"
    calibration.write_text(CALIBRATION.format(width=4, height=2).replace("-320", "320"))
    with pytest.raises(InputError, match=r"000001\.txt: wanted camera 03 on the right"):
        Kitti2015Stereo(training.parent).load()
    with pytest.raises(InputError, match=r"p\.png: .*three channels of 16 bits are wanted"):
        read_flow(picture(training / "p.png", 4, 2))


def test_real_flow_brings_the_second_image_onto_the_first(tmp_path, samples):
    real = samples / "flow_kitti2015_000010"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    for ours, theirs in (
        ("image_2/000010_10.png", "kitti_000010_10.png"),
        ("image_2/000010_11.png", "kitti_000010_11.png"),
        ("flow_occ/000010_10.png", "kitti_occ_000010_10.png"),
        ("flow_noc/000010_10.png", "kitti_noc_000010_10.png"),
    ):
        path = tmp_path / "training" / ours
        path.parent.mkdir(parents=True, exist_ok=True)
        path.symlink_to(real / theirs)
    pair = Kitti2015Flow(tmp_path).load()[0]
    known = np.isfinite(pair.flow[..., 0]) & ~pair.occluded
    assert 0.23 < known.mean() < 0.24
    height, width = known.shape
    column, row = np.meshgrid(
        np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32)
    )
    flow = np.nan_to_num(pair.flow)
    moved = cv2.remap(pair.target, column + flow[..., 0], row + flow[..., 1], cv2.INTER_LINEAR)
    before, after = (np.abs(i.astype(float) - pair.key)[known].mean() for i in (pair.target, moved))
    assert after < 0.6 * before


def test_real_disparity_holds_a_street_in_metres(tmp_path, samples):
    real = samples / "stereo_motorcycle_sceneflow_kitti15" / "KITTI_2015" / "training"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    for name in ("image_2", "disp_occ_0"):
        (tmp_path / "training" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "training" / name).symlink_to(real / name)
    (tmp_path / "training" / "calib_cam_to_cam").mkdir()
    (tmp_path / "training" / "calib_cam_to_cam" / "000046.txt").write_text(
        CALIBRATION.format(width=1242, height=375)
    )
    truth = Kitti2015Stereo(tmp_path).load()[0].truth
    assert 0.11 < truth.valid.mean() < 0.125
    assert 5 < np.nanmin(truth.values) < np.nanmax(truth.values) < 80
