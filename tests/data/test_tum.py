import numpy as np
import pytest

from flexdepth.data.tum import Tum, TumCamera, associated
from flexdepth.runtime.errors import InputError


@pytest.fixture
def sequence(tmp_path, picture, codes):
    """A sequence whose second image has no depth of its time."""
    root = tmp_path / "rgbd_dataset_freiburg2_desk"
    for time in ("1.000000", "2.000000", "3.000000"):
        picture(root / "rgb" / f"{time}.png")
    for number, time in enumerate(("1.010000", "2.500000", "2.990000")):
        codes(root / "depth" / f"{time}.png", fill=5000 + number)
    (root / "rgb.txt").write_text(
        "# color images\n# timestamp filename\n"
        + "".join(f"{t} rgb/{t}.png\n" for t in ("1.000000", "2.000000", "3.000000"))
    )
    (root / "depth.txt").write_text(
        "".join(f"{t} depth/{t}.png\n" for t in ("1.010000", "2.500000", "2.990000"))
    )
    (root / "groundtruth.txt").write_text("# t\n1.001 7 0 0 0 0 0 1\n2.0 8 0 0 0 0 0 1\n")
    return root


def test_images_and_depth_of_one_time_are_pairs_and_others_are_left_out(sequence):
    pairs = Tum(sequence).load()
    assert [pairs[n].name for n in range(2)] == ["1.000000", "3.000000"]
    assert pairs[0].truth.values[0, 0] == 1.0
    assert pairs[1].truth.values[0, 0] == np.float32(5002 / 5000)
    first, last = Tum(sequence).poses()
    assert first[0, 3] == 7
    assert last is None


def test_the_nearest_times_are_taken_first_and_none_twice():
    # 1.00 is 0.010 from 1.01, but 1.015 is nearer to it; 1.00 is left with 0.99.
    assert associated([1.0, 1.015], [0.99, 1.01]) == [(0, 0), (1, 1)]
    assert associated([1.0, 1.008], [1.01]) == [(1, 0)]
    assert associated([1.0], [1.021]) == []


def test_the_camera_is_that_of_the_folder_or_the_one_that_is_given(sequence, tmp_path):
    camera = Tum(sequence).load()[0].truth.intrinsics
    assert (camera.focal_x, camera.focal_y) == (520.9, 521.0)
    assert (camera.centre_x, camera.centre_y) == pytest.approx((325.6, 250.2))
    given = Tum(sequence, TumCamera.ROS).load()[0].truth.intrinsics
    assert (given.focal_x, given.centre_x, given.centre_y) == (525, 320, 240)
    renamed = sequence.rename(tmp_path / "desk")
    with pytest.raises(InputError, match="desk: its name does not say which camera"):
        Tum(renamed).load()


def test_a_listed_file_that_is_missing_and_a_line_that_is_none_are_named(sequence):
    (sequence / "depth" / "2.500000.png").unlink()
    with pytest.raises(InputError, match=r"depth\.txt, line 2: looked for .*2\.500000\.png"):
        Tum(sequence).load()
    (sequence / "depth.txt").write_text("later depth/1.010000.png\n")
    with pytest.raises(InputError, match=r"depth\.txt, line 1: wanted a time and a file"):
        Tum(sequence).load()


def test_clocks_that_never_agree_are_told(sequence):
    (sequence / "depth.txt").write_text("9.0 depth/1.010000.png\n")
    with pytest.raises(InputError, match=r"depth\.txt: no time in it is within 0\.02 s"):
        Tum(sequence).load()


def test_real_frames_hold_a_desk_in_metres(tmp_path, samples):
    real = samples / "indoor_slambook2" / "ch7_tum_fr2_desk"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    root = tmp_path / "freiburg2_desk"
    root.mkdir()
    for kind, suffix in (("rgb", ""), ("depth", "_depth")):
        for n in (1, 2):
            (root / f"{n}{suffix}.png").symlink_to(real / f"{n}{suffix}.png")
        (root / f"{kind}.txt").write_text("".join(f"{n}.0 {n}{suffix}.png\n" for n in (1, 2)))
    for pair in Tum(root).load():
        assert 0.4 < np.nanmin(pair.truth.values) < 1.2
        assert 2 < np.nanmax(pair.truth.values) < 14
