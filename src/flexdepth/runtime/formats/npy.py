"""npy: one float32 array, and its meaning in NAME.json beside it."""

from collections.abc import Mapping
from pathlib import Path
from tokenize import TokenError
from typing import IO

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.formats.meaning import Meaning, plain
from flexdepth.runtime.formats.reading import check_size, reading
from flexdepth.runtime.formats.sidecar import beside, recorded

ERRORS = (ValueError, SyntaxError, TokenError, TypeError, OverflowError)
"""What NumPy raises on a broken header."""

_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def write(path: Path, depth_map: DepthMap, origin: Mapping[str, str] | None) -> None:
    """Write `depth_map` to `path`, and its meaning to NAME.json."""
    meaning = Meaning.of(depth_map, plain(depth_map.space), origin)
    with beside(path, meaning), replacing(path) as temporary, temporary.open("wb") as file:
        values = np.ascontiguousarray(depth_map.values)
        np.lib.format.write_array_header_1_0(file, np.lib.format.header_data_from_array_1_0(values))
        file.write(values.data)


def numbers(path: Path) -> NDArray[np.float32]:
    """Return the array in `path` as float32."""
    with reading(path, "a npy file", ERRORS), path.open("rb") as file:
        return array(file, path.stat().st_size)


def meaning(path: Path) -> Meaning | None:
    """Return what NAME.json says of `path`."""
    return recorded(path)


def array(stream: IO[bytes], length: int) -> NDArray[np.float32]:
    """Return the two-dimensional array of real numbers in npy format as float32.

    Nothing is unpickled, and nothing is allocated that `length` does not cover.

    Args:
        stream: At the start of the npy data.
        length: How many bytes the npy data has.

    Raises:
        ValueError: It is no such array or broken, as say the other `ERRORS`.
    """
    version = np.lib.format.read_magic(stream)
    if version not in _HEADERS:
        raise ValueError(f"its version {version} is unknown")
    shape, columns_first, dtype = _HEADERS[version](stream)
    if len(shape) != 2 or dtype.kind not in "fiu":
        raise ValueError(
            f"a depth map is a height x width array of numbers, it holds {dtype} of shape {shape}"
        )
    check_size(shape[1], shape[0])
    size = shape[0] * shape[1] * dtype.itemsize
    present = length - stream.tell()
    if present != size:
        raise ValueError(f"{size} bytes of numbers are declared, {present} are there")
    stored = np.frombuffer(stream.read(size), dtype).reshape(
        shape, order="F" if columns_first else "C"
    )
    with np.errstate(over="ignore", invalid="ignore"):
        return stored.astype(np.float32, order="C")
