"""Cityscapes: streets with disparity from semi-global matching, as published.

    ROOT/leftImg8bit/train/aachen/aachen_000000_000019_leftImg8bit.png      2048 x 1024
    ROOT/disparity/train/aachen/aachen_000000_000019_disparity.png          16 bits
    ROOT/camera/train/aachen/aachen_000000_000019_camera.json               fx fy u0 v0, baseline

A code p > 0 is a disparity of (p - 1) / 256 pixels; 0 is unknown, and so is a disparity of 0,
which would lie infinitely far. It is an estimate, not a measurement. The lower part of the images
shows the car itself. Principal points count the first pixel's centre as 0.

References:
    Cordts et al., CVPR 2016; `cityscapesScripts`, its README on disparity.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.read import opencv_camera
from flexdepth.data.stored import StoredPair, StoredPairs, depth_from_disparity, named, partners
from flexdepth.data.text_files import record_of
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats import png16

_SIZE = (2048, 1024)
_STEM = r"([^/]+/[^/]+_\d{6}_\d{6})"
_HOLDS = "CITY/CITY_NNNNNN_NNNNNN"


class CityscapesSplit(StrEnum):
    """A published part of the set."""

    TRAIN = "train"
    VAL = "val"
    TEST = "test"
    TRAIN_EXTRA = "train_extra"


@dataclass(frozen=True)
class CityscapesDisparity:
    """Disparity in a 16-bit PNG.

    Attributes:
        path: The file.
        focal_times_baseline: In pixels times metres.
    """

    path: Path
    focal_times_baseline: float

    def values(self) -> NDArray[np.float32]:
        """Return metres."""
        pixels = (png16.numbers(self.path).astype(np.float32) - 1) / np.float32(256)
        return depth_from_disparity(pixels, self.focal_times_baseline)


@dataclass(frozen=True)
class Cityscapes:
    """Left images with depth from disparity.

    Attributes:
        root: The folder that holds `leftImg8bit`, `disparity` and `camera`.
        split: Which part.
    """

    root: Path = Path()
    split: CityscapesSplit = CityscapesSplit.TRAIN

    def load(self) -> StoredPairs:
        """Return the pairs, by city and frame.

        Raises:
            InputError: A folder is missing, or a frame lacks its disparity or its camera.
        """
        images, disparities, cameras = (
            named(self.root / kind / self.split, rf"{_STEM}_{end}", f"{_HOLDS}_{kind}")
            for kind, end in (
                ("leftImg8bit", r"leftImg8bit\.png"),
                ("disparity", r"disparity\.png"),
                ("camera", r"camera\.json"),
            )
        )
        partners(images, cameras, f"{_HOLDS}_leftImg8bit.png needs a _camera.json")
        files = []
        rule = f"{_HOLDS}_leftImg8bit.png needs a _disparity.png"
        for key, image, disparity in partners(images, disparities, rule):
            camera, baseline = read_camera(cameras[key])
            truth = CityscapesDisparity(disparity, camera.focal_x * baseline)
            files.append(StoredPair(key.split("/")[1], image, truth, camera, _SIZE))
        return StoredPairs(tuple(files))


def read_camera(path: Path) -> tuple[Intrinsics, float]:
    """Return the camera in a `_camera.json`, and how far the right one is from it, in metres.

    Raises:
        InputError: The file is missing, or lacks a number.
    """
    record = record_of(path, "a camera of Cityscapes")
    inside, outside = record.get("intrinsic"), record.get("extrinsic")
    try:
        if not isinstance(inside, Mapping) or not isinstance(outside, Mapping):
            raise TypeError("intrinsic and extrinsic")
        focal_x, focal_y, centre_x, centre_y = (
            float(inside[key]) for key in ("fx", "fy", "u0", "v0")
        )
        baseline = float(outside["baseline"])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{path}: wanted intrinsic fx, fy, u0, v0 and extrinsic baseline ({error})"
        ) from error
    if not baseline > 0:
        raise InputError(f"{path}: wanted a baseline > 0, got {baseline:g}")
    return opencv_camera((focal_x, focal_y), (centre_x, centre_y)), baseline
