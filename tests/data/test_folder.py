import cv2
import numpy as np
import pytest

from flexdepth.data.folder import Folder
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth

CAMERA = Intrinsics.centred(8, 6, 7.0, FocalSource.GIVEN)


def add(root, name, depth_map, image=True):
    (root / "image").mkdir(exist_ok=True)
    if image:
        pixels = np.full((6, 8, 3), (0, 0, 200), np.uint8)
        cv2.imwrite(str(root / "image" / f"{name}.png"), pixels)
    write_depth(root / "depth" / f"{name}.npz", depth_map, None)


def metric(size=(6, 8), camera=CAMERA):
    return DepthMap(np.full(size, 2.5, np.float32), Space.METRIC, camera)


def test_pairs_come_in_the_order_of_their_names(tmp_path):
    for name in ("b", "a", "c"):
        add(tmp_path, name, metric())
    pairs = Folder(tmp_path).load()
    assert [pairs[i].name for i in range(len(pairs))] == ["a", "b", "c"]
    assert (pairs[0].image == (200, 0, 0)).all()
    assert (pairs[0].truth.depth == 2.5).all()


def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(InputError, match=r"image: no such folder; a data folder holds"):
        Folder(tmp_path).load()


def test_an_empty_folder_is_named(tmp_path):
    (tmp_path / "image").mkdir()
    (tmp_path / "depth").mkdir()
    with pytest.raises(InputError, match="image: holds no file"):
        Folder(tmp_path).load()


def test_a_file_without_a_partner_is_named(tmp_path):
    add(tmp_path, "a", metric())
    add(tmp_path, "lonely", metric(), image=False)
    with pytest.raises(InputError, match=r"lonely\.npz: has no partner"):
        Folder(tmp_path).load()


@pytest.mark.parametrize(
    ("depth_map", "complaint"),
    [
        (metric(size=(5, 8)), "depth is 8x5, its image 8x6"),
        (metric(camera=None), "without a camera"),
        (DepthMap(np.ones((6, 8), np.float32), Space.SCALE, CAMERA), "got scale"),
    ],
)
def test_what_cannot_be_trained_on_is_refused(tmp_path, depth_map, complaint):
    add(tmp_path, "a", depth_map)
    with pytest.raises(InputError, match=complaint):
        Folder(tmp_path).load()[0]


@pytest.mark.parametrize(("count", "held_out"), [(2, 1), (9, 1), (20, 2), (25, 2)])
def test_the_last_tenth_by_name_is_held_out_and_not_learnt_from(count, held_out, tmp_path):
    for kind, suffix in (("image", "png"), ("depth", "npz")):
        (tmp_path / kind).mkdir()
        for number in range(count):
            (tmp_path / kind / f"{number:02d}.{suffix}").touch()
    names = {
        part: [image.stem for image, _ in Folder(tmp_path, part).load().paths]
        for part in ("all", "first", "last")
    }
    assert names["first"] + names["last"] == names["all"] == [f"{n:02d}" for n in range(count)]
    assert len(names["last"]) == held_out


def test_a_single_pair_is_not_divided(tmp_path):
    for kind, name in (("image", "a.png"), ("depth", "a.npz")):
        (tmp_path / kind).mkdir()
        (tmp_path / kind / name).touch()
    assert len(Folder(tmp_path).load()) == 1
    with pytest.raises(InputError, match="holds a single pair"):
        Folder(tmp_path, "last").load()
