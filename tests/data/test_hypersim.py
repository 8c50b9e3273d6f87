import h5py
import numpy as np
import pytest

from flexdepth.data.hypersim import Hypersim, HypersimSplit
from flexdepth.runtime.errors import InputError

HEADER = "scene_name,camera_name,frame_id,included_in_public_release,exclude_reason,"


@pytest.fixture
def frame(tmp_path, picture):
    """Return a function that writes a frame that looks at a wall 3 m ahead."""

    def write(scene, number):
        images = tmp_path / scene / "images"
        stem = f"frame.{number:04d}"
        picture(images / "scene_cam_00_final_preview" / f"{stem}.tonemap.jpg", 1024, 768)
        across, down = np.arange(1024) + 0.5 - 512, np.arange(768) + 0.5 - 384
        focal = 512 / np.tan(np.pi / 6)
        distance = 3 * np.sqrt(across[None] ** 2 + down[:, None] ** 2 + focal**2) / focal
        distance[0, 0] = np.nan
        folder = images / "scene_cam_00_geometry_hdf5"
        folder.mkdir(exist_ok=True)
        with h5py.File(folder / f"{stem}.depth_meters.hdf5", "w") as file:
            file["dataset"] = distance.astype(np.float16)

    return write


def test_a_wall_is_flat_once_distances_are_depth(tmp_path, frame):
    frame("ai_001_001", 7)
    (pair,) = Hypersim(tmp_path).load()
    assert pair.name == "ai_001_001_cam_00_0007"
    assert np.argwhere(~pair.truth.valid).tolist() == [[0, 0]]
    np.testing.assert_allclose(pair.truth.values[1:], 3, rtol=6e-4)
    assert pair.truth.intrinsics.focal_x == pytest.approx(886.81, abs=0.005)


def test_the_published_split_chooses_public_frames(tmp_path, frame):
    for scene, number in (("ai_001_001", 0), ("ai_001_001", 1), ("ai_002_001", 0)):
        frame(scene, number)
    (tmp_path / "split.csv").write_text(
        f"{HEADER}split_partition_name\nai_001_001,cam_00,0,True,,train\n"
        "ai_001_001,cam_00,1,False,people,train\nai_002_001,cam_00,0,True,,val\n"
    )
    train, val = (
        Hypersim(tmp_path, tmp_path / "split.csv", split).load()
        for split in (HypersimSplit.TRAIN, HypersimSplit.VAL)
    )
    assert [file.name for file in train.files] == ["ai_001_001_cam_00_0000"]
    assert [file.name for file in val.files] == ["ai_002_001_cam_00_0000"]
    with pytest.raises(InputError, match=r"split\.csv: test holds 0 images"):
        Hypersim(tmp_path, tmp_path / "split.csv", HypersimSplit.TEST).load()
    (tmp_path / "split.csv").write_text(
        f"{HEADER}split_partition_name\nai_009_001,cam_00,0,True,,train\n"
    )
    with pytest.raises(InputError, match=r"of which 1 are not in .*ai_009_001/cam_00/0000"):
        Hypersim(tmp_path, tmp_path / "split.csv").load()
    (tmp_path / "split.csv").write_text("scene_name,camera_name\na,b\n")
    with pytest.raises(InputError, match=r"split\.csv: wanted a split of Hypersim, a table with"):
        Hypersim(tmp_path, tmp_path / "split.csv").load()


def test_a_frame_without_depth_is_named(tmp_path, frame):
    frame("ai_001_001", 0)
    frame("ai_001_001", 1)
    next(tmp_path.rglob("frame.0001.depth_meters.hdf5")).unlink()
    with pytest.raises(InputError, match=r"frame\.0001\.tonemap\.jpg: has no partner"):
        Hypersim(tmp_path).load()
