"""DrivingStereo: streets with depth from laser scans, as published.

    ROOT/train-left-image/2018-07-09-16-11-56/NAME.jpg      881 x 400 (1762 x 800 at full size)
    ROOT/train-depth-map/2018-07-09-16-11-56/NAME.png       16 bits, 1/256 m, 0 is unknown
    ROOT/half-image-calib/2018-07-09.txt                    P_rect_101, S_rect_101, as KITTI's

The folders' names differ between the archives (train, test, weathers, half and full size); they can
be given. Principal points count the first pixel's centre as 0.

References:
    Yang et al., CVPR 2019, and the set's own page.
"""

from dataclasses import dataclass
from pathlib import Path

from flexdepth.data.kitti import calibrated_camera
from flexdepth.data.stored import Codes, StoredPair, StoredPairs, named, partners
from flexdepth.runtime.depthmap import Intrinsics

_DATE = len("2018-07-09")
_LEFT = "101"


@dataclass(frozen=True)
class DrivingStereo:
    """The left images of all drives in a folder.

    Attributes:
        root: Where the other paths start, unless they are absolute.
        images: The folder that holds a folder of images for each drive.
        depths: The folder that holds a folder of depth maps for each drive.
        calibrations: The folder that holds a file for each date, for images of this size.
    """

    root: Path = Path()
    images: Path = Path("train-left-image")
    depths: Path = Path("train-depth-map")
    calibrations: Path = Path("half-image-calib")

    def load(self) -> StoredPairs:
        """Return the pairs, by drive and name.

        Raises:
            InputError: A folder or the calibration of a date is missing, or a frame has no partner.
        """
        stem, holds = r"(\d{4}-\d\d-\d\d-\d\d-\d\d-\d\d)/([^/]+)", "YYYY-MM-DD-HH-MM-SS/NAME"
        images = named(self.root / self.images, rf"{stem}\.(?:jpg|png)", f"{holds}.jpg")
        depths = named(self.root / self.depths, rf"{stem}\.png", f"{holds}.png")
        cameras: dict[str, tuple[Intrinsics, tuple[int, int]]] = {}
        files = []
        rule = f"{self.images}/{holds}.jpg needs a {self.depths}/{holds}.png"
        for key, image, depth in partners(images, depths, rule):
            date = key[:_DATE]
            if date not in cameras:
                path = self.root / self.calibrations / f"{date}.txt"
                cameras[date] = calibrated_camera(path, _LEFT)
            name = key.replace("/", "_")
            files.append(StoredPair(name, image, Codes(depth, 256.0), *cameras[date]))
        return StoredPairs(tuple(files))
