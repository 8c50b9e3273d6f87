"""ScanNet, exported from its .sens files with the set's own `SensReader`.

    ROOT/color/0.jpg                            1296 x 968
    ROOT/depth/0.png                            640 x 480, 16 bits, millimetres, 0 is unknown
    ROOT/pose/0.txt                             world from camera, 4 x 4; -inf where tracking failed
    ROOT/intrinsic/intrinsic_depth.txt          4 x 4

ROOT is one scan, such as `scene0707_00`. As in all published protocols the colour image is brought
to the size of the depth, whose camera is then taken for both. The two cameras see not quite the
same: by the set's own calibrations a thing in depth lies up to about 4 rows beside its colour.

References:
    Dai et al., ScanNet, CVPR 2017, and `SensReader/python`.
"""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from flexdepth.data.folder import Pair
from flexdepth.data.read import check_size, opencv_camera
from flexdepth.data.stored import Codes, named, partners
from flexdepth.data.text_files import numbers_of
from flexdepth.data.trajectory import Pose, matrix
from flexdepth.data.views import Listed
from flexdepth.runtime.depthmap import DepthMap, Intrinsics, Space
from flexdepth.runtime.images import read_photo

_COLOUR, _DEPTH = (1296, 968), (640, 480)


@dataclass(frozen=True)
class ScanNetPair:
    """A frame of a scan on disk; called, it reads the pair.

    Attributes:
        name: Scan and number.
        image: The picture.
        depth: Its depth.
        camera: That of depth.
    """

    name: str
    image: Path
    depth: Path
    camera: Intrinsics

    def __call__(self) -> Pair:
        """Return the pair at the size of depth.

        Raises:
            InputError: A file is damaged, or of another size than it is published in.
        """
        image, metres = read_photo(self.image).pixels, Codes(self.depth, 1000.0).values()
        check_size(self.image, (image.shape[1], image.shape[0]), _COLOUR)
        check_size(self.depth, (metres.shape[1], metres.shape[0]), _DEPTH)
        shrunk = np.asarray(cv2.resize(image, _DEPTH, interpolation=cv2.INTER_AREA), np.uint8)
        return Pair(self.name, shrunk, DepthMap(metres, Space.METRIC, self.camera))


@dataclass(frozen=True)
class ScanNet:
    """The exported frames of one scan.

    Attributes:
        root: Its folder.
    """

    root: Path = Path()

    def load(self) -> Listed[Pair]:
        """Return the pairs, by number.

        Raises:
            InputError: A folder or the calibration is missing, or a frame has no partner.
        """
        what = "the camera of depth"
        calibration = self.root / "intrinsic" / "intrinsic_depth.txt"
        numbers = numbers_of(calibration, 16, what)
        camera = opencv_camera((numbers[0], numbers[5]), (numbers[2], numbers[6]))
        images = named(self.root / "color", r"(\d+)\.jpg", "N.jpg")
        depths = named(self.root / "depth", r"(\d+)\.png", "N.png")
        pairs = partners(images, depths, "color/N.jpg needs a depth/N.png")
        scan = self.root.resolve().name
        return Listed(
            tuple(
                ScanNetPair(f"{scan}_{int(key):06d}", image, depth, camera)
                for key, image, depth in sorted(pairs, key=lambda pair: int(pair[0]))
            )
        )

    def poses(self) -> tuple[Pose | None, ...]:
        """Return `world_from_camera` of each pair; None where tracking failed."""
        paths = named(self.root / "pose", r"(\d+)\.txt", "N.txt")
        found = (matrix(paths[key]) for key in sorted(paths, key=int))
        return tuple(pose if np.isfinite(pose).all() else None for pose in found)
