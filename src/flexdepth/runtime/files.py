"""Depth files: npz, npy, 16-bit PNG, OpenEXR and PFM, each of which says what its numbers mean.

What is said, and how, is at the top of `formats/meaning.py`. The float formats give every value
back to the bit, NaN and infinities included; a 16-bit PNG gives it back to half a step.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats import exr, npy, npz, pfm, png16
from flexdepth.runtime.formats.meaning import Coding, Meaning, Numbers, plain

SUFFIXES = MappingProxyType(
    {"npz": ".npz", "npy": ".npy", "png16": ".png", "exr": ".exr", "pfm": ".pfm"}
)
"""Format name, as on the command line, to file suffix."""


@dataclass(frozen=True)
class _Format:
    write: Callable[[Path, DepthMap, Mapping[str, str] | None], None]
    numbers: Callable[[Path], Numbers]
    meaning: Callable[[Path], Meaning | None]
    spread: Callable[[Path], NDArray[np.float32] | None]


def _no_room(_path: Path) -> None:
    """Formats of one map hold no spread."""


_FORMATS = MappingProxyType(
    {
        SUFFIXES[name]: _Format(module.write, module.numbers, module.meaning, spread)
        for name, module, spread in (
            ("npz", npz, npz.spread),
            ("npy", npy, _no_room),
            ("png16", png16, _no_room),
            ("exr", exr, exr.spread),
            ("pfm", pfm, _no_room),
        )
    }
)


def write_depth(
    path: Path | str, depth_map: DepthMap, origin: Mapping[str, str] | None = None
) -> None:
    """Write `depth_map` with its meaning, in the format that the suffix of `path` names.

    The file appears whole or not at all; one that was there is replaced. npy and pfm get
    NAME.json beside them.

    Args:
        path: Where to; its folder is made where it is missing.
        depth_map: What to write.
        origin: What the map was made from and how, to recognise the file by later.

    Raises:
        InputError: The suffix is none of `SUFFIXES`, or the file cannot be written.
    """
    _format(Path(path)).write(Path(path), depth_map, origin)


def read_depth(path: Path | str) -> DepthMap:
    """Return the depth map in `path`.

    Raises:
        InputError: The file is missing or broken, or does not say what its numbers mean: that
            is never guessed, for a wrong guess is off by a factor.
    """
    file = Path(path)
    kind = _format(file)
    return _meaning(file).depth_map(kind.numbers(file), file, kind.spread(file))


def read_meaning(path: Path) -> dict[str, object]:
    """Return what `path` says of its numbers, as in `formats/meaning.py`, without reading them.

    Raises:
        InputError: The file is missing or broken, or does not say what its numbers mean.
    """
    return _meaning(path).record()


def read_origin(path: Path) -> dict[str, str]:
    """Return what `path` was made from and how, as `write_depth` was told.

    Raises:
        InputError: The file is missing or broken, or does not say what its numbers mean.
    """
    return dict(_meaning(path).origin)


def read_stated(path: Path, space: Space, scale: float) -> DepthMap:
    """Return the map in a file that does not say what its numbers mean, for the caller does.

    0 is unknown in a PNG, and in any file of the spaces `metric` and `scale`, where no depth is
    0. The camera is unknown.

    Args:
        path: A file in one of the formats, by its suffix.
        space: What the numbers are ambiguous up to.
        scale: Value of the stored number 1; metres if `space` is metric.

    Raises:
        InputError: The file is missing or broken, or has a meaning of its own.
    """
    if _format(path).meaning(path) is not None:
        raise InputError(f"{path}: says itself what its numbers mean; leave space and scale out")
    numbers = _format(path).numbers(path)
    height, width = numbers.shape
    no_zero = space in (Space.METRIC, Space.SCALE)
    coding = Coding(scale, 0.0, 0 if no_zero else plain(space).invalid, None)
    return Meaning(space, width, height, coding).depth_map(numbers, path)


def _format(path: Path) -> _Format:
    if path.suffix.lower() not in _FORMATS:
        raise InputError(f"{path}: a depth file ends in one of {', '.join(_FORMATS)}")
    return _FORMATS[path.suffix.lower()]


def _meaning(path: Path) -> Meaning:
    said = _format(path).meaning(path)
    if said is None:
        raise InputError(
            f"{path}: does not say what its numbers mean; state it once, for instance "
            f"`flexdepth convert {path} --format npz --space metric --scale 0.001` "
            f"for millimetres"
        )
    return said
