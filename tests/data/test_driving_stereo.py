import pytest

from flexdepth.data.driving_stereo import DrivingStereo
from flexdepth.runtime.errors import InputError

SESSION = "2018-07-09-16-11-56"


@pytest.fixture
def drive(tmp_path, picture, codes):
    name = "2018-07-09-16-11-56_2018-07-09-16-12-08-210"
    picture(tmp_path / "train-left-image" / SESSION / f"{name}.jpg", 8, 4)
    codes(tmp_path / "train-depth-map" / SESSION / f"{name}.png", fill=2560, width=8, height=4)
    (tmp_path / "half-image-calib").mkdir()
    (tmp_path / "half-image-calib" / "2018-07-09.txt").write_text(
        "S_rect_101: 8 4\nP_rect_101: 1003 0 4 0 0 1004 2 0 0 0 1 0\n"
    )
    return tmp_path


def test_depth_is_in_256ths_and_the_camera_is_that_of_the_date(drive):
    (pair,) = DrivingStereo(drive).load()
    assert pair.name.startswith(f"{SESSION}_2018-07-09")
    assert (pair.truth.depth == 10).all()
    camera = pair.truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (
        1003,
        1004,
        4.5,
        2.5,
    )


def test_images_of_another_size_than_the_calibrations_and_missing_dates_are_named(drive, picture):
    (image,) = (drive / "train-left-image" / SESSION).iterdir()
    picture(image, 16, 8)
    with pytest.raises(InputError, match=r"\.jpg: wanted 8x4.*got 16x8"):
        DrivingStereo(drive).load()[0]
    (drive / "half-image-calib" / "2018-07-09.txt").unlink()
    with pytest.raises(InputError, match=r"2018-07-09\.txt: no such"):
        DrivingStereo(drive).load()
    image.rename(image.with_name("another.jpg"))
    with pytest.raises(InputError, match="has no partner"):
        DrivingStereo(drive).load()
