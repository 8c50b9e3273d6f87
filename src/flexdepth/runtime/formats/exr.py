"""OpenEXR: float32 channels, the meaning in the header's string attribute `flexdepth`.

Depth is the channel `Z`, the name that the format reserves for it: Blender, Fusion and Natron
take it as depth, Nuke shows it as `depth.Z`. Affine disparity is the channel `disparity`, so that
no tool mistakes it for a distance. The channel `spread` is there where it is known. Compression is
ZIP, which is lossless.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from pathlib import Path
from threading import Lock

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.formats.meaning import Meaning, parsed, plain
from flexdepth.runtime.formats.reading import check_size, reading

_KEY = "flexdepth"
_SPREAD = "spread"
_CHANNELS = ("Z", "disparity", "depth.Z", "depth")
_ERRORS = (RuntimeError, ValueError, TypeError, KeyError, IndexError, OverflowError)

_printing = Lock()


def write(path: Path, depth_map: DepthMap, origin: Mapping[str, str] | None) -> None:
    """Write `depth_map` and its meaning to `path`."""
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        _KEY: Meaning.of(depth_map, plain(depth_map.space), origin).text(),
    }
    channel = "disparity" if depth_map.space is Space.AFFINE_DISPARITY else "Z"
    channels = {channel: np.ascontiguousarray(depth_map.values)}
    if depth_map.spread is not None:
        channels[_SPREAD] = np.ascontiguousarray(depth_map.spread)
    with replacing(path) as temporary, OpenEXR.File(header, channels) as file:
        try:
            file.write(str(temporary))
        except RuntimeError as error:
            raise OSError(str(error).rpartition('". ')[2].rstrip(".")) from error


def numbers(path: Path) -> NDArray[np.float32]:
    """Return the depth or disparity channel of `path`, or its only channel, as float32.

    OpenEXR's older interface can be brought down by one wrong byte; this one cannot.
    """
    with reading(path, "an OpenEXR file", _ERRORS), _unsaid():
        channels = _channels(path)
        named = [name for name in _CHANNELS if name in channels][:1] or list(channels)
        if len(named) != 1:
            raise ValueError(f"a channel `Z` is wanted, it has {sorted(channels)}")
        return channels[named[0]]


def spread(path: Path) -> NDArray[np.float32] | None:
    """Return the channel `spread` of `path`, None where there is none."""
    with reading(path, "an OpenEXR file", _ERRORS), _unsaid():
        return _channels(path).get(_SPREAD)


@contextmanager
def _unsaid() -> Iterator[None]:
    """Keep the line that OpenEXR prints of a broken file out of what a command prints.

    Threads take turns, for all of them have one standard output.
    """
    with _printing, redirect_stdout(StringIO()):
        yield


def meaning(path: Path) -> Meaning | None:
    """Return what the header of `path` says."""
    with (
        reading(path, "an OpenEXR file", _ERRORS),
        OpenEXR.File(str(path), header_only=True) as file,
    ):
        text = file.header().get(_KEY)
        return None if text is None else parsed(str(text), path)


def _channels(path: Path) -> dict[str, NDArray[np.float32]]:
    """Return the channels of `path` by name, as float32, checked."""
    width, height = _size(path)
    with OpenEXR.File(str(path), separate_channels=True) as file:
        if not file.parts:
            raise ValueError("its pixels are cut off or broken")
        pixels = {name: channel.pixels for name, channel in file.channels().items()}
    for name, values in pixels.items():
        if values.shape != (height, width) or values.dtype.kind not in "fu":
            raise ValueError(f"channel {name} is {values.dtype} of shape {values.shape}")
    return {name: np.array(values, np.float32) for name, values in pixels.items()}


def _size(path: Path) -> tuple[int, int]:
    """Return width and height as the header declares them, checked."""
    with OpenEXR.File(str(path), header_only=True) as file:
        (left, top), (right, bottom) = (map(int, end) for end in file.header()["dataWindow"])
    check_size(right - left + 1, bottom - top + 1)
    return right - left + 1, bottom - top + 1
