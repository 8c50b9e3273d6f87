"""Files that begin with the float 202021.25: optical flow (.flo), depth (.dpt), cameras (.cam).

    .flo    tag, width and height (int32), then u, v of each pixel (float32), row after row
    .dpt    tag, width and height (int32), then the depth of each pixel (float32)
    .cam    tag, M of 3 x 3 and N of 3 x 4 (float64): image point = M N (world point, 1)

All are little-endian.

References:
    .flo: Baker et al., A database and evaluation methodology for optical flow, IJCV 2011, and
    its `flow-code`; .dpt and .cam: `sintel_io.py` of MPI-Sintel's depth and camera data, 2015.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.formats.reading import check_size, reading
from flexdepth.runtime.opening import open_input

TAG = 202021.25
"""In the bytes of a little-endian float32 it spells PIEH."""

_UNKNOWN = 1e9
_HEADER = 12


def read_flow(path: Path) -> NDArray[np.float32]:
    """Return a .flo file: height x width x 2, right and down in pixels; NaN is unknown.

    Raises:
        InputError: The file is missing, damaged or of another kind.
    """
    flow = _maps(path, 2, "an optical flow file (.flo)")
    unknown = ~(np.abs(flow) < _UNKNOWN).all(axis=-1)
    flow[unknown] = np.nan
    return flow


def read_dpt(path: Path) -> NDArray[np.float32]:
    """Return a .dpt file as it is stored: height x width.

    Raises:
        InputError: The file is missing, damaged or of another kind.
    """
    return _maps(path, 1, "a depth file (.dpt)")[..., 0]


def read_cam(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the intrinsic 3 x 3 and the extrinsic 3 x 4 matrix of a .cam file.

    Raises:
        InputError: The file is missing, damaged or of another kind.
    """
    with reading(path, "a camera file (.cam)", (ValueError,)):
        content = _bytes(path)
        numbers = np.frombuffer(content[4:], "<f8")
        if len(numbers) != 21 or not np.isfinite(numbers).all():
            raise ValueError(f"21 finite numbers are wanted, {len(numbers)} are there")
    return numbers[:9].reshape(3, 3), numbers[9:].reshape(3, 4)


def _maps(path: Path, channels: int, what: str) -> NDArray[np.float32]:
    with reading(path, what, (ValueError,)):
        content = _bytes(path)
        width, height = (int(side) for side in np.frombuffer(content[4:_HEADER], "<i4"))
        check_size(width, height)
        declared, present = 4 * channels * width * height, len(content) - _HEADER
        if present != declared:
            raise ValueError(f"{declared} bytes of numbers are declared, {present} are there")
        numbers = np.frombuffer(content[_HEADER:], "<f4").reshape(height, width, channels)
    return numbers.astype(np.float32)


def _bytes(path: Path) -> bytes:
    with open_input(path) as file:
        content = file.read()
    if len(content) < _HEADER or np.frombuffer(content[:4], "<f4")[0] != np.float32(TAG):
        raise ValueError(f"it does not begin with the float {TAG}")
    return content
