import re
import shutil
from dataclasses import replace

import cv2
import numpy as np
import pytest

from flexdepth.data.kitti import EIGEN_TRAIN, Kitti, calibrated_camera
from flexdepth.runtime.errors import InputError

DATE, DRIVE = "2011_09_26", "2011_09_26_drive_0001_sync"
CALIBRATION = """calib_time: 09-Jan-2012 13:57:47
corner_dist: 9.950000e-02
S_02: 1.392000e+03 5.120000e+02
K_02: 9.597910e+02 0.000000e+00 6.960217e+02 0.000000e+00 9.569251e+02 2.241806e+02 0 0 1
S_rect_02: {width} {height}
R_rect_02: 9.998817e-01 1.511453e-02 -2.841595e-03 0 1 0 0 0 1
P_rect_02: 7.215377e+02 0.000000e+00 6.095593e+02 4.485728e+01 \
0.000000e+00 7.215376e+02 1.728540e+02 2.163791e-01 0.000000e+00 0.000000e+00 1.0 2.745884e-03
S_rect_03: {width} {height}
P_rect_03: 7.0e+02 0.000000e+00 6.0e+02 -3.395242e+02 \
0.000000e+00 7.1e+02 1.7e+02 2.199936e+00 0.000000e+00 0.000000e+00 1.0 2.729905e-03
""".replace("\\\n", "")


@pytest.fixture
def setting(tmp_path):
    return Kitti(tmp_path, tmp_path / "raw", tmp_path / "depth", tmp_path / "train.txt")


def write_calibration(setting, date=DATE, width=12, height=4):
    (setting.raw / date).mkdir(parents=True, exist_ok=True)
    path = setting.raw / date / "calib_cam_to_cam.txt"
    path.write_text(CALIBRATION.format(width=f"{width:e}", height=f"{height:e}"))
    return path


def image_of(setting, number, drive=DRIVE, camera="image_02"):
    return setting.raw / drive[:10] / drive / camera / "data" / f"{number:010d}.png"


def depth_of(setting, number, drive=DRIVE, camera="image_02", part="train"):
    folder = setting.depth / part / drive / "proj_depth" / "groundtruth" / camera
    return folder / f"{number:010d}.png"


def write_frame(setting, number, camera="image_02", part="train", code=256 * 7):
    image = image_of(setting, number, camera=camera)
    depth = depth_of(setting, number, camera=camera, part=part)
    for path in (image, depth):
        path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(image), np.full((4, 12, 3), 90, np.uint8))
    codes = np.zeros((4, 12), np.uint16)
    codes[2, 3] = code
    cv2.imwrite(str(depth), codes)


def bts(number, depth_number=None):
    where = f"{DRIVE}/proj_depth/groundtruth/image_02/"
    named = f"{where}{number if depth_number is None else depth_number:010d}.png"
    return f"{DATE}/{DRIVE}/image_02/data/{number:010d}.png {named} 721.5377"


def names(pairs):
    return [files.name for files in pairs.files]


def test_both_kinds_of_list_name_the_same_frames(setting):
    write_calibration(setting)
    for number in (5, 60):
        write_frame(setting, number)
    write_frame(setting, 60, camera="image_03", part="val")
    left = [f"{DRIVE}_image_02_0000000060", f"{DRIVE}_image_02_0000000005"]
    setting.frames.write_text(f"{bts(60)}\n{bts(5)}\n")
    assert names(setting.load()) == left
    setting.frames.write_text(
        f"{DATE}/{DRIVE} 60 l\n{DATE}/{DRIVE} 0000000005 l\n{DATE}/{DRIVE} 60 r\n"
    )
    assert names(setting.load()) == [*left, f"{DRIVE}_image_03_0000000060"]


def test_everything_may_lie_in_one_folder(setting):
    write_calibration(setting)
    write_frame(setting, 5)
    (setting.root / EIGEN_TRAIN).write_text(bts(5))
    assert names(Kitti(setting.root).load()) == [f"{DRIVE}_image_02_0000000005"]


def test_depth_is_in_steps_of_a_256th_of_a_metre(setting):
    write_calibration(setting)
    write_frame(setting, 5, code=640)
    setting.frames.write_text(bts(5))
    truth = setting.load()[0].truth
    assert np.argwhere(truth.valid).tolist() == [[2, 3]]
    assert truth.values[2, 3] == 2.5


def test_each_camera_is_that_of_the_calibration_moved_by_half_a_pixel(setting):
    write_calibration(setting)
    for camera in ("image_02", "image_03"):
        write_frame(setting, 5, camera=camera)
    setting.frames.write_text(f"{DATE}/{DRIVE} 5 l\n{DATE}/{DRIVE} 5 r\n")
    left, right = (pair.truth.intrinsics for pair in setting.load())
    assert (left.focal_x, left.focal_y) == (721.5377, 721.5376)
    assert (left.centre_x, left.centre_y) == pytest.approx((610.0593, 173.354))
    assert (right.focal_x, right.focal_y) == (700.0, 710.0)
    assert (right.centre_x, right.centre_y) == (600.5, 170.5)


def test_jpg_images_and_depth_without_train_and_val_are_found(setting):
    write_calibration(setting)
    write_frame(setting, 5, part="")
    image = image_of(setting, 5)
    cv2.imwrite(str(image.with_suffix(".jpg")), cv2.imread(str(image)))
    image.unlink()
    setting.frames.write_text(bts(5))
    assert setting.load()[0].image.shape == (4, 12, 3)


def test_frames_that_the_set_has_no_depth_for_are_left_out(setting):
    write_calibration(setting)
    for number in (1, 5):
        write_frame(setting, number)
    depth_of(setting, 1).unlink()
    for line in (f"{DATE}/{DRIVE} 1 l", f"{DATE}/{DRIVE}/image_02/data/0000000001.png None 721.5"):
        setting.frames.write_text(f"{line}\n{bts(5)}\n")
        assert names(setting.load()) == [f"{DRIVE}_image_02_0000000005"]


def test_a_list_whose_frames_all_lack_depth_is_refused(setting):
    write_calibration(setting)
    write_frame(setting, 1)
    depth_of(setting, 1).unlink()
    setting.frames.write_text(f"{DATE}/{DRIVE} 1 l\n")
    with pytest.raises(InputError, match=r"train\.txt: .* no annotated depth for any"):
        setting.load()


def without_image(setting):
    image_of(setting, 5).unlink()


def without_depth(setting):
    depth_of(setting, 5).unlink()


def without_list(setting):
    setting.frames.unlink()


def without_drive(setting):
    shutil.rmtree(setting.depth)


def without_calibration(setting):
    (setting.raw / DATE / "calib_cam_to_cam.txt").unlink()


@pytest.mark.parametrize(
    ("lose", "complaint"),
    [
        (without_list, r"train\.txt: no such list of frames; wanted .* with .*raw/DATE.*depth/tr"),
        (without_image, r"train\.txt, line 1: looked for .*0000000005\.png or \.jpg"),
        (without_depth, r"train\.txt, line 1: looked for .*groundtruth.*0000000005\.png"),
        (without_drive, r"line 1: looked for 2011_09_26_drive_0001_sync.* in .*train.*val"),
        (without_calibration, r"calib_cam_to_cam\.txt: no such"),
    ],
)
def test_a_missing_file_is_named(setting, lose, complaint):
    write_calibration(setting)
    write_frame(setting, 5)
    write_frame(setting, 6)
    setting.frames.write_text(bts(5))
    lose(setting)
    with pytest.raises(InputError, match=complaint):
        setting.load()


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        (bts(5, depth_number=6), "are not of one frame"),
        (bts(5).replace("groundtruth/image_02", "groundtruth/image_03"), "are not of one frame"),
        (f"{DATE}/{DRIVE} five l", "wanted 'DATE/DRIVE_sync NUMBER l'"),
        (f"{DATE}/{DRIVE} 5 middle", "got '.* 5 middle'"),
        (f"{DATE}/{DRIVE}", "wanted 'DATE/DRIVE_sync NUMBER l'"),
        ("../../etc/passwd 5 l", "wanted 'DATE/DRIVE_sync NUMBER l'"),
    ],
)
def test_a_line_that_pairs_nothing_is_named(setting, line, complaint):
    write_calibration(setting)
    for number in (5, 6):
        write_frame(setting, number)
    setting.frames.write_text(f"{bts(6)}\n{line}\n")
    with pytest.raises(InputError, match=rf"train\.txt, line 2: .*{complaint}"):
        setting.load()


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text.replace("P_rect_02", "P_02"),
        lambda text: text.replace("S_rect_02: ", "S_rect_02: wide "),
        lambda text: text[: text.index("P_rect_02") + 24],
    ],
)
def test_a_damaged_calibration_is_named_with_what_it_should_hold(setting, damage):
    path = write_calibration(setting)
    path.write_text(damage(path.read_text()))
    with pytest.raises(InputError, match=r"calib_cam_to_cam\.txt: wanted S_rect_02 .* P_rect_02"):
        calibrated_camera(path, "02")


def test_an_image_of_another_size_than_calibrated_is_named(setting):
    write_calibration(setting, width=13)
    write_frame(setting, 5)
    setting.frames.write_text(bts(5))
    with pytest.raises(InputError, match=r"0000000005\.png: wanted 13x4.*got 12x4"):
        setting.load()[0]


def test_the_published_lists_agree_on_the_652_test_frames_with_depth(setting, samples):
    lists = samples / "splits_lists"
    if not lists.is_dir():
        pytest.skip(f"no {lists}")
    chosen = lists / "bts/train_test_inputs/eigen_test_files_with_gt.txt"
    for line in chosen.read_text().splitlines():
        image, depth, _ = line.split()
        for path in (setting.raw / image, setting.depth / "val" / depth):
            if path.name != "None":
                path.parent.mkdir(parents=True, exist_ok=True)
                path.touch()
        write_calibration(setting, image.split("/")[0])
    found = [
        set(names(replace(setting, frames=path).load()))
        for path in (
            chosen,
            lists / "marigold/kitti_depth/eigen_test_files_with_gt.txt",
            lists / "monodepth2/eigen/test_files.txt",
            lists / "monodepth2/eigen_benchmark/test_files.txt",
        )
    ]
    assert len(found[0]) == 652
    assert found[1:] == found[:1] * 3


def test_real_frames_hold_a_street_in_metres(setting, samples):
    real = samples / "mixed_metric3d_kitti_nyu_wild" / "kitti_demo"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    write_calibration(setting, width=1242, height=375)
    for number in (5, 50, 100):
        for source, target in (("rgb", image_of), ("depth", depth_of)):
            path = target(setting, number)
            path.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(real / source / f"{number:010d}.png", path)
    setting.frames.write_text("\n".join(bts(number) for number in (5, 50, 100)))
    pairs = setting.load()
    assert [int(re.findall(r"\d+", name)[-1]) for name in names(pairs)] == [5, 50, 100]
    for number in range(3):
        truth = pairs[number].truth
        assert 0.17 < truth.valid.mean() < 0.22
        assert 5 < np.nanmin(truth.values) < 8
        assert 80 < np.nanmax(truth.values) < 85
