"""What the loaders of published sets share: splits, lists of files, 16-bit depth, pairs of files.

A pair is looked for when a split is loaded, so that a run on half a set stops before it starts;
its files are read when it is asked for.
"""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.folder import Pair
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats import png16
from flexdepth.runtime.images import read_photo


class Split(StrEnum):
    """A published part of a data set."""

    TRAIN = "train"
    TEST = "test"


@dataclass(frozen=True)
class Line:
    """One line of a list of files.

    Attributes:
        words: What stands between its spaces; never empty.
        where: The list and the number of the line, for messages.
    """

    words: tuple[str, ...]
    where: str


@dataclass(frozen=True)
class Measured:
    """An image on disk, its depth and its camera.

    Attributes:
        name: Unique in its set, and fit for a file name.
        image: A picture.
        depth: A 16-bit PNG; 0 is unknown.
        camera: Of the image at its published size.
        size: That size, width and height. Files of another size are refused, for they would need
            another camera.
    """

    name: str
    image: Path
    depth: Path
    camera: Intrinsics
    size: tuple[int, int]


@dataclass(frozen=True)
class MeasuredPairs:
    """Pairs of files by number.

    Attributes:
        files: One item for each pair.
        steps_per_metre: What one metre is in the depth files.
    """

    files: tuple[Measured, ...]
    steps_per_metre: float

    def __len__(self) -> int:
        """Return how many pairs there are."""
        return len(self.files)

    def __getitem__(self, index: int) -> Pair:
        """Return one pair.

        Raises:
            InputError: A file is missing, damaged or of another size than the set's.
        """
        files = self.files[index]
        image, codes = read_photo(files.image).pixels, png16.numbers(files.depth)
        for path, values in ((files.image, image), (files.depth, codes)):
            check_size(path, (values.shape[1], values.shape[0]), files.size)
        depth = codes.astype(np.float32) / np.float32(self.steps_per_metre)
        return Pair(files.name, image, measured_depth(depth, files.camera))


def opencv_camera(focal: tuple[float, float], centre: tuple[float, float]) -> Intrinsics:
    """Return the camera of a set that counts the first pixel's centre as 0: here it is 0.5."""
    return Intrinsics(*focal, centre[0] + 0.5, centre[1] + 0.5, FocalSource.GIVEN)


def measured_depth(metres: NDArray[np.float32], camera: Intrinsics) -> DepthMap:
    """Return a map in which whatever is no positive finite number of metres is unknown."""
    known = np.isfinite(metres) & (metres > 0)
    return DepthMap(np.where(known, metres, np.float32(np.nan)), Space.METRIC, camera)


def lines(path: Path) -> tuple[Line, ...]:
    """Return the lines of a list of files that are not blank.

    Raises:
        InputError: The list is missing, empty or no text.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such list of files")
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: wanted a list of files, one pair a line ({error})") from error
    found = tuple(
        Line(tuple(line.split()), f"{path}, line {number}")
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip()
    )
    if not found:
        raise InputError(f"{path}: wanted a list of files, one pair a line; it is empty")
    return found


def check_size(path: Path, size: tuple[int, int], wanted: tuple[int, int]) -> None:
    """Refuse a picture or a depth map that is not at its published size.

    Raises:
        InputError: The sizes differ.
    """
    if size != wanted:
        raise InputError(
            f"{path}: wanted {wanted[0]}x{wanted[1]}, the size that the set's camera belongs to, "
            f"got {size[0]}x{size[1]}; take the files as they are published"
        )
