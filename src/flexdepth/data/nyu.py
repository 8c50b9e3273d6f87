"""NYU Depth v2: the labelled images in their MATLAB file, and the synchronised frames in folders.

    ROOT/nyu_depth_v2_labeled.mat       images, depths (holes filled), rawDepths; HDF5
    ROOT/splits.mat                     trainNdxs (795), testNdxs (654), counted from 1

    ROOT/sync/SCENE/rgb_00045.jpg                           24,231 frames as BTS selected them
    ROOT/sync/SCENE/sync_depth_00045.png                    16 bits, millimetres, 0 is unknown
    ROOT/official_splits/test/SCENE/...                     the same names

References:
    Silberman, Hoiem, Kohli and Fergus, ECCV 2012; Lee et al., From Big to Small (BTS), 2019, for
    the folders.
"""

import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import h5py
import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadError

from flexdepth.data.folder import Pair, check_partners
from flexdepth.data.read import (
    Line,
    Measured,
    MeasuredPairs,
    Split,
    lines,
    measured_depth,
    opencv_camera,
)
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats.reading import reading

SIZE = (640, 480)
"""Width and height of every image."""

CAMERA = opencv_camera(
    (518.85790117450188, 519.46961112127485), (325.58244941119034, 253.73616633400465)
)
"""The colour camera of the set's toolbox (`camera_params.m`), to which depth is registered.

It was calibrated with RGBDemo, thus OpenCV: the first pixel's centre is 0 there and 0.5 here.
"""

_LABELLED, _SPLITS = "nyu_depth_v2_labeled.mat", "splits.mat"
_INDICES = {Split.TRAIN: "trainNdxs", Split.TEST: "testNdxs"}
_HDF5_ERRORS = (KeyError, ValueError, TypeError, AttributeError, RuntimeError)
_MATLAB_ERRORS = (MatReadError, ValueError, TypeError, LookupError, ArithmeticError, zlib.error)

_FOLDERS = {Split.TRAIN: Path("sync"), Split.TEST: Path("official_splits/test")}
_NAMES = "rgb_NNNNN.jpg and sync_depth_NNNNN.png"
_FRAME = re.compile(r"(?:rgb_(\d+)\.jpg|sync_depth_(\d+)\.png)")


class NyuDepth(StrEnum):
    """Which of the two depth maps of a labelled image."""

    FILLED = "depths"
    """Holes filled by colourisation, for training."""
    RAW = "rawDepths"
    """As the sensor gave it, projected to the colour camera; unknown in holes."""


@dataclass(frozen=True)
class NyuLabelled:
    """The 1449 labelled images, by their official split: 795 to train, 654 to test.

    Attributes:
        root: The folder that holds `nyu_depth_v2_labeled.mat` and `splits.mat`.
        split: Which of them.
        depth: Filled or raw.
    """

    root: Path = Path()
    split: Split = Split.TRAIN
    depth: NyuDepth = NyuDepth.FILLED

    def load(self) -> "LabelledPairs":
        """Return the pairs, in the order of the split.

        Raises:
            InputError: A file is missing, damaged or holds something else.
        """
        path, splits = self.root / _LABELLED, self.root / _SPLITS
        for file in (path, splits):
            if not file.is_file():
                raise InputError(f"{file}: no such file; wanted {path.name} and {splits.name}")
        with _hdf5(path) as labelled:
            images, depths = (labelled[key].shape for key in ("images", self.depth.value))
        wanted = ((*images[:1], 3, *SIZE), (*images[:1], *SIZE))
        if (images, depths) != wanted:
            raise InputError(
                f"{path}: wanted images and {self.depth} of shapes {wanted[0]} and {wanted[1]}, "
                f"got {images} and {depths}; take the file as it is published"
            )
        numbers = _numbers(splits, self.split, images[0])
        return LabelledPairs(path, numbers, self.depth)


@dataclass(frozen=True)
class LabelledPairs:
    """Labelled images by number; the file is opened for each, so that any process may ask.

    Attributes:
        path: The labelled file.
        numbers: Of the images in it, counted from 1 as the splits do; a pair is named after it.
        depth: Filled or raw.
    """

    path: Path
    numbers: tuple[int, ...]
    depth: NyuDepth

    def __len__(self) -> int:
        """Return how many pairs there are."""
        return len(self.numbers)

    def __getitem__(self, index: int) -> Pair:
        """Return one pair.

        Raises:
            InputError: The file is damaged.
        """
        number = self.numbers[index]
        with _hdf5(self.path) as file:
            image, depth = (file[key][number - 1] for key in ("images", self.depth.value))
        # MATLAB counts columns first: an image lies here as colour, column, row.
        upright = np.ascontiguousarray(image.transpose(2, 1, 0), np.uint8)
        metres = np.ascontiguousarray(depth.T, np.float32)
        return Pair(f"{number:04d}", upright, measured_depth(metres, CAMERA))


@dataclass(frozen=True)
class NyuFolders:
    """The synchronised frames, extracted.

    Attributes:
        root: The folder that holds `sync` (to train) and `official_splits/test`.
        split: Which of the two.
        frames: A list of frames, a line each, as BTS lists them:
            `SCENE/rgb_00045.jpg SCENE/sync_depth_00045.png 518.8579`. It is looked for in `root`
            unless its path is absolute. Without it, all frames there are.
    """

    root: Path = Path()
    split: Split = Split.TRAIN
    frames: Path | None = None

    def load(self) -> MeasuredPairs:
        """Return the pairs, in the order of the list, or else of their names.

        The focal length in a list is not read: the camera is the set's own, `CAMERA`.

        Raises:
            InputError: A folder, a list or a file is missing, or a frame has no partner.
        """
        folder = self.root / _FOLDERS[self.split]
        if not folder.is_dir():
            raise InputError(f"{folder}: no such folder; it should hold SCENE/{_NAMES}")
        files = (
            tuple(_found(folder))
            if self.frames is None
            else tuple(_listed(folder, line) for line in lines(self.root / self.frames))
        )
        if not files:
            raise InputError(f"{folder}: holds no frames; looked for SCENE/{_NAMES}")
        return MeasuredPairs(files, 1000.0)


@contextmanager
def _hdf5(path: Path) -> Iterator[h5py.File]:
    with reading(path, "the labelled images of NYU (HDF5)", _HDF5_ERRORS), h5py.File(path) as file:
        yield file


def _numbers(path: Path, split: Split, count: int) -> tuple[int, ...]:
    key = _INDICES[split]
    with reading(path, "the splits of NYU (MATLAB)", _MATLAB_ERRORS):
        numbers = tuple(int(n) for n in np.ravel(loadmat(path, appendmat=False)[key]))
    if not numbers or not 1 <= min(numbers) <= max(numbers) <= count:
        raise InputError(
            f"{path}: {key} should hold numbers from 1 to {count}, the images in {_LABELLED}; "
            f"got {min(numbers, default=None)} to {max(numbers, default=None)}"
        )
    return numbers


def _listed(folder: Path, line: Line) -> Measured:
    if len(line.words) < 2:
        raise InputError(f"{line.where}: wanted SCENE/{_NAMES}, got {' '.join(line.words)!r}")
    image, depth = (folder / word.lstrip("/") for word in line.words[:2])
    if image.parent != depth.parent or _frame(image) != _frame(depth):
        raise InputError(f"{line.where}: {image.name} and {depth.name} are not of one frame")
    for path in (image, depth):
        if not path.is_file():
            raise InputError(f"{line.where}: looked for {path}; there is no such file")
    return _measured(folder, image, depth)


def _found(folder: Path) -> list[Measured]:
    images, depths = (
        {(path.parent, _frame(path)): path for path in folder.rglob(pattern)}
        for pattern in ("rgb_*.jpg", "sync_depth_*.png")
    )
    check_partners(images, depths, f"frame needs {_NAMES} in one folder")
    return [_measured(folder, images[frame], depths[frame]) for frame in sorted(images)]


def _frame(path: Path) -> str:
    match = _FRAME.fullmatch(path.name)
    if match is None:
        raise InputError(f"{path}: is no frame's name; wanted {_NAMES}")
    return match[1] or match[2]


def _measured(folder: Path, image: Path, depth: Path) -> Measured:
    scene = image.parent.relative_to(folder).parts
    return Measured("_".join((*scene, _frame(image))), image, depth, CAMERA, SIZE)
