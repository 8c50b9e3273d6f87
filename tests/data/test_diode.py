import numpy as np
import pytest

from flexdepth.data.diode import Diode, DiodePlace, DiodeSplit
from flexdepth.runtime.errors import InputError


@pytest.fixture
def scan(tmp_path, picture):
    """Return a function that writes one image with depth and mask."""

    def write(place, name, split="val"):
        folder = tmp_path / split / place / "scene_00019" / "scan_00183"
        stem = f"00019_00183_{place}_{name}"
        picture(folder / f"{stem}.png", 1024, 768)
        depth, mask = np.full((768, 1024, 1), 3.5, np.float32), np.ones((768, 1024))
        mask[0, 0], depth[1, 1] = 0, 0
        np.save(folder / f"{stem}_depth.npy", depth)
        np.save(folder / f"{stem}_depth_mask.npy", mask)
        return folder / stem

    return write


def test_depth_is_known_where_the_mask_is_one(tmp_path, scan):
    scan("indoors", "000_010")
    scan("outdoor", "000_000")
    pairs = Diode(tmp_path).load()
    assert [file.name for file in pairs.files] == [
        "00019_00183_indoors_000_010",
        "00019_00183_outdoor_000_000",
    ]
    truth = pairs[0].truth
    assert np.argwhere(~truth.valid).tolist() == [[0, 0], [1, 1]]
    assert truth.values[5, 5] == 3.5
    camera = truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (
        886.81,
        927.06,
        512,
        384,
    )
    assert len(Diode(tmp_path, place=DiodePlace.OUTDOOR).load()) == 1
    with pytest.raises(InputError, match="train: no such folder"):
        Diode(tmp_path, DiodeSplit.TRAIN).load()


def test_a_missing_mask_and_one_of_another_shape_are_named(tmp_path, scan):
    stem = scan("indoors", "000_010")
    mask = stem.with_name(f"{stem.name}_depth_mask.npy")
    np.save(mask, np.ones((768, 1023)))
    with pytest.raises(InputError, match=r"_mask\.npy: is of shape \(768, 1023\), its depth of"):
        Diode(tmp_path).load()[0]
    scan("indoors", "000_020")
    mask.unlink()
    with pytest.raises(InputError, match=r"000_010\.png: has no partner.*_depth_mask\.npy"):
        Diode(tmp_path).load()


def test_pickles_are_not_read(tmp_path, scan):
    stem = scan("indoors", "000_010")
    np.save(stem.with_name(f"{stem.name}_depth.npy"), np.array([{}], object), allow_pickle=True)
    with pytest.raises(InputError, match=r"_depth\.npy: cannot be read as a map of numbers"):
        Diode(tmp_path).load()[0]
