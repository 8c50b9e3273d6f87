"""SUN RGB-D: 10,335 images of four sensors, as published.

    ROOT/kv1/b3dodata/img_0063/image/img_0063.jpg
    ROOT/kv1/b3dodata/img_0063/depth/img_0063_abs_smooth.png        as the sensor gave it
    ROOT/kv1/b3dodata/img_0063/depth_bfx/img_0063_abs_smooth.png    holes filled by other views
    ROOT/kv1/b3dodata/img_0063/intrinsics.txt                       3 x 3
    SPLITS/allsplit.mat             alltrain (5285), alltest (5050); in SUNRGBDtoolbox

Depth has 16 bits, turned by three: millimetres = (code >> 3) | (code << 13). The set's toolbox
brings what is beyond 8 m to 8 m; here it stays what it is. Principal points count the first
pixel's centre as 0, for those of the NYU images are the ones of NYU less the cut-off columns.

References:
    Song, Lichtenberg and Xiao, CVPR 2015; `read3dPoints.m` of the toolbox.
"""

import zlib
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat
from scipy.io.matlab import MatReadError

from flexdepth.data.read import Split, opencv_camera
from flexdepth.data.stored import StoredPair, StoredPairs, existing, named, partners
from flexdepth.data.text_files import numbers_of
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats import png16
from flexdepth.runtime.formats.reading import reading

_FIELDS = {Split.TRAIN: "alltrain", Split.TEST: "alltest"}
_ANCHOR = "SUNRGBD/"
_ERRORS = (MatReadError, ValueError, TypeError, LookupError, ArithmeticError, zlib.error)


class SunDepth(StrEnum):
    """Which of the two depth maps of an image."""

    RAW = "depth"
    """As the sensor gave it."""
    REFINED = "depth_bfx"
    """With holes filled from neighbouring frames."""


@dataclass(frozen=True)
class TurnedCodes:
    """Millimetres in 16 bits, turned left by three.

    Attributes:
        path: The file.
    """

    path: Path

    def values(self) -> NDArray[np.float32]:
        """Return metres; 0 is unknown."""
        codes = png16.numbers(self.path)
        millimetres = (codes >> 3) | (codes << 13)
        metres = millimetres.astype(np.float32) / np.float32(1000)
        return np.where(millimetres > 0, metres, np.float32(np.nan))


@dataclass(frozen=True)
class SunRgbd:
    """Images with depth of a Kinect v1, a Kinect v2, a RealSense or an Xtion.

    Attributes:
        root: The folder that holds `kv1`, `kv2`, `realsense` and `xtion`, or one below it.
        splits: The folder of `allsplit.mat`, in `root` unless its path is absolute; None takes
            every image that there is.
        split: Which part, where `splits` is given.
        depth: Raw or refined.
    """

    root: Path = Path()
    splits: Path | None = None
    split: Split = Split.TRAIN
    depth: SunDepth = SunDepth.RAW

    def load(self) -> StoredPairs:
        """Return the pairs, by folder.

        Raises:
            InputError: A folder or a file is missing, or an image lacks its depth or its camera.
        """
        places = self._places()
        images = named(self.root, r"(.+)/image/[^/]+\.jpg", "PLACE/image/NAME.jpg")
        depths = named(self.root, rf"(.+)/{self.depth}/[^/]+\.png", f"PLACE/{self.depth}/NAME.png")
        rule = f"PLACE/image/NAME.jpg needs a PLACE/{self.depth}/NAME.png"
        pairs = partners(images, depths, rule)
        missing = sorted(places - images.keys()) if places is not None else []
        if missing:
            raise InputError(
                f"{self.root / missing[0]}: is in allsplit.mat, but there is no such folder"
            )
        return StoredPairs(
            tuple(
                StoredPair(
                    key.replace("/", "_"), image, TurnedCodes(depth), _camera(image.parents[1])
                )
                for key, image, depth in pairs
                if places is None or key in places
            )
        )

    def _places(self) -> set[str] | None:
        if self.splits is None:
            return None
        folder = existing(
            self.root / self.splits, "allsplit.mat of SUNRGBDtoolbox/traintestSUNRGBD"
        )
        path, field = folder / "allsplit.mat", _FIELDS[self.split]
        with reading(path, "the splits of SUN RGB-D (MATLAB)", _ERRORS):
            listed = [str(each[0]) for each in np.ravel(loadmat(path, appendmat=False)[field])]
        wrong = [each for each in listed if _ANCHOR not in each]
        if wrong or not listed:
            raise InputError(
                f"{path}: {field} should list folders below {_ANCHOR}, got {wrong[:1]}"
            )
        return {each.partition(_ANCHOR)[2].rstrip("/") for each in listed}


def _camera(place: Path) -> Intrinsics:
    matrix = numbers_of(place / "intrinsics.txt", 9, "a camera of 3 x 3")
    return opencv_camera((matrix[0], matrix[4]), (matrix[2], matrix[5]))
