"""Middlebury stereo: structured light, three generations of it, as published.

    ROOT/Motorcycle/im0.png, calib.txt          2014 and 2021, and the evaluation's training sets
    ROOT/Motorcycle/disp0.pfm                   (disp0GT.pfm in the latter); inf is unknown

    ROOT/Aloe/view1.png, disp1.png, dmin.txt    2005 and 2006; 0 is unknown

    ROOT/venus/im2.png, disp2.pgm               2001 and 2003; 0 is unknown

    calib.txt   cam0=[f 0 cx; 0 f cy; 0 0 1], doffs, baseline (mm), width, height

Of the number in a PFM's third line only the sign counts.
depth = baseline · f / (disparity + doffs).

References:
    Scharstein and Szeliski, IJCV 2002 and CVPR 2003; Hirschmueller and Scharstein, CVPR 2007;
    Scharstein et al., GCPR 2014; the pages of each set.
"""

import re
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.read import opencv_camera
from flexdepth.data.stored import (
    StoredPair,
    StoredPairs,
    depth_from_disparity,
    gray,
    named,
    partners,
    picture_size,
)
from flexdepth.data.text_files import fields_of, numbers_of, parsed
from flexdepth.runtime.depthmap import FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats import pfm

_FOCAL_2006, _BASELINE_2006 = 3740.0, 0.160
_MATRIX = re.compile(r"\[\s*(\S+) 0 (\S+)\s*;\s*0 (\S+) (\S+)\s*;\s*0 0 1\s*\]")


@dataclass(frozen=True)
class StereoCalibration:
    """What a `calib.txt` says of the left camera and of its distance to the right one.

    Attributes:
        camera: The left camera.
        size: Width and height of its images.
        metres: From camera to camera.
        offset: `doffs`: how far apart the principal points are, in pixels.
    """

    camera: Intrinsics
    size: tuple[int, int]
    metres: float
    offset: float


@dataclass(frozen=True)
class PfmDisparity:
    """Disparity in a PFM file.

    Attributes:
        path: The file.
        calibration: Of its cameras.
    """

    path: Path
    calibration: StereoCalibration

    def values(self) -> NDArray[np.float32]:
        """Return metres."""
        known = self.calibration
        product = known.camera.focal_x * known.metres
        return depth_from_disparity(pfm.numbers(self.path), product, known.offset)


@dataclass(frozen=True)
class Middlebury:
    """The scenes of 2014 or 2021, or the training scenes of the evaluation, which are among them.

    Attributes:
        root: The folder that holds a folder for each scene.
    """

    root: Path = Path()

    def load(self) -> StoredPairs:
        """Return the left images, by scene.

        Raises:
            InputError: A folder is missing, or a scene lacks its image or its calibration.
        """
        return calibrated_scenes(self.root)


class MiddleburySize(IntEnum):
    """By what the images of 2005 and 2006 are smaller than full size."""

    FULL = 1
    HALF = 2
    THIRD = 3


@dataclass(frozen=True)
class GrayDisparity:
    """Disparity in gray levels.

    Attributes:
        path: The file.
        smallest: What is missing from each disparity, in pixels of full size.
    """

    path: Path
    smallest: float

    def values(self) -> NDArray[np.float32]:
        """Return metres."""
        levels = gray(self.path).astype(np.float32)
        pixels = np.where(levels > 0, levels, np.float32(np.nan))
        return depth_from_disparity(pixels, _FOCAL_2006 * _BASELINE_2006, self.smallest)


@dataclass(frozen=True)
class Middlebury2006:
    """The scenes of 2005 and 2006: f = 3740 pixels at full size, 160 mm from camera to camera.

    A gray level is a disparity in pixels of full size, whatever the size of the images, and lacks
    the number in `dmin.txt`, which is taken to be in pixels of full size too. No principal point
    is published: the middle of the image stands for it.

    Attributes:
        root: The folder that holds a folder for each scene.
        size: Of the images; it scales the focal length.
    """

    root: Path = Path()
    size: MiddleburySize = MiddleburySize.FULL

    def load(self) -> StoredPairs:
        """Return the left images (view 1), by scene.

        Raises:
            InputError: A folder is missing, or a scene lacks its image or `dmin.txt`.
        """
        images = named(self.root, r"([^/]+)/view1\.png", "SCENE/view1.png")
        disparities = named(self.root, r"([^/]+)/disp1\.png", "SCENE/disp1.png")
        files = []
        for key, image, path in partners(images, disparities, "view1.png needs a disp1.png"):
            (smallest,) = numbers_of(path.parent / "dmin.txt", 1, "the smallest disparity")
            width, height = picture_size(image)
            focal = _FOCAL_2006 / self.size
            camera = Intrinsics.centred(width, height, focal, FocalSource.GIVEN)
            files.append(StoredPair(key, image, GrayDisparity(path, smallest), camera))
        return StoredPairs(tuple(files))


@dataclass(frozen=True)
class GrayLevels:
    """Disparity of an unknown unit and offset in gray levels.

    Attributes:
        path: The file.
    """

    path: Path

    def values(self) -> NDArray[np.float32]:
        """Return the levels; 0 is unknown."""
        levels = gray(self.path).astype(np.float32)
        return np.where(levels > 0, levels, np.float32(np.nan))


@dataclass(frozen=True)
class Middlebury2003:
    """The scenes of 2001 and 2003. Nothing is known of their cameras: the truth is affine.

    A gray level is 4, 8 or 16 times a disparity in pixels, by scene; that factor is among what
    the space `affine_disparity` leaves open.

    Attributes:
        root: The folder that holds a folder for each scene.
    """

    root: Path = Path()

    def load(self) -> StoredPairs:
        """Return each image that has a disparity map, by scene and number.

        Raises:
            InputError: A folder is missing, or a disparity map lacks its image.
        """
        images = named(self.root, r"([^/]+)/im(\d)\.(?:png|ppm)", "SCENE/imN.png")
        disparities = named(self.root, r"([^/]+)/disp(\d)\.(?:png|pgm)", "SCENE/dispN.pgm")
        lonely = sorted(disparities.keys() - images.keys())
        if lonely:
            raise InputError(
                f"{disparities[lonely[0]]}: has no partner; dispN needs an imN.png or .ppm"
            )
        return StoredPairs(
            tuple(
                StoredPair(
                    key.replace("/", "_"),
                    images[key],
                    GrayLevels(disparities[key]),
                    None,
                    space=Space.AFFINE_DISPARITY,
                )
                for key in sorted(disparities)
            )
        )


def calibrated_scenes(root: Path) -> StoredPairs:
    """Return the left image of each scene that has `disp0.pfm` or `disp0GT.pfm`.

    Raises:
        InputError: The folder is missing, or a scene lacks its image or its calibration.
    """
    images = named(root, r"([^/]+)/im0\.png", "SCENE/im0.png")
    disparities = named(root, r"([^/]+)/disp0(?:GT)?\.pfm", "SCENE/disp0.pfm or disp0GT.pfm")
    files = []
    for key, image, path in partners(
        images, disparities, "im0.png needs a disp0.pfm or disp0GT.pfm"
    ):
        known = read_calibration(path.parent / "calib.txt")
        files.append(StoredPair(key, image, PfmDisparity(path, known), known.camera, known.size))
    return StoredPairs(tuple(files))


def read_calibration(path: Path) -> StereoCalibration:
    """Return what a `calib.txt` says. Principal points count the first pixel's centre as 0.

    Raises:
        InputError: The file is missing, or lacks a number.
    """
    said = fields_of(path, "a calibration of Middlebury", "=")
    left = _MATRIX.fullmatch(" ".join(said.get("cam0", [])))
    if left is None:
        raise InputError(f"{path}: wanted cam0=[f 0 cx; 0 f cy; 0 0 1], got {said.get('cam0')}")
    names = ("width", "height", "baseline", "doffs")
    width, height, millimetres, offset = (
        parsed(said.get(name, []), 1, f"{path}: wanted {name}")[0] for name in names
    )
    focal_x, centre_x, focal_y, centre_y = parsed(left.groups(), 4, f"{path}: wanted cam0")
    camera = opencv_camera((focal_x, focal_y), (centre_x, centre_y))
    if not millimetres > 0:
        raise InputError(f"{path}: wanted a baseline > 0, got {millimetres:g}")
    return StereoCalibration(camera, (round(width), round(height)), millimetres / 1000, offset)
