"""PFM: a short text header, then float32 rows from the bottom up; its meaning in NAME.json.

Of the number in the third line only the sign counts: negative for little-endian, as here.
"""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.formats.meaning import Meaning, plain
from flexdepth.runtime.formats.reading import check_size, reading
from flexdepth.runtime.formats.sidecar import beside, recorded

_HEADER = re.compile(rb"Pf\s+(\d{1,9})\s+(\d{1,9})\s+([-+]?)[\d.eE+-]{1,40}(?:\r\n|\s)")
_LONGEST_HEADER = 128


def write(path: Path, depth_map: DepthMap, origin: Mapping[str, str] | None) -> None:
    """Write `depth_map` to `path`, and its meaning to NAME.json."""
    meaning = Meaning.of(depth_map, plain(depth_map.space), origin)
    with beside(path, meaning), replacing(path) as temporary, temporary.open("wb") as file:
        file.write(f"Pf\n{meaning.width} {meaning.height}\n-1.0\n".encode("ascii"))
        file.write(np.ascontiguousarray(depth_map.values[::-1], dtype="<f4").data)


def numbers(path: Path) -> NDArray[np.float32]:
    """Return the values in `path`, the top row first."""
    with reading(path, "a PFM file", (ValueError,)), path.open("rb") as file:
        header = _HEADER.match(file.read(_LONGEST_HEADER))
        if header is None:
            raise ValueError("it does not begin with Pf (one channel), width, height and scale")
        width, height = int(header[1]), int(header[2])
        check_size(width, height)
        size, present = 4 * width * height, path.stat().st_size - header.end()
        if present != size:
            raise ValueError(f"{size} bytes of numbers are declared, {present} are there")
        file.seek(header.end())
        stored = np.frombuffer(file.read(size), "<f4" if header[3] == b"-" else ">f4")
    return stored.reshape(height, width)[::-1].astype(np.float32, order="C")


def meaning(path: Path) -> Meaning | None:
    """Return what NAME.json says of `path`."""
    return recorded(path)
