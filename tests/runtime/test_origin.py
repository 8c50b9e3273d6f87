import json
import struct

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from flexdepth.runtime.cloud import Cloud, write_glb, write_ply
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.origin import glb_origin, picture_origin, ply_origin, write_picture
from flexdepth.runtime.video import video_origin, writing_video

ORIGIN = {"input": "sha256:ab", "lens": "tief, 深\nend_header"}


@pytest.fixture
def written(tmp_path):
    """One file of each kind, with and without an origin, and what reads it."""
    cloud = Cloud(np.zeros((2, 3), np.float32), np.zeros((2, 3), np.uint8))
    pixels = np.zeros((4, 6, 3), np.uint8)

    def write(kind, origin):
        path = tmp_path / f"a.{kind}"
        match kind:
            case "png":
                write_picture(path, pixels, origin or {})
            case "ply":
                write_ply(path, cloud, origin)
            case "glb":
                write_glb(path, cloud, origin)
            case "mp4":
                with writing_video(path, 10, origin) as video:
                    video.write(np.zeros((48, 64, 3), np.uint8))
        return path

    return write


READERS = {"png": picture_origin, "ply": ply_origin, "glb": glb_origin, "mp4": video_origin}


@pytest.mark.parametrize("kind", READERS)
def test_an_origin_comes_back_from_the_file(kind, written):
    assert READERS[kind](written(kind, ORIGIN)) == ORIGIN
    assert not READERS[kind](written(kind, None))


def test_a_picture_with_an_origin_is_an_ordinary_picture(written):
    with Image.open(written("png", ORIGIN)) as picture:
        assert (picture.size, picture.mode) == ((6, 4), "RGB")


@pytest.mark.parametrize("reader", [picture_origin, ply_origin, glb_origin])
def test_a_file_that_is_missing_or_empty_is_refused(reader, tmp_path):
    for path in (tmp_path / "missing", tmp_path / "empty"):
        (tmp_path / "empty").touch()
        with pytest.raises(InputError, match=path.name):
            reader(path)


DEEP = b"[" * 100_000
HOSTILE = [
    b"ply\ncomment flexdepth {\nend_header\n",
    b"ply\ncomment flexdepth " + DEEP + b"\nend_header\n",
    b"ply\ncomment flexdepth [1]\nend_header\n",
    b"glTF" + struct.pack("<III4s", 2, 100, len(DEEP), b"JSON") + DEEP,
    b"glTF" + struct.pack("<III4s", 2, 100, 2**32 - 1, b"JSON") + b"{}",
    b"glTF" + struct.pack("<III4s", 2, 100, 2, b"JSON") + b"[]",
    b"glTF" + struct.pack("<III4s", 2, 100, 12, b"JSON") + json.dumps({"asset": 1}).encode(),
]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(min_size=1, max_size=200) | st.sampled_from(HOSTILE))
def test_somebody_elses_bytes_have_no_origin(tmp_path, content):
    path = tmp_path / "a"
    path.write_bytes(content)
    for reader in (picture_origin, ply_origin, glb_origin):
        assert reader(path) is None
