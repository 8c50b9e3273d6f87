"""KITTI's laser: scans projected into the colour camera, of the raw drives and of the object set.

    ROOT/2011_09_26/calib_cam_to_cam.txt, calib_velo_to_cam.txt                     raw drives
    ROOT/2011_09_26/2011_09_26_drive_0001_sync/image_02/data/0000000005.png         (or .jpg)
    ROOT/2011_09_26/2011_09_26_drive_0001_sync/velodyne_points/data/0000000005.bin

    ROOT/training/image_2/000000.png                                                object set
    ROOT/training/velodyne/000000.bin               float32 x, y, z, reflectance; metres
    ROOT/training/calib/000000.txt                  P2, R0_rect, Tr_velo_to_cam

This is the ground truth that self-supervised work calls "raw": about 4 % of the pixels, with
points seen past the edges of near things, for the laser stands above the camera. Annotated depth
is `Kitti`'s.

References:
    Geiger et al., IJRR 2013, eqs. 3 to 8; Geiger, Lenz and Urtasun, CVPR 2012.
"""

import re
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.kitti import calibrated_camera
from flexdepth.data.read import Line, lines, opencv_camera
from flexdepth.data.stored import StoredPair, StoredPairs, named, partners, picture_size
from flexdepth.data.text_files import fields_of, parsed
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats.reading import reading

_LISTED = re.compile(
    r"/?(?P<date>\d{4}_\d\d_\d\d)/(?P<drive>\d{4}_\d\d_\d\d_drive_\d{4}_sync)"
    r"(?: (?P<short>\d+) (?P<side>[lr])"
    r"|/image_(?P<camera>0[23])/data/(?P<number>\d{10})\.(?:png|jpg)(?: .*)?)"
)
_CAMERAS = {"l": "02", "r": "03"}

Matrix = NDArray[np.float64]


class LaserDepth(StrEnum):
    """What the depth of a laser point is."""

    CAMERA = "camera"
    """z of the camera, in the pixel that the point falls into."""
    MONODEPTH2 = "monodepth2"
    """How far it lies ahead of the laser, 0.27 m more, in the pixel above and to the left of it.

    That is monodepth2's `generate_depth_map(..., vel_depth=True)`, the truth of its "eigen" split
    and of all figures that are compared with it.
    """


@dataclass(frozen=True, eq=False)
class LaserScan:
    """A scan seen by a camera.

    Attributes:
        path: The scan.
        image: The picture, for its size.
        image_from_laser: 3 x 4, as `seen` takes it.
        depth: What the depth of a point is.
    """

    path: Path
    image: Path
    image_from_laser: Matrix
    depth: LaserDepth

    def values(self) -> NDArray[np.float32]:
        """Return metres; of points in one pixel the nearest counts."""
        size = picture_size(self.image)
        return seen(read_scan(self.path), self.image_from_laser, size, self.depth)


@dataclass(frozen=True)
class KittiVelodyne:
    """Listed frames of the raw drives with the laser's scan of the same moment.

    Attributes:
        root: The folder that holds a folder for each date.
        frames: The list, in `root` unless its path is absolute: `DATE/DRIVE_sync NUMBER l` or
            `DATE/DRIVE_sync/image_02/data/NUMBER.png ...`.
        depth: What the depth of a point is.
    """

    root: Path = Path()
    frames: Path = Path("test_files.txt")
    depth: LaserDepth = LaserDepth.CAMERA

    def load(self) -> StoredPairs:
        """Return the listed pairs, in the order of the list.

        Raises:
            InputError: The list, a calibration or a file is missing.
        """
        calibrations: dict[tuple[Path, str], _Calibration] = {}
        files = []
        for line in lines(self.root / self.frames):
            date, drive, camera, number = _listed(line)
            key = (self.root / date, camera)
            if key not in calibrations:
                calibrations[key] = _Calibration.of(*key)
            stem = self.root / date / drive / f"image_{camera}" / "data" / number
            image = _first((stem.with_suffix(".png"), stem.with_suffix(".jpg")), line.where)
            scans = self.root / date / drive / "velodyne_points" / "data"
            scan = _first((scans / f"{number}.bin",), line.where)
            known = calibrations[key]
            laser = LaserScan(scan, image, known.image_from_laser, self.depth)
            name = f"{drive}_image_{camera}_{number}"
            files.append(StoredPair(name, image, laser, known.camera, known.size))
        return StoredPairs(tuple(files))


@dataclass(frozen=True)
class KittiObject:
    """The training images of the object benchmark with their scans.

    Attributes:
        root: The folder that holds `training`.
    """

    root: Path = Path()

    def load(self) -> StoredPairs:
        """Return the pairs, by number.

        Raises:
            InputError: A folder is missing, or a frame lacks its image, scan or calibration.
        """
        training = self.root / "training"
        images = named(training, r"image_2/(\d{6})\.png", "image_2/NNNNNN.png")
        scans = named(training, r"velodyne/(\d{6})\.bin", "velodyne/NNNNNN.bin")
        calibrations = named(training, r"calib/(\d{6})\.txt", "calib/NNNNNN.txt")
        partners(images, calibrations, "image_2/NNNNNN.png needs a calib/NNNNNN.txt")
        rule = "image_2/NNNNNN.png needs a velodyne/NNNNNN.bin"
        files = []
        for key, image, scan in partners(images, scans, rule):
            p2, image_from_laser = _object_projection(calibrations[key])
            camera = opencv_camera((p2[0, 0], p2[1, 1]), (p2[0, 2], p2[1, 2]))
            laser = LaserScan(scan, image, image_from_laser, LaserDepth.CAMERA)
            files.append(StoredPair(key, image, laser, camera))
        return StoredPairs(tuple(files))


def read_scan(path: Path) -> Matrix:
    """Return the points of a scan: n x 3, metres; x ahead, y left, z up.

    Raises:
        InputError: The file is missing, empty or no scan.
    """
    with reading(path, "a laser scan (x, y, z, reflectance in float32)", (ValueError,)):
        numbers = np.fromfile(path, "<f4")
        if not numbers.size or numbers.size % 4 or not np.isfinite(numbers).all():
            raise ValueError(f"finite numbers by four are wanted, {numbers.size} are there")
    return numbers.reshape(-1, 4)[:, :3].astype(np.float64)


def seen(
    points: Matrix, image_from_laser: Matrix, size: tuple[int, int], depth: LaserDepth
) -> NDArray[np.float32]:
    """Return the depth map that a camera would see of points.

    Args:
        points: n x 3, as `read_scan` gives them.
        image_from_laser: 3 x 4; the first pixel's centre is 0, and the third row gives z.
        size: Width and height of the map.
        depth: What the depth of a point is.
    """
    ahead = points[points[:, 0] >= 0]
    u, v, z = image_from_laser @ np.vstack([ahead.T, np.ones(len(ahead))])
    before = z > 0
    u, v, z, forward = u[before] / z[before], v[before] / z[before], z[before], ahead[before, 0]
    if depth is LaserDepth.MONODEPTH2:
        column, row, z = np.round(u) - 1, np.round(v) - 1, forward
    else:
        column, row = np.floor(u + 0.5), np.floor(v + 0.5)
    inside = (column >= 0) & (column < size[0]) & (row >= 0) & (row < size[1])
    column, row, z = column[inside].astype(int), row[inside].astype(int), z[inside]
    nearest_last = np.argsort(-z)
    values = np.full((size[1], size[0]), np.nan, np.float32)
    values[row[nearest_last], column[nearest_last]] = z[nearest_last]
    return values


def field_matrix(path: Path, name: str, shape: tuple[int, int]) -> Matrix:
    """Return a matrix of a calibration: the line `NAME: numbers`.

    Raises:
        InputError: The file or the line is missing, or holds another count of numbers.
    """
    said = fields_of(path, "a calibration of KITTI")
    wanted = f"{path}: wanted {name}"
    return np.array(parsed(said.get(name, []), shape[0] * shape[1], wanted)).reshape(shape)


@dataclass(frozen=True, eq=False)
class _Calibration:
    """What is known of one camera on one date."""

    camera: Intrinsics
    size: tuple[int, int]
    image_from_laser: Matrix

    @classmethod
    def of(cls, date: Path, number: str) -> "_Calibration":
        cameras, laser = date / "calib_cam_to_cam.txt", date / "calib_velo_to_cam.txt"
        rectified, camera_from_laser = np.eye(4), np.eye(4)
        rectified[:3, :3] = field_matrix(cameras, "R_rect_00", (3, 3))
        camera_from_laser[:3, :3] = field_matrix(laser, "R", (3, 3))
        camera_from_laser[:3, 3] = field_matrix(laser, "T", (1, 3))[0]
        projection = field_matrix(cameras, f"P_rect_{number}", (3, 4))
        image_from_laser = projection @ rectified @ camera_from_laser
        return cls(*calibrated_camera(cameras, number), image_from_laser)


def _object_projection(path: Path) -> tuple[Matrix, Matrix]:
    """Return P2 and what takes the laser's points to the left colour image."""
    rectified, p2 = np.eye(4), field_matrix(path, "P2", (3, 4))
    rectified[:3, :3] = field_matrix(path, "R0_rect", (3, 3))
    camera_from_laser = np.vstack([field_matrix(path, "Tr_velo_to_cam", (3, 4)), [0, 0, 0, 1]])
    return p2, p2 @ rectified @ camera_from_laser


def _listed(line: Line) -> tuple[str, str, str, str]:
    """Return date, drive, camera and number of a frame in a list."""
    match = _LISTED.fullmatch(" ".join(line.words))
    if match is None:
        raise InputError(
            f"{line.where}: wanted 'DATE/DRIVE_sync NUMBER l' or "
            f"'DATE/DRIVE_sync/image_02/data/NUMBER.png', got {' '.join(line.words)!r}"
        )
    camera = match["camera"] or _CAMERAS[match["side"]]
    return match["date"], match["drive"], camera, match["number"] or f"{int(match['short']):010d}"


def _first(paths: tuple[Path, ...], where: str) -> Path:
    for path in paths:
        if path.is_file():
            return path
    looked = " or ".join(str(path) for path in paths)
    raise InputError(f"{where}: looked for {looked}; there is none")
