import numpy as np
import pytest

from flexdepth.data.conversion import convert
from flexdepth.data.folder import Folder
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_origin


def converted(pairs, folder, suffix=".npz"):
    return convert(pairs, folder, suffix, "rooms", lambda _done: None)


@pytest.mark.parametrize("suffix", [".npz", ".exr"])
def test_a_converted_set_is_read_back_to_the_bit(tmp_path, rooms, suffix):
    assert converted(rooms[:2], tmp_path, suffix) == 2
    pairs = Folder(tmp_path).load()
    for number, room in enumerate(rooms[:2]):
        assert pairs[number].name == room.name
        np.testing.assert_array_equal(pairs[number].image, room.image)
        np.testing.assert_array_equal(pairs[number].truth.values, room.truth.values)
        camera, own = pairs[number].truth.intrinsics, room.truth.intrinsics
        assert camera.focal_x == own.focal_x
        assert camera.centre_x == pytest.approx(own.centre_x)
    origin = read_origin(tmp_path / "depth" / f"room_0{suffix}")
    assert origin == {"data_set": "rooms", "name": "room_0"}


def test_an_interrupted_conversion_goes_on_where_it_stopped(tmp_path, rooms):
    converted(rooms[:3], tmp_path)
    image = tmp_path / "image" / "room_1.png"
    image.unlink()
    kept = (tmp_path / "image" / "room_0.png").stat().st_mtime_ns
    assert converted(rooms[:4], tmp_path) == 2
    assert image.is_file()
    assert (tmp_path / "image" / "room_0.png").stat().st_mtime_ns == kept


def test_two_pairs_of_one_name_are_refused(tmp_path, rooms):
    with pytest.raises(InputError, match="two pairs of rooms are called room_0"):
        converted([rooms[0], rooms[0]], tmp_path)
