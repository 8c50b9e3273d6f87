import numpy as np
import OpenEXR
import pytest

from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_depth, read_stated, write_depth

ROOM = np.array([[1.5, np.inf], [np.nan, 4.0]], np.float32)


def channels(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}


def write(path, **planes):
    kind = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(kind, planes) as file:
        file.write(str(path))


def test_compositing_finds_depth_in_z_and_no_disparity_there(tmp_path):
    write_depth(tmp_path / "a.exr", DepthMap(ROOM, Space.METRIC), None)
    np.testing.assert_array_equal(channels(tmp_path / "a.exr")["Z"], ROOM)
    write_depth(tmp_path / "a.exr", DepthMap(ROOM, Space.AFFINE_DISPARITY), None)
    assert list(channels(tmp_path / "a.exr")) == ["disparity"]


def test_z_beside_colours_is_read_as_stated(tmp_path):
    grey = np.ones((2, 2), np.float16)
    write(tmp_path / "a.exr", R=grey, G=grey, B=grey, Z=ROOM)
    found = read_stated(tmp_path / "a.exr", Space.METRIC, 2.0)
    np.testing.assert_array_equal(found.values, ROOM * 2)
    write(tmp_path / "a.exr", R=grey, G=grey, B=grey)
    with pytest.raises(InputError, match="`Z` is wanted"):
        read_stated(tmp_path / "a.exr", Space.METRIC, 1.0)


def test_a_file_that_was_cut_off_is_said_to_be(tmp_path, capsys):
    """By the error alone: what OpenEXR prints of it would stand amid JSON."""
    write_depth(tmp_path / "a.exr", DepthMap(ROOM, Space.METRIC), None)
    content = (tmp_path / "a.exr").read_bytes()
    (tmp_path / "a.exr").write_bytes(content[:-5])
    with pytest.raises(InputError, match=r"a\.exr: .* cut off or broken"):
        read_depth(tmp_path / "a.exr")
    assert capsys.readouterr().out == ""


def test_a_huge_declared_window_is_not_allocated(tmp_path):
    write_depth(tmp_path / "a.exr", DepthMap(ROOM, Space.METRIC), None)
    content = (tmp_path / "a.exr").read_bytes()
    window = content.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
    huge = np.array([0, 0, 99_999, 99_999], "<i4").tobytes()
    (tmp_path / "a.exr").write_bytes(content[:window] + huge + content[window + 16 :])
    with pytest.raises(InputError, match=r"a\.exr: cannot be read as an OpenEXR file: "):
        read_depth(tmp_path / "a.exr")
