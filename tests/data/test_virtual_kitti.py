import numpy as np
import pytest

from flexdepth.data.virtual_kitti import VirtualKitti1, VirtualKitti2
from flexdepth.runtime.errors import InputError

TURN = "1 0 0 -2 0 1 0 0 0 0 1 0 0 0 0 1"


@pytest.fixture
def depth(codes):
    """Return a function that writes a depth map with a pixel of sky and one of 12.34 m."""

    def write(path):
        stored = np.full((375, 1242), 500)
        stored[0, :2] = 65535, 1234
        return codes(path, stored)

    return write


@pytest.fixture
def first(tmp_path, picture, depth):
    for number in (0, 1):
        picture(tmp_path / "vkitti_1.3.1_rgb/0001/fog" / f"{number:05d}.png", 1242, 375)
        depth(tmp_path / "vkitti_1.3.1_depthgt/0001/fog" / f"{number:05d}.png")
    poses = tmp_path / "vkitti_1.3.1_extrinsicsgt"
    poses.mkdir()
    (poses / "0001_fog.txt").write_text(f"frame r1,1 r1,2\n0 {TURN}\n1 {TURN}\n")
    return tmp_path


@pytest.fixture(params=["", "vkitti_2.0.3_{}"])
def second(tmp_path, picture, depth, request):
    """Version 2 with its archives unpacked into one folder, or each into its own."""
    rgb, deep, text = (tmp_path / request.param.format(kind) for kind in ("rgb", "depth", "textgt"))
    for eye in (0, 1):
        picture(rgb / f"Scene01/clone/frames/rgb/Camera_{eye}/rgb_00007.jpg", 1242, 375)
        depth(deep / f"Scene01/clone/frames/depth/Camera_{eye}/depth_00007.png")
    folder = text / "Scene01" / "clone"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "intrinsic.txt").write_text(
        "frame cameraID fx fy cx cy\n7 0 725.0087 725 620.5 187\n7 1 700 701 600 180\n"
    )
    moved = TURN.replace("-2", "-3")
    (folder / "extrinsic.txt").write_text(f"frame cameraID r1,1\n7 0 {TURN}\n7 1 {moved}\n")
    return tmp_path


def test_the_last_code_is_sky_and_the_others_centimetres(first):
    setting = VirtualKitti1(first, variation="fog")
    truth = setting.load()[1].truth
    assert np.argwhere(truth.sky).tolist() == [[0, 0]]
    assert truth.values[0, 1] == np.float32(12.34)
    camera = truth.intrinsics
    assert (camera.focal_x, camera.centre_x, camera.centre_y) == (725, 621, 187.5)
    assert setting.poses()[1][:3, 3].tolist() == [2, 0, 0]


def test_a_frame_without_a_partner_and_another_variation_are_named(first):
    (first / "vkitti_1.3.1_depthgt/0001/fog/00001.png").unlink()
    with pytest.raises(InputError, match=r"fog/00001\.png: has no partner"):
        VirtualKitti1(first, variation="fog").load()
    with pytest.raises(InputError, match="rain: no such folder"):
        VirtualKitti1(first, variation="rain").load()


def test_each_camera_of_version_2_has_its_own_frames_and_poses(second):
    left, right = (VirtualKitti2(second, camera=eye) for eye in (0, 1))
    pair = right.load()[0]
    assert pair.name == "Scene01_clone_Camera_1_00007"
    camera = pair.truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (
        700,
        701,
        600.5,
        180.5,
    )
    assert pair.truth.sky.sum() == 1
    assert [each.poses()[0][0, 3] for each in (left, right)] == [2, 3]


def test_a_frame_that_the_intrinsics_do_not_speak_of_is_named(tmp_path, second):
    path = next(tmp_path.rglob("intrinsic.txt"))
    path.write_text("frame cameraID\n8 0 1 1 1 1\n")
    with pytest.raises(InputError, match=r"intrinsic\.txt: says nothing of frame 7, camera 0"):
        VirtualKitti2(second).load()
    path.write_text("frame cameraID\n8 0 1 1 1\n")
    with pytest.raises(InputError, match=r"intrinsic\.txt, line 2: wanted, 6 numbers, got 5"):
        VirtualKitti2(second).load()
