import re
import shutil
from pathlib import Path

import cv2
import h5py
import numpy as np
import pytest
from scipy.io import savemat

from flexdepth.data.nyu import CAMERA, NyuDepth, NyuFolders, NyuLabelled
from flexdepth.data.read import Split
from flexdepth.runtime.errors import InputError

LABELLED, SPLITS = "nyu_depth_v2_labeled.mat", "splits.mat"


def write_labelled(root, count=3, size=(640, 480)):
    """Write what MATLAB would: HDF5 behind a block of text, columns before rows."""
    with h5py.File(root / LABELLED, "w", userblock_size=512) as file:
        for name, shape, kind in (
            ("images", (count, 3, *size), np.uint8),
            ("depths", (count, *size), np.float32),
            ("rawDepths", (count, *size), np.float32),
        ):
            file.create_dataset(name, shape, kind, chunks=(1, *shape[1:]), compression="gzip")
        file["images"][1, 1, 639, 2] = 200
        file["depths"][1, 639, 2] = 3.25
        file["rawDepths"][1, 0, size[1] - 1] = 1.5
    with (root / LABELLED).open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file")


def write_splits(root, train=(2, 3), test=(1,)):
    column = {"trainNdxs": np.array([train]).T, "testNdxs": np.array([test]).T}
    savemat(root / SPLITS, column)


def write_frame(folder, number, image="rgb_{:05d}.jpg", depth="sync_depth_{:05d}.png", shade=2000):
    folder.mkdir(parents=True, exist_ok=True)
    if image:
        cv2.imwrite(str(folder / image.format(number)), np.full((480, 640, 3), 90, np.uint8))
    if depth:
        codes = np.full((480, 640), shade, np.uint16)
        cv2.imwrite(str(folder / depth.format(number)), codes)


def names(pairs):
    return [files.name for files in pairs.files]


def test_labelled_images_stand_upright_and_count_from_1(tmp_path):
    write_labelled(tmp_path)
    write_splits(tmp_path)
    pairs = NyuLabelled(tmp_path).load()
    assert pairs.numbers == (2, 3)
    pair = pairs[0]
    assert pair.name == "0002"
    assert pair.image.shape == (480, 640, 3)
    assert np.argwhere(pair.image).tolist() == [[2, 639, 1]]
    assert np.argwhere(pair.truth.valid).tolist() == [[2, 639]]
    assert pair.truth.values[2, 639] == 3.25
    assert NyuLabelled(tmp_path, Split.TEST).load().numbers == (1,)


def test_raw_depth_is_a_value_of_the_setting(tmp_path):
    write_labelled(tmp_path)
    write_splits(tmp_path)
    truth = NyuLabelled(tmp_path, depth=NyuDepth.RAW).load()[0].truth
    assert np.argwhere(truth.valid).tolist() == [[479, 0]]
    assert truth.values[479, 0] == 1.5


def test_the_camera_is_the_toolbox_one_moved_by_half_a_pixel(tmp_path):
    write_labelled(tmp_path)
    write_splits(tmp_path)
    camera = NyuLabelled(tmp_path, Split.TEST).load()[0].truth.intrinsics
    found = (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y)
    assert found == pytest.approx((518.8579, 519.4696, 326.0824, 254.2362), abs=1e-4)


@pytest.mark.parametrize("missing", [LABELLED, SPLITS])
def test_a_missing_file_of_the_labelled_set_is_named(tmp_path, missing):
    write_labelled(tmp_path)
    write_splits(tmp_path)
    (tmp_path / missing).unlink()
    with pytest.raises(
        InputError, match=rf"{re.escape(missing)}: no such file; wanted nyu_.* and splits"
    ):
        NyuLabelled(tmp_path).load()


@pytest.mark.parametrize("file", [LABELLED, SPLITS])
@pytest.mark.parametrize("damage", [b"", b"rubbish" * 300, "first half", "a hole"])
def test_a_damaged_file_of_the_labelled_set_is_named(tmp_path, file, damage):
    write_labelled(tmp_path)
    write_splits(tmp_path)
    whole = (tmp_path / file).read_bytes()
    middle = len(whole) // 2
    known = {"first half": whole[:middle], "a hole": whole[:150] + bytes(2000) + whole[2150:]}
    (tmp_path / file).write_bytes(known.get(damage, damage))
    with pytest.raises(InputError, match=rf"{re.escape(file)}: "):
        NyuLabelled(tmp_path).load()[0]


def test_damage_inside_an_image_is_named(tmp_path):
    write_labelled(tmp_path)
    write_splits(tmp_path)
    with h5py.File(tmp_path / LABELLED) as file:
        chunk = file["images"].id.get_chunk_info(0)
    with (tmp_path / LABELLED).open("r+b") as file:
        file.seek(512 + chunk.byte_offset + 10)
        file.write(b"\xff" * (chunk.size - 20))
    pairs = NyuLabelled(tmp_path).load()
    with pytest.raises(InputError, match=re.escape(LABELLED)):
        pairs[0]


@pytest.mark.parametrize("train", [(0, 1), (1, 4), ()])
def test_splits_of_another_file_are_refused(tmp_path, train):
    write_labelled(tmp_path)
    write_splits(tmp_path, train=train)
    with pytest.raises(InputError, match=r"splits\.mat: trainNdxs .* from 1 to 3"):
        NyuLabelled(tmp_path).load()


def test_an_image_of_another_size_has_another_camera_and_is_refused(tmp_path):
    write_labelled(tmp_path, size=(640, 479))
    write_splits(tmp_path)
    with pytest.raises(InputError, match=r"wanted images and depths of shapes .*640, 480.*479"):
        NyuLabelled(tmp_path).load()


def test_a_file_without_depth_is_refused(tmp_path):
    write_labelled(tmp_path)
    write_splits(tmp_path)
    with h5py.File(tmp_path / LABELLED, "r+") as file:
        del file["depths"]
    with pytest.raises(InputError, match="depths"):
        NyuLabelled(tmp_path).load()


def test_the_official_splits_are_795_and_654(tmp_path, samples):
    real = samples / "splits_lists"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    shutil.copy(real / "bts/utils/splits.mat", tmp_path)
    with h5py.File(tmp_path / LABELLED, "w") as file:  # chunks that are not written take no room
        file.create_dataset("images", (1449, 3, 640, 480), np.uint8, chunks=(1, 3, 640, 480))
        file.create_dataset("depths", (1449, 640, 480), np.float32, chunks=(1, 640, 480))
    numbers = {split: NyuLabelled(tmp_path, split).load().numbers for split in Split}
    assert {split: len(found) for split, found in numbers.items()} == {"train": 795, "test": 654}
    for split, found in numbers.items():
        text = (real / f"marigold/nyu_depth/labeled/filename_list_{split}.txt").read_text()
        assert sorted(found) == sorted(int(n) for n in re.findall(r"/rgb_(\d+)\.png", text))


def test_frames_in_folders_pair_by_scene_and_number(tmp_path):
    write_frame(tmp_path / "sync" / "kitchen_0001", 5, shade=2500)
    write_frame(tmp_path / "sync" / "bedroom_0002", 5)
    write_frame(tmp_path / "sync" / "bedroom_0002", 4)
    write_frame(tmp_path / "official_splits" / "test" / "bathroom", 45)
    pairs = NyuFolders(tmp_path).load()
    assert names(pairs) == ["bedroom_0002_00004", "bedroom_0002_00005", "kitchen_0001_00005"]
    assert np.unique(pairs[2].truth.values).tolist() == [2.5]
    assert pairs[2].truth.intrinsics == CAMERA
    assert names(NyuFolders(tmp_path, Split.TEST).load()) == ["bathroom_00045"]


def test_a_list_of_bts_chooses_frames_and_their_order(tmp_path):
    for number in (1, 2, 3):
        write_frame(tmp_path / "sync" / "study", number)
    chosen = tmp_path / "list.txt"
    chosen.write_text(
        "/study/rgb_00003.jpg /study/sync_depth_00003.png 518.8579\n"
        "study/rgb_00001.jpg study/sync_depth_00001.png 518.8579\n"
    )
    pairs = NyuFolders(tmp_path, frames=chosen).load()
    assert names(pairs) == ["study_00003", "study_00001"]
    beside = NyuFolders(tmp_path, frames=Path("list.txt"))
    assert names(beside.load()) == names(pairs)


@pytest.mark.parametrize("lacking", ["image", "depth"])
def test_a_frame_without_a_partner_is_named(tmp_path, lacking):
    write_frame(tmp_path / "sync" / "study", 1)
    write_frame(tmp_path / "sync" / "study", 2, **{lacking: ""})
    with pytest.raises(InputError, match=r"_00002\.(jpg|png): has no partner"):
        NyuFolders(tmp_path).load()


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("study/rgb_00001.jpg study/sync_depth_00002.png 518.8", "are not of one frame"),
        ("study/rgb_00001.jpg attic/sync_depth_00001.png 518.8", "are not of one frame"),
        ("study/rgb_00009.jpg study/sync_depth_00009.png 518.8", r"rgb_00009\.jpg; there is no"),
        ("study/rgb_00001.jpg", "wanted SCENE/rgb_NNNNN.jpg and sync_depth"),
        ("study/0001.jpg study/sync_depth_00001.png", "is no frame's name"),
    ],
)
def test_a_line_that_pairs_nothing_is_named(tmp_path, line, complaint):
    write_frame(tmp_path / "sync" / "study", 1)
    write_frame(tmp_path / "sync" / "study", 2)
    write_frame(tmp_path / "sync" / "attic", 1)
    chosen = tmp_path / "list.txt"
    chosen.write_text("study/rgb_00002.jpg study/sync_depth_00002.png 518.8579\n" + line)
    with pytest.raises(InputError, match=complaint):
        NyuFolders(tmp_path, frames=chosen).load()


def test_a_missing_or_empty_folder_is_named_with_what_it_should_hold(tmp_path):
    with pytest.raises(InputError, match=r"sync: no such folder; it should hold SCENE/rgb_"):
        NyuFolders(tmp_path).load()
    (tmp_path / "sync").mkdir()
    with pytest.raises(InputError, match=r"sync: holds no frames; looked for SCENE/rgb_"):
        NyuFolders(tmp_path).load()


def test_the_published_test_list_finds_654_frames(tmp_path, samples):
    chosen = samples / "splits_lists/bts/train_test_inputs/nyudepthv2_test_files_with_gt.txt"
    if not chosen.is_file():
        pytest.skip(f"no {chosen}")
    for word in re.findall(r"\S+\.(?:jpg|png)", chosen.read_text()):
        path = tmp_path / "official_splits" / "test" / word
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    pairs = NyuFolders(tmp_path, Split.TEST, chosen).load()
    assert len(set(names(pairs))) == 654
    assert names(pairs)[0] == "bathroom_00045"


def test_real_frames_hold_a_room_in_metres(tmp_path, samples):
    real = samples / "mixed_metric3d_kitti_nyu_wild" / "nyu_demo"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    scene = tmp_path / "sync" / "basement"
    scene.mkdir(parents=True)
    for path in (*real.glob("rgb/*.jpg"), *real.glob("depth/*.png")):
        shutil.copy(path, scene)
    pairs = NyuFolders(tmp_path).load()
    assert names(pairs) == ["basement_00000", "basement_00050", "basement_00100"]
    for number in range(3):
        truth = pairs[number].truth
        assert 0.65 < truth.valid.mean() < 0.8
        assert 0.5 < np.nanmin(truth.values) < np.nanmax(truth.values) < 10
