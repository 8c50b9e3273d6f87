import struct

import numpy as np
import pytest

from flexdepth.data.tagged_floats import read_cam, read_dpt, read_flow
from flexdepth.runtime.errors import InputError


def test_the_tag_spells_pieh(tmp_path):
    path = tmp_path / "a.flo"
    path.write_bytes(b"PIEH" + struct.pack("<2i", 2, 1) + struct.pack("<4f", 1.5, -2.0, 1e10, 0.0))
    flow = read_flow(path)
    assert flow.shape == (1, 2, 2)
    assert flow[0, 0].tolist() == [1.5, -2.0]
    assert np.isnan(flow[0, 1]).all()


def test_depth_is_one_float_a_pixel(tmp_path):
    path = tmp_path / "a.dpt"
    path.write_bytes(b"PIEH" + struct.pack("<2i", 3, 2) + np.arange(6, dtype="<f4").tobytes())
    assert read_dpt(path).tolist() == [[0, 1, 2], [3, 4, 5]]


def test_a_camera_is_two_matrices(tmp_path):
    path = tmp_path / "a.cam"
    path.write_bytes(b"PIEH" + np.arange(21, dtype="<f8").tobytes())
    intrinsic, extrinsic = read_cam(path)
    assert intrinsic[2].tolist() == [6, 7, 8]
    assert extrinsic[0].tolist() == [9, 10, 11, 12]


@pytest.mark.parametrize(
    ("read", "content", "complaint"),
    [
        (read_flow, b"HEIP" + bytes(8), "does not begin with the float 202021.25"),
        (read_flow, b"PIEH" + struct.pack("<2i", 2, 1) + bytes(12), "16 bytes.* 12 are there"),
        (read_dpt, b"PIEH" + struct.pack("<2i", -2, 1), "a size of -2 x 1"),
        (read_dpt, b"PIEH" + struct.pack("<2i", 1 << 20, 1 << 20), "a size of 1048576 x"),
        (read_cam, b"PIEH" + bytes(160), "21 finite numbers are wanted, 20"),
        (read_flow, b"PIEH", "does not begin"),
    ],
)
def test_a_damaged_file_is_named(tmp_path, read, content, complaint):
    path = tmp_path / "bad.bin"
    path.write_bytes(content)
    with pytest.raises(InputError, match=rf"bad\.bin: .*{complaint}"):
        read(path)


def test_the_published_flow_of_dimetrodon_is_read(samples):
    path = samples / "flow_kitti2015_000010" / "Dimetrodon.flo"
    if not path.is_file():
        pytest.skip(f"no {path}")
    flow = read_flow(path)
    assert flow.shape == (388, 584, 2)
    assert 0.9 < np.isfinite(flow).mean() <= 1
    assert np.nanmax(np.abs(flow)) < 6
