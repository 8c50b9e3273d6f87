"""KITTI: the raw drives, the annotated depth maps and lists of frames, as they are published.

    RAW/2011_09_26/calib_cam_to_cam.txt
    RAW/2011_09_26/2011_09_26_drive_0001_sync/image_02/data/0000000005.png      (or .jpg)
    DEPTH/train/2011_09_26_drive_0001_sync/proj_depth/groundtruth/image_02/0000000005.png
    DEPTH/val/...                       16 bits, 1/256 m, 0 is unknown; `train` and `val` may be
                                        missing, as in BTS's copy

A list of frames is written in one of two ways:

    2011_09_26/2011_09_26_drive_0001_sync 5 l                       monodepth2; l is image_02
    2011_09_26/2011_09_26_drive_0001_sync/image_02/data/0000000005.png
        2011_09_26_drive_0001_sync/proj_depth/groundtruth/image_02/0000000005.png 721.5377
                                                                    BTS, in one line; or `None`

References:
    Geiger et al., IJRR 2013; Uhrig et al., 3DV 2017, for the annotated depth.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

from flexdepth.data.read import Line, Measured, MeasuredPairs, lines, opencv_camera
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError

EIGEN_TRAIN = Path("eigen_train_files_with_gt.txt")
EIGEN_TEST = Path("eigen_test_files_with_gt.txt")
"""BTS's names for the lists of Eigen's split."""

_DRIVE = r"\d{4}_\d\d_\d\d/(\d{4}_\d\d_\d\d_drive_\d{4}_sync)"
_SEQUENCE = re.compile(_DRIVE)
_IMAGE = re.compile(rf"/?{_DRIVE}/(image_0[23])/data/(\d{{10}})\.(?:png|jpg)")
_SIDES = {"l": "image_02", "r": "image_03"}
_DATE = len("2011_09_26")


@dataclass(frozen=True)
class Kitti:
    """Listed frames of the raw drives with their annotated depth; Eigen's split is two lists.

    Attributes:
        root: Where the other paths start, unless they are absolute.
        raw: The folder that holds a folder for each date.
        depth: The folder that holds `train` and `val` of the annotated depth.
        frames: The list.
    """

    root: Path = Path()
    raw: Path = Path("raw")
    depth: Path = Path("depth")
    frames: Path = EIGEN_TRAIN

    def load(self) -> MeasuredPairs:
        """Return the listed pairs, in the order of the list.

        A frame that the set itself has no annotated depth for is left out: one whose list says
        `None`, or one of a list that does not speak of depth. These are a drive's first and last
        five frames, and a few whose laser scan was lost. A drive without any depth is refused.
        The camera is that of `calib_cam_to_cam.txt`; a focal length in a list is not read.

        Raises:
            InputError: A list, a calibration or a file is missing, or a list pairs an image with
                the depth of another.
        """
        chosen, depth = self.root / self.frames, self.root / self.depth
        if not chosen.is_file():
            raise InputError(
                f"{chosen}: no such list of frames; wanted {self.root} with this list, "
                f"{self.raw}/DATE/DRIVE_sync and {self.depth}/train/DRIVE_sync"
            )
        drives = _Drives(self.root / self.raw, depth)
        found = tuple(drives.measured(_frame(line), line.where) for line in lines(chosen))
        files = tuple(frame for frame in found if frame is not None)
        if not files:
            raise InputError(f"{chosen}: {depth} has no annotated depth for any of its frames")
        return MeasuredPairs(files, 256.0)


@dataclass(frozen=True)
class _Frame:
    """One line of a list; `depth` is what it says of the depth file, None where it is silent."""

    drive: str
    camera: str
    number: str
    depth: str | None

    @property
    def truth(self) -> Path:
        return Path(self.drive, "proj_depth", "groundtruth", self.camera, f"{self.number}.png")


@dataclass(frozen=True)
class _Drives:
    """Where files are; what is known of a drive or a date is looked up once."""

    raw: Path
    depth: Path
    cameras: dict[tuple[str, str], tuple[Intrinsics, tuple[int, int]]] = field(default_factory=dict)
    folders: dict[tuple[str, str], Path] = field(default_factory=dict)

    def measured(self, frame: _Frame, where: str) -> Measured | None:
        if frame.depth == "None":
            return None
        depth = self._folder(frame, where) / frame.truth.name
        if not depth.is_file():
            if frame.depth is None:
                return None
            raise InputError(f"{where}: looked for {depth}; there is no such file")
        camera, size = self._camera(frame)
        name = f"{frame.drive}_{frame.camera}_{frame.number}"
        return Measured(name, self._image(frame, where), depth, camera, size)

    def _image(self, frame: _Frame, where: str) -> Path:
        folder = self.raw / frame.drive[:_DATE] / frame.drive / frame.camera / "data"
        for suffix in (".png", ".jpg"):
            path = folder / f"{frame.number}{suffix}"
            if path.is_file():
                return path
        raise InputError(f"{where}: looked for {folder / frame.number}.png or .jpg; there is none")

    def _folder(self, frame: _Frame, where: str) -> Path:
        key = (frame.drive, frame.camera)
        if key not in self.folders:
            places = [self.depth / part / frame.truth.parent for part in ("train", "val", "")]
            folder = next((place for place in places if place.is_dir()), None)
            if folder is None:
                raise InputError(
                    f"{where}: looked for {frame.truth.parent} in {self.depth / 'train'}, "
                    f"{self.depth / 'val'} and {self.depth}; there is no such folder"
                )
            self.folders[key] = folder
        return self.folders[key]

    def _camera(self, frame: _Frame) -> tuple[Intrinsics, tuple[int, int]]:
        key = (frame.drive[:_DATE], frame.camera)
        if key not in self.cameras:
            path = self.raw / key[0] / "calib_cam_to_cam.txt"
            self.cameras[key] = calibrated_camera(path, frame.camera.removeprefix("image_"))
        return self.cameras[key]


def calibrated_camera(path: Path, number: str) -> tuple[Intrinsics, tuple[int, int]]:
    """Return a rectified camera of a date, with the width and height of its images.

    KITTI counts the first pixel's centre as 0: half a pixel is added.

    Args:
        path: `calib_cam_to_cam.txt`.
        number: `02` for the left colour camera, `03` for the right one.

    Raises:
        InputError: The file is missing or does not describe that camera.
    """
    said = {line.words[0].removesuffix(":"): line.words[1:] for line in lines(path)}
    try:
        matrix = [float(word) for word in said[f"P_rect_{number}"]]
        width, height = (round(float(word)) for word in said[f"S_rect_{number}"])
        focal_x, _, centre_x, _, _, focal_y, centre_y, *_ = matrix
        return opencv_camera((focal_x, focal_y), (centre_x, centre_y)), (width, height)
    except (KeyError, ValueError, OverflowError) as error:
        raise InputError(
            f"{path}: wanted S_rect_{number} (width, height) and P_rect_{number} (3 x 4 numbers) "
            f"as KITTI writes them ({error})"
        ) from error


def _frame(line: Line) -> _Frame:
    words = line.words
    if (image := _IMAGE.fullmatch(words[0])) and len(words) > 1:
        frame = _Frame(image[1], image[2], image[3], words[1])
        if words[1] != "None" and not words[1].endswith(frame.truth.as_posix()):
            raise InputError(f"{line.where}: {words[0]} and {words[1]} are not of one frame")
        return frame
    if (drive := _SEQUENCE.fullmatch(words[0])) and len(words) == 3:
        _, number, side = words
        if number.isdecimal() and side in _SIDES:
            return _Frame(drive[1], _SIDES[side], f"{int(number):010d}", None)
    raise InputError(
        f"{line.where}: wanted 'DATE/DRIVE_sync NUMBER l' or "
        f"'DATE/DRIVE_sync/image_02/data/NUMBER.png DEPTH.png', got {' '.join(words)!r}"
    )
