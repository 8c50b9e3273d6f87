"""npz: the arrays `depth` (or `disparity`) and `spread`, and the JSON text `meaning`.

They are there for `numpy.load`; `spread` is missing where nothing is known of it. They are stored
without compression: on a 12-megapixel map deflate at its fastest saves a seventh of the file and
takes twenty times as long, for the last bits of float32 are noise.
"""

import struct
from collections.abc import Mapping
from lzma import LZMAError
from pathlib import Path
from typing import IO
from zipfile import BadZipFile, ZipFile
from zlib import error as ZlibError  # noqa: N812 - the module's only exception, lower case there

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.formats.meaning import MAX_TEXT, Meaning, parsed, plain, quantity
from flexdepth.runtime.formats.npy import ERRORS, array
from flexdepth.runtime.formats.reading import reading

_ERRORS = (
    *ERRORS,
    BadZipFile,
    ZlibError,
    LZMAError,
    EOFError,
    NotImplementedError,
    RuntimeError,
    KeyError,
    IndexError,
    struct.error,
)
_ARRAYS = ("depth.npy", "disparity.npy")
_MEANING = "meaning.npy"
_SPREAD = "spread.npy"


def write(path: Path, depth_map: DepthMap, origin: Mapping[str, str] | None) -> None:
    """Write `depth_map` and its meaning to `path`."""
    text = Meaning.of(depth_map, plain(depth_map.space), origin).text()
    arrays = {quantity(depth_map.space): depth_map.values, "meaning": np.array(text)}
    if depth_map.spread is not None:
        arrays["spread"] = depth_map.spread
    with replacing(path) as temporary, ZipFile(temporary, "w") as archive:
        for name, content in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, content, allow_pickle=False)


def numbers(path: Path) -> NDArray[np.float32]:
    """Return the array `depth` or `disparity` of `path`, or its only array, as float32."""
    with reading(path, "a npz file", _ERRORS), ZipFile(path) as archive:
        names = archive.namelist()
        named = [name for name in names if name in _ARRAYS] or names
        if len(named) != 1:
            raise ValueError(f"one array `depth` or `disparity` is wanted, it has {names[:9]}")
        return _array(archive, named[0])


def spread(path: Path) -> NDArray[np.float32] | None:
    """Return the array `spread` of `path`, None where there is none."""
    with reading(path, "a npz file", _ERRORS), ZipFile(path) as archive:
        return _array(archive, _SPREAD) if _SPREAD in archive.namelist() else None


def meaning(path: Path) -> Meaning | None:
    """Return what the entry `meaning` of `path` says."""
    with reading(path, "a npz file", _ERRORS), ZipFile(path) as archive:
        if _MEANING not in archive.namelist():
            return None
        with archive.open(_MEANING) as member:
            text = _text(member)
    return parsed(text, path)


def _array(archive: ZipFile, name: str) -> NDArray[np.float32]:
    entry = archive.getinfo(name)
    with archive.open(entry) as member:
        return array(member, entry.file_size)


def _text(stream: IO[bytes]) -> str:
    """Return the string that a zero-dimensional npy array holds."""
    np.lib.format.read_magic(stream)
    shape, _, dtype = np.lib.format.read_array_header_1_0(stream)
    if shape != () or dtype.kind != "U" or dtype.itemsize > 4 * MAX_TEXT:
        raise ValueError(f"its entry `meaning` is no text but {dtype} of shape {shape}")
    return str(np.frombuffer(stream.read(dtype.itemsize), dtype)[0])
