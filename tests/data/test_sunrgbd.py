import numpy as np
import pytest
from scipy.io import savemat

from flexdepth.data.read import Split
from flexdepth.data.sunrgbd import SunDepth, SunRgbd, TurnedCodes
from flexdepth.runtime.errors import InputError


@pytest.fixture
def place(tmp_path, picture, codes):
    """Return a function that writes one image below ROOT/kv1."""

    def write(name, millimetres=1500):
        folder = tmp_path / "kv1" / name
        picture(folder / "image" / "a.jpg", 4, 3)
        turned = ((millimetres << 3) | (millimetres >> 13)) & 0xFFFF
        codes(folder / "depth" / "b.png", fill=turned, width=4, height=3)
        codes(folder / "depth_bfx" / "b.png", fill=8 * 2000, width=4, height=3)
        (folder / "intrinsics.txt").write_text("520.5 0 318.1\n0 521.5 240.2\n0 0 1\n")
        return folder

    return write


@pytest.mark.parametrize("millimetres", [1, 1500, 8191, 8192, 9870, 65535])
def test_the_three_highest_bits_are_stored_lowest(tmp_path, codes, millimetres):
    turned = ((millimetres << 3) | (millimetres >> 13)) & 0xFFFF
    path = codes(tmp_path / "d.png", [[turned, 0]])
    metres = TurnedCodes(path).values()
    assert metres[0, 0] == np.float32(millimetres / 1000)
    assert np.isnan(metres[0, 1])


def test_raw_or_refined_depth_comes_with_the_cameras_of_its_place(tmp_path, place):
    place("b3dodata/img_0063")
    raw, refined = (SunRgbd(tmp_path, depth=depth).load()[0] for depth in SunDepth)
    assert raw.name == "kv1_b3dodata_img_0063"
    assert (raw.truth.values[0, 0], refined.truth.values[0, 0]) == (1.5, 2.0)
    camera = raw.truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x) == (520.5, 521.5, 318.6)


def test_the_published_split_chooses_by_folder(tmp_path, place):
    for name in ("b3dodata/img_0001", "NYUdata/NYU0002"):
        place(name)
    toolbox = tmp_path / "toolbox"
    toolbox.mkdir()
    stem = "/n/fs/sun3d/data/SUNRGBD/kv1"
    lists = {
        "alltrain": np.array([[f"{stem}/NYUdata/NYU0002/"]], object),
        "alltest": np.array([[f"{stem}/b3dodata/img_0001"]], object),
    }
    savemat(toolbox / "allsplit.mat", lists)
    found = [SunRgbd(tmp_path, toolbox, split).load().files for split in Split]
    assert [[file.name for file in files] for files in found] == [
        ["kv1_NYUdata_NYU0002"],
        ["kv1_b3dodata_img_0001"],
    ]
    lists["alltrain"] = np.array([[f"{stem}/NYUdata/NYU0003"]], object)
    savemat(toolbox / "allsplit.mat", lists)
    with pytest.raises(InputError, match=r"NYU0003: is in allsplit\.mat, but there is no such"):
        SunRgbd(tmp_path, toolbox).load()


def test_an_image_without_depth_or_camera_is_named(tmp_path, place):
    place("a/1")
    folder = place("a/2")
    (folder / "intrinsics.txt").write_text("520.5 0 318.1")
    with pytest.raises(InputError, match=r"intrinsics\.txt: wanted a camera of 3 x 3, 9 numbers"):
        SunRgbd(tmp_path).load()
    (folder / "depth" / "b.png").unlink()
    with pytest.raises(InputError, match=r"2/image/a\.jpg: has no partner"):
        SunRgbd(tmp_path).load()


def test_a_real_frame_holds_a_room_in_metres(samples):
    path = samples / "indoor_open3d_samples" / "other_formats" / "SUN_depth.png"
    if not path.is_file():
        pytest.skip(f"no {path}")
    metres = TurnedCodes(path).values()
    assert 1.05 < np.nanmin(metres) < 1.06
    assert 9.8 < np.nanmax(metres) < 9.9
