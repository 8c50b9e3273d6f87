"""KITTI 2015 (scene flow): disparity and optical flow with moving cars, as published.

    ROOT/training/image_2/000000_10.png         left, the moment of the truth; _11 the next
    ROOT/training/disp_occ_0/000000_10.png      16 bits, pixels x 256, 0 is unknown; disp_noc_0
    ROOT/training/flow_occ/000000_10.png        16 bits; flow_noc without what is hidden
    ROOT/training/calib_cam_to_cam/000000.txt   P_rect_02, P_rect_03, S_rect_02

A flow PNG has u = (red - 2^15) / 64, v = (green - 2^15) / 64, and blue > 0 where it is known.

References:
    Menze and Geiger, CVPR 2015, and the set's development kit.
"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL.PngImagePlugin import PngImageFile

from flexdepth.data.kitti import calibrated_camera
from flexdepth.data.kitti_velodyne import field_matrix
from flexdepth.data.stored import StoredPair, StoredPairs, depth_from_disparity, named, partners
from flexdepth.data.views import FlowPair, Listed
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats import png16
from flexdepth.runtime.formats.reading import check_size, reading
from flexdepth.runtime.images import read_photo

_ERRORS = (ValueError, SyntaxError, TypeError, KeyError, IndexError, EOFError, cv2.error)
_FIRST, _NEXT = r"(\d{6})_10\.png", r"(\d{6})_11\.png"
_CALIBRATION = "calib_cam_to_cam/NNNNNN.txt"


@dataclass(frozen=True)
class KittiDisparity:
    """Disparity in a 16-bit PNG.

    Attributes:
        path: The file.
        focal_times_baseline: In pixels times metres.
    """

    path: Path
    focal_times_baseline: float

    def values(self) -> NDArray[np.float32]:
        """Return metres."""
        pixels = png16.numbers(self.path).astype(np.float32) / np.float32(256)
        return depth_from_disparity(pixels, self.focal_times_baseline)


@dataclass(frozen=True)
class Kitti2015Stereo:
    """The left images with depth from the truth of the stereo benchmark, hidden pixels included.

    Attributes:
        root: The folder that holds `training`.
    """

    root: Path = Path()

    def load(self) -> StoredPairs:
        """Return the pairs, by number.

        Raises:
            InputError: A folder is missing, or a frame lacks its disparity or its calibration.
        """
        training = self.root / "training"
        images = named(training / "image_2", _FIRST, "NNNNNN_10.png")
        disparities = named(training / "disp_occ_0", _FIRST, "NNNNNN_10.png")
        calibrations = named(training, r"calib_cam_to_cam/(\d{6})\.txt", _CALIBRATION)
        partners(images, calibrations, f"image_2/NNNNNN_10.png needs a {_CALIBRATION}")
        rule = "image_2/NNNNNN_10.png needs a disp_occ_0/NNNNNN_10.png"
        files = []
        for key, image, disparity in partners(images, disparities, rule):
            camera, size = calibrated_camera(calibrations[key], "02")
            truth = KittiDisparity(disparity, _focal_times_baseline(calibrations[key]))
            files.append(StoredPair(key, image, truth, camera, size))
        return StoredPairs(tuple(files))


@dataclass(frozen=True)
class Kitti2015Flow:
    """Pairs of successive images with sparse optical flow.

    Attributes:
        root: The folder that holds `training`.
    """

    root: Path = Path()

    def load(self) -> Listed[FlowPair]:
        """Return the pairs, by number.

        Raises:
            InputError: A folder is missing, or a flow lacks one of its images or its counterpart
                without hidden pixels.
        """
        training = self.root / "training"
        key, target = (
            named(training / "image_2", pattern, holds)
            for pattern, holds in ((_FIRST, "NNNNNN_10.png"), (_NEXT, "NNNNNN_11.png"))
        )
        partners(key, target, "image_2/NNNNNN_10.png needs an image_2/NNNNNN_11.png")
        every, visible = (
            named(training / name, _FIRST, "NNNNNN_10.png") for name in ("flow_occ", "flow_noc")
        )
        partners(every, visible, "flow_occ/NNNNNN_10.png needs a flow_noc/NNNNNN_10.png")
        rule = "flow_occ/NNNNNN_10.png needs an image_2/NNNNNN_10.png"
        return Listed(
            tuple(
                partial(flow_pair, number, key[number], target[number], flow, visible[number])
                for number, flow, _ in partners(every, key, rule)
            )
        )


def read_flow(path: Path) -> NDArray[np.float32]:
    """Return a flow PNG of KITTI: height x width x 2, right and down in pixels; NaN is unknown.

    Raises:
        InputError: The file is missing, damaged or of another kind.
    """
    with reading(path, "a flow PNG of KITTI", _ERRORS):
        with PngImageFile(path) as picture:
            check_size(*picture.size)
            picture.verify()
        # Pillow gives but 8 of the 16 bits of a colour PNG.
        stored = cv2.imdecode(np.fromfile(path, np.uint8), cv2.IMREAD_UNCHANGED)
        if stored is None or stored.dtype != np.uint16 or stored.ndim != 3 or stored.shape[2] != 3:
            raise ValueError("three channels of 16 bits are wanted")
    known, v, u = (stored[..., channel].astype(np.float32) for channel in range(3))
    flow = (np.stack([u, v], axis=-1) - np.float32(1 << 15)) / np.float32(64)
    flow[known == 0] = np.nan
    return flow


def flow_pair(name: str, key: Path, target: Path, every: Path, visible: Path) -> FlowPair:
    """Return what the four files hold; hidden is what only the third of them knows.

    The two images of one moment may differ by a pixel in size between drives, never within one.

    Raises:
        InputError: One is damaged, or of another size than the first image.
    """
    images = read_photo(key).pixels, read_photo(target).pixels
    flow, seen = read_flow(every), read_flow(visible)
    for path, shape in ((target, images[1].shape), (every, flow.shape), (visible, seen.shape)):
        if shape[:2] != images[0].shape[:2]:
            raise InputError(
                f"{path}: is {shape[1]}x{shape[0]}, its image {key} "
                f"{images[0].shape[1]}x{images[0].shape[0]}; take the files as they are published"
            )
    hidden: NDArray[np.bool_] = np.isnan(seen[..., 0]) & ~np.isnan(flow[..., 0])
    return FlowPair(name, *images, flow, hidden)


def _focal_times_baseline(path: Path) -> float:
    """Return how far apart the two colour cameras are, in pixels times metres."""
    left, right = (field_matrix(path, f"P_rect_{side}", (3, 4)) for side in ("02", "03"))
    product = float(left[0, 3] - right[0, 3])
    if not product > 0:
        raise InputError(f"{path}: wanted camera 03 on the right of camera 02, got {product} px m")
    return product
