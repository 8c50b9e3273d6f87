import numpy as np
import pytest

from flexdepth.data.eth3d import Eth3d, Eth3dStereo, read_cameras
from flexdepth.runtime.errors import InputError

CAMERAS = "# Camera list\n0 THIN_PRISM_FISHEYE 4 3 3.5 3.6 2.1 1.4 -0.1 0 0 0 0 0 0 0\n"
IMAGES = """# Image list with two lines of data per image
7 1 0 0 0 -5 0 0 0 dslr_images/DSC_0001.JPG
1.0 2.0 -1
8 0 0 0 1 -5 0 0 0 dslr_images/DSC_0002.JPG

"""


@pytest.fixture
def courtyard(tmp_path, picture):
    scene = tmp_path / "courtyard"
    for number in (1, 2):
        name = f"dslr_images/DSC_{number:04d}.JPG"
        picture(scene / "images" / name, 4, 3)
        depth = np.full((3, 4), number, "<f4")
        depth[0, 0] = np.inf
        (scene / "ground_truth_depth" / name).parent.mkdir(parents=True, exist_ok=True)
        depth.tofile(scene / "ground_truth_depth" / name)
    (scene / "dslr_calibration_jpg").mkdir()
    (scene / "dslr_calibration_jpg" / "cameras.txt").write_text(CAMERAS)
    (scene / "dslr_calibration_jpg" / "images.txt").write_text(IMAGES)
    return scene


def test_bare_floats_are_depth_and_colmaps_camera_counts_from_the_corner(courtyard):
    pairs = Eth3d(courtyard.parent).load()
    assert [file.name for file in pairs.files] == ["courtyard_DSC_0001", "courtyard_DSC_0002"]
    truth = pairs[1].truth
    assert np.argwhere(~truth.valid).tolist() == [[0, 0]]
    assert truth.values[2, 3] == 2
    camera = truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (
        3.5,
        3.6,
        2.1,
        1.4,
    )


def test_poses_lead_from_the_camera_to_the_world(courtyard):
    straight, turned = Eth3d(courtyard.parent, "courtyard").poses()
    assert straight[:3, 3].tolist() == [5, 0, 0]
    # Half a turn about z: x = -5 before the camera is x = -5 in the world.
    np.testing.assert_allclose(turned[:3, 3], [-5, 0, 0], atol=1e-12)


def test_a_cut_depth_a_missing_camera_and_a_missing_scene_are_named(courtyard):
    path = courtyard / "ground_truth_depth" / "dslr_images" / "DSC_0001.JPG"
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(InputError, match=r"DSC_0001\.JPG: .*48 bytes are wanted, 47 are there"):
        Eth3d(courtyard.parent).load()[0]
    images = courtyard / "dslr_calibration_jpg" / "images.txt"
    images.write_text(IMAGES.replace("DSC_0002", "DSC_0003"))
    with pytest.raises(InputError, match=r"says nothing of the image or camera DSC_0002"):
        Eth3d(courtyard.parent).load()
    with pytest.raises(InputError, match="facade: no such folder"):
        Eth3d(courtyard.parent, "facade").load()


def test_a_lens_without_two_focal_lengths_is_named(courtyard):
    folder = courtyard / "dslr_calibration_jpg"
    (folder / "cameras.txt").write_text("0 SIMPLE_RADIAL 4 3 3.5 2.1 1.4 0.1\n")
    with pytest.raises(InputError, match=r"cameras\.txt, line 1: wanted NUMBER MODEL"):
        read_cameras(folder)


def test_two_views_are_read_as_middleburys(tmp_path, picture):
    scene = tmp_path / "delivery_area_1l"
    picture(scene / "im0.png", 2, 1)
    (scene / "disp0GT.pfm").write_bytes(b"Pf\n2 1\n-1\n" + np.array([4.0, np.inf], "<f4").tobytes())
    (scene / "calib.txt").write_text(
        "cam0=[500 0 1; 0 500 0.5; 0 0 1]\ncam1=[500 0 1; 0 500 0.5; 0 0 1]\n"
        "doffs=0\nbaseline=60\nwidth=2\nheight=1\nndisp=64\n"
    )
    values = Eth3dStereo(tmp_path).load()[0].truth.values
    assert values[0, 0] == pytest.approx(7.5)
    assert np.isnan(values[0, 1])
