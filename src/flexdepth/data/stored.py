"""A picture on disk and its depth as its set stores it: what the pairs of most loaders are made of.

Files are looked for when a set is loaded, so that half a set is refused before it is used; they
are read when their pair is asked for.
"""

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flexdepth.data.folder import Pair, check_partners
from flexdepth.data.read import check_size
from flexdepth.runtime.depthmap import DepthMap, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats import png16
from flexdepth.runtime.formats.reading import reading
from flexdepth.runtime.images import read_photo

PICTURE_ERRORS = (SyntaxError, ValueError, TypeError, KeyError, IndexError, EOFError)
"""What Pillow raises on broken pictures, besides `OSError`."""


@runtime_checkable
class StoredDepth(Protocol):
    """Depth as a set stores it."""

    @property
    def path(self) -> Path:
        """The file that is named where something is wrong."""
        ...

    def values(self) -> NDArray[np.float32]:
        """Return the map in the numbers of its space; NaN is unknown, +inf sky.

        Raises:
            InputError: The file is missing, damaged or of another kind.
        """
        ...


@dataclass(frozen=True)
class StoredPair:
    """A picture, its depth and its camera.

    Attributes:
        name: Unique in its set, and fit for a file name.
        image: A picture.
        depth: At the picture's size.
        camera: In pixels of the picture as it is published; None where nothing is published.
        size: Width and height that the camera belongs to; None where any will do.
        space: What the depth is ambiguous up to.
    """

    name: str
    image: Path
    depth: StoredDepth
    camera: Intrinsics | None
    size: tuple[int, int] | None = None
    space: Space = Space.METRIC

    def read(self) -> Pair:
        """Return the pair.

        Raises:
            InputError: A file is missing or damaged, or of another size than it should be.
        """
        image, values = read_photo(self.image).pixels, self.depth.values()
        height, width = image.shape[:2]
        if self.size is not None:
            check_size(self.image, (width, height), self.size)
        if values.shape != (height, width):
            raise InputError(
                f"{self.depth.path}: holds {values.shape[1]}x{values.shape[0]} values, its image "
                f"{self.image} has {width}x{height} pixels; take the files as they are published"
            )
        return Pair(self.name, image, DepthMap(values, self.space, self.camera))


@dataclass(frozen=True)
class StoredPairs:
    """Pairs of files by number."""

    files: tuple[StoredPair, ...]

    def __len__(self) -> int:
        """Return how many pairs there are."""
        return len(self.files)

    def __getitem__(self, index: int) -> Pair:
        """Return one pair.

        Raises:
            InputError: As `StoredPair.read`.
        """
        return self.files[index].read()


@dataclass(frozen=True)
class Codes:
    """Depth in a 16-bit PNG.

    Attributes:
        path: The file.
        steps_per_metre: What one metre is in it.
        unknown: Codes that mean that nothing was measured.
        sky: The code of sky; None where there is none.
    """

    path: Path
    steps_per_metre: float
    unknown: tuple[int, ...] = (0,)
    sky: int | None = None

    def values(self) -> NDArray[np.float32]:
        """Return metres."""
        codes = png16.numbers(self.path)
        metres = codes.astype(np.float32) / np.float32(self.steps_per_metre)
        for code in self.unknown:
            metres[codes == code] = np.nan
        if self.sky is not None:
            metres[codes == self.sky] = np.inf
        return metres


def known(metres: NDArray[np.floating]) -> NDArray[np.float32]:
    """Return float32 in which whatever is no positive finite number is unknown."""
    values = np.asarray(metres, np.float32)
    return np.where(np.isfinite(values) & (values > 0), values, np.float32(np.nan))


def planar(distance: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.float32]:
    """Return z from the distance along each pixel's ray: z = distance / |K⁻¹ (u, v, 1)|."""
    height, width = distance.shape
    across = (np.arange(width) + 0.5 - camera.centre_x) / camera.focal_x
    down = (np.arange(height) + 0.5 - camera.centre_y) / camera.focal_y
    length = np.sqrt(across[None, :] ** 2 + down[:, None] ** 2 + 1)
    return np.asarray(distance / length, np.float32)


def depth_from_disparity(
    disparity: NDArray[np.float32], focal_times_baseline: float, offset: float = 0.0
) -> NDArray[np.float32]:
    """Return z = focal · baseline / (disparity + offset); unknown where that is not positive.

    Args:
        disparity: In pixels; NaN and infinity are unknown.
        focal_times_baseline: In pixels times metres.
        offset: What the disparity of the infinitely far lacks to zero, in pixels.
    """
    shift = disparity.astype(np.float64) + offset
    measured = np.isfinite(shift) & (shift > 0)
    metres = focal_times_baseline / np.where(measured, shift, np.nan)
    return metres.astype(np.float32)


def picture_size(path: Path) -> tuple[int, int]:
    """Return width and height of a picture, from its header.

    Raises:
        InputError: It is missing, or no picture.
    """
    with reading(path, "a picture", PICTURE_ERRORS), Image.open(path) as picture:
        return picture.size


def gray(path: Path) -> NDArray[np.uint8]:
    """Return a picture of 8 bits and one channel as it is stored.

    Raises:
        InputError: It is missing, damaged, in colour or of another depth.
    """
    with reading(path, "a gray picture of 8 bits", PICTURE_ERRORS), Image.open(path) as picture:
        if picture.mode != "L":
            raise ValueError(f"its mode is {picture.mode}")
        return np.asarray(picture)


def existing(folder: Path, holds: str) -> Path:
    """Return the folder.

    Args:
        folder: Where files should lie.
        holds: What it should hold, for the message.

    Raises:
        InputError: There is no such folder.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; it should hold {holds}")
    return folder


def named(folder: Path, pattern: str, holds: str) -> dict[str, Path]:
    """Return the files below a folder by what their path has in common with their partners.

    Args:
        folder: Where to look, at any depth; links to folders are followed.
        pattern: A regular expression for the whole path below the folder, with / between its
            parts; the key is its groups, joined by /.
        holds: What the folder should hold, for the message.

    Raises:
        InputError: There is no such folder, or no such file in it.
    """
    existing(folder, holds)
    whole = re.compile(pattern)
    every = (
        Path(place, name) for place, _, names in os.walk(folder, followlinks=True) for name in names
    )
    matched = ((path, whole.fullmatch(path.relative_to(folder).as_posix())) for path in every)
    found = {"/".join(match.groups()): path for path, match in matched if match is not None}
    if not found:
        raise InputError(f"{folder}: looked for {holds}; there are none")
    return found


def partners(
    images: Mapping[str, Path], depths: Mapping[str, Path], rule: str
) -> tuple[tuple[str, Path, Path], ...]:
    """Return (key, image, depth) for each key, in their order.

    Args:
        images: By key, as `named` finds them.
        depths: Likewise.
        rule: What every file needs, for the message.

    Raises:
        InputError: A file stands alone; the first is named.
    """
    check_partners(dict(images), dict(depths), rule)
    return tuple((key, images[key], depths[key]) for key in sorted(images))
