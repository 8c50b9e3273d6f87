import cv2
import numpy as np
import pytest

from flexdepth.data.middlebury import (
    Middlebury,
    Middlebury2003,
    Middlebury2006,
    MiddleburySize,
    read_calibration,
)
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError

CALIBRATION = """cam0=[1000 0 1.2; 0 1001 0.7; 0 0 1]
cam1=[1000 0 4.2; 0 1001 0.7; 0 0 1]
doffs=3
baseline=200
width=3
height=2
ndisp=70
"""


@pytest.fixture
def scene(tmp_path, picture):
    """Return a function that writes a scene of 2014, `scale` in the third line of its PFM."""

    def write(scale="-0.003922", name="disp0.pfm"):
        folder = tmp_path / "Adirondack"
        picture(folder / "im0.png", 3, 2)
        # PFM begins with the lowest row.
        numbers = np.array([[17, 7, np.inf], [37, np.nan, -3]], "<f4" if scale[0] == "-" else ">f4")
        (folder / name).write_bytes(f"Pf\n3 2\n{scale}\n".encode() + numbers.tobytes())
        (folder / "calib.txt").write_text(CALIBRATION)
        return folder

    return write


@pytest.mark.parametrize(("scale", "name"), [("-0.003922", "disp0.pfm"), ("255", "disp0GT.pfm")])
def test_depth_is_baseline_times_focal_by_disparity_and_doffs_whatever_the_scale(
    tmp_path, scene, scale, name
):
    scene(scale, name)
    truth = Middlebury(tmp_path).load()[0].truth
    np.testing.assert_allclose(truth.values, [[5, np.nan, np.nan], [10, 20, np.nan]])
    camera = truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (
        1000,
        1001,
        1.7,
        1.2,
    )


@pytest.mark.parametrize(
    ("damage", "complaint"),
    [
        (
            lambda text: text.replace("cam0", "cam7"),
            r"wanted cam0=\[f 0 cx; 0 f cy; 0 0 1\], got None",
        ),
        (lambda text: text.replace("baseline=200", "baseline=0"), "wanted a baseline > 0"),
        (lambda text: text.replace("doffs=3", ""), "wanted doffs, 1 numbers, got 0"),
        (lambda text: text.replace("[1000 0 1.2", "[f 0 1.2"), "wanted cam0, 4 numbers"),
    ],
)
def test_a_damaged_calibration_is_named(scene, damage, complaint):
    path = scene() / "calib.txt"
    path.write_text(damage(CALIBRATION))
    with pytest.raises(InputError, match=rf"calib\.txt: {complaint}"):
        read_calibration(path)


def test_a_scene_without_its_image_is_named(tmp_path, scene, picture):
    folder = scene()
    picture(tmp_path / "Piano" / "im0.png")
    with pytest.raises(InputError, match=r"Piano/im0\.png: has no partner"):
        Middlebury(tmp_path).load()
    (folder / "calib.txt").unlink()
    (tmp_path / "Piano" / "im0.png").unlink()
    with pytest.raises(InputError, match=r"calib\.txt: no such file"):
        Middlebury(tmp_path).load()


def test_gray_levels_of_2006_are_pixels_of_full_size_less_the_smallest(tmp_path, picture):
    picture(tmp_path / "Aloe" / "view1.png", 2, 1)
    cv2.imwrite(str(tmp_path / "Aloe" / "disp1.png"), np.array([[0, 74]], np.uint8))
    (tmp_path / "Aloe" / "dmin.txt").write_text("113\n")
    full, third = (
        Middlebury2006(tmp_path, size).load()[0].truth
        for size in (MiddleburySize.FULL, MiddleburySize.THIRD)
    )
    # 3740 px x 0.16 m / (74 + 113) px.
    assert full.values[0, 1] == third.values[0, 1] == pytest.approx(3.2)
    assert np.isnan(full.values[0, 0])
    assert third.intrinsics.focal_x == pytest.approx(3740 / 3)
    (tmp_path / "Aloe" / "dmin.txt").unlink()
    with pytest.raises(InputError, match=r"dmin\.txt: no such file"):
        Middlebury2006(tmp_path).load()


def test_disparity_without_a_camera_is_affine(tmp_path, picture):
    picture(tmp_path / "cones" / "im2.png", 2, 1)
    picture(tmp_path / "cones" / "im6.png", 2, 1)
    cv2.imwrite(str(tmp_path / "cones" / "disp2.png"), np.array([[0, 74]], np.uint8))
    (pair,) = Middlebury2003(tmp_path).load()
    assert pair.name == "cones_2"
    assert pair.truth.space is Space.AFFINE_DISPARITY
    assert pair.truth.disparity[0, 1] == 74
    assert np.isnan(pair.truth.disparity[0, 0])
    (tmp_path / "cones" / "im2.png").unlink()
    with pytest.raises(InputError, match=r"disp2\.png: has no partner"):
        Middlebury2003(tmp_path).load()


def test_the_real_motorcycle_stands_two_to_five_metres_away(samples):
    real = samples / "stereo_motorcycle_sceneflow_kitti15" / "MIDDLEBURY_2014" / "trainingQ"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    (pair,) = Middlebury(real).load()
    assert pair.name == "Motorcycle"
    assert pair.truth.valid.mean() == pytest.approx(0.979, abs=0.001)
    assert 2 < np.nanmin(pair.truth.values) < np.nanmax(pair.truth.values) < 5


def test_the_real_scenes_of_2001_are_read(samples):
    real = samples / "stereo_tsukuba_venus"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    pairs = Middlebury2003(real).load()
    assert [file.name for file in pairs.files] == ["tsukuba_3", "venus_2"]
    assert [round(float(pair.truth.valid.mean()), 2) for pair in pairs] == [0.79, 1.0]
