import numpy as np
import pytest

from flexdepth.data.icl_nuim import IclNuim, IclNuimAugmented, IclNuimPovRay
from flexdepth.runtime.errors import InputError


@pytest.fixture
def room(tmp_path, picture, codes):
    for number in (0, 1):
        picture(tmp_path / "rgb" / f"{number}.png")
        codes(tmp_path / "depth" / f"{number}.png", fill=5000 * (number + 1))
    (tmp_path / "associations.txt").write_text(
        "0 depth/0.png 0 rgb/0.png\n1 depth/1.png 1 rgb/1.png\n"
    )
    (tmp_path / "livingRoom0.gt.freiburg").write_text("1 4 5 6 0 0 0 1\n")
    return tmp_path


def test_the_form_of_tum_is_z_in_5000ths_with_y_turned_down(room):
    pairs, poses = IclNuim(room).load(), IclNuim(room).poses()
    assert pairs[1].truth.values[0, 0] == 2.0
    camera = pairs[1].truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (
        481.2,
        480,
        320,
        240,
    )
    assert poses[0] is None
    assert poses[1][:3, 3].tolist() == [4, -5, 6]


def test_a_missing_file_or_a_line_of_another_form_is_named(room):
    (room / "depth" / "1.png").unlink()
    with pytest.raises(InputError, match=r"associations\.txt, line 2: looked for .*depth/1\.png"):
        IclNuim(room).load()
    (room / "associations.txt").write_text("0 rgb/0.png 0 depth/0.png\n")
    with pytest.raises(
        InputError, match=r"associations\.txt, line 1: wanted '0 depth/0\.png 0 rgb"
    ):
        IclNuim(room).load()


@pytest.mark.parametrize("unit", [1.0, 100.0])
def test_povrays_distances_along_the_rays_become_z(tmp_path, picture, unit):
    picture(tmp_path / "scene_00_0000.png")
    column, row = np.meshgrid(np.arange(640), np.arange(480))
    distance = 2.5 * np.sqrt(((column - 319.5) / 481.2) ** 2 + ((row - 239.5) / -480.0) ** 2 + 1)
    np.savetxt(tmp_path / "scene_00_0000.depth", (unit * distance).ravel()[None], fmt="%.6f")
    truth = IclNuimPovRay(tmp_path, unit).load()[0].truth
    np.testing.assert_allclose(truth.values, 2.5, rtol=1e-5)


def test_a_short_file_of_distances_is_named(tmp_path, picture):
    picture(tmp_path / "scene_00_0000.png")
    (tmp_path / "scene_00_0000.depth").write_text("1.0 2.0")
    with pytest.raises(InputError, match=r"0000\.depth: wanted the distances of 640 x 480.*got 2"):
        IclNuimPovRay(tmp_path).load()[0]


def test_fewer_poses_than_frames_are_told(tmp_path, picture, codes):
    picture(tmp_path / "image" / "00000.jpg")
    picture(tmp_path / "image" / "00001.jpg")
    for number in range(2):
        codes(tmp_path / "depth" / f"{number:05d}.png")
    (tmp_path / "a.log").write_text("0 0 1\n" + "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n")
    assert IclNuimAugmented(tmp_path).load()[0].truth.values[0, 0] == 1.0
    with pytest.raises(InputError, match=r"a\.log: holds 1 poses for 2 frames"):
        IclNuimAugmented(tmp_path).poses()


def test_real_augmented_depth_agrees_with_its_poses(samples, reprojection_error):
    real = samples / "indoor_iclnuim_livingroom1"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    scene = IclNuimAugmented(real)
    pairs, poses = scene.load(), scene.poses()
    assert len(pairs) == len(poses) == 120
    assert reprojection_error(pairs[10], pairs[30], poses[10], poses[30]) < 0.002


def test_real_depth_agrees_with_its_poses_once_y_points_down(tmp_path, samples, reprojection_error):
    real = samples / "indoor_slambook2" / "ch12_iclnuim"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    for ours, theirs in (("rgb", "color"), ("depth", "depth")):
        (tmp_path / ours).symlink_to(real / theirs)
    poses = (real / "pose.txt").read_text().splitlines()
    (tmp_path / "traj.gt.freiburg").write_text(
        "".join(f"{n} {p}\n" for n, p in enumerate(poses, 1))
    )
    (tmp_path / "associations.txt").write_text(
        "".join(f"{n} depth/{n}.png {n} rgb/{n}.png\n" for n in range(1, 6))
    )
    room = IclNuim(tmp_path)
    pairs, poses = room.load(), room.poses()
    assert reprojection_error(pairs[0], pairs[1], poses[0], poses[1]) < 0.02
    flip = np.diag([1.0, -1, 1, 1])
    upside_down = [flip @ pose @ flip for pose in poses]
    assert reprojection_error(pairs[0], pairs[1], upside_down[0], upside_down[1]) > 0.04
