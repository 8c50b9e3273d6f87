"""Make3D: outdoor photos with a coarse laser grid, as published.

    ROOT/Train400Img/img-10.21op2-p-015t000.jpg                     2272 rows of 1704 pixels
    ROOT/Train400Depth/depth_sph_corr-10.21op2-p-015t000.mat        Position3DGrid, 55 x 305 x 4
    ROOT/Test134/img-op1-p-015t000.jpg
    ROOT/Gridlaserdata/depth_sph_corr-op1-p-015t000.mat

The grid covers the whole photo: each of its cells becomes a block of pixels. Its layers are Y, X,
the depth Z and the distance along the ray, in metres. No camera is published.

References:
    Saxena, Sun and Ng, Make3D, PAMI 2009, and the set's own page.
"""

import zlib
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat
from scipy.io.matlab import MatReadError

from flexdepth.data.read import Split
from flexdepth.data.stored import StoredPair, StoredPairs, known, named, partners, picture_size
from flexdepth.runtime.formats.reading import reading

_FOLDERS = {Split.TRAIN: ("Train400Img", "Train400Depth"), Split.TEST: ("Test134", "Gridlaserdata")}
_LAYERS = 4
_ERRORS = (MatReadError, ValueError, TypeError, LookupError, ArithmeticError, zlib.error)


class Make3dLayer(IntEnum):
    """Which layer of the grid, counted from 0."""

    DEPTH = 2
    """z; some published files hold zeros there, which are unknown."""
    DISTANCE = 3
    """Along the ray. All published figures are measured against it, as if it were z."""


@dataclass(frozen=True)
class LaserGrid:
    """A grid of laser points over a photo.

    Attributes:
        path: The .mat file.
        image: The photo, for its size.
        layer: Which layer.
    """

    path: Path
    image: Path
    layer: Make3dLayer

    def values(self) -> NDArray[np.float32]:
        """Return metres at the photo's size."""
        with reading(self.path, "a laser grid of Make3D (MATLAB)", _ERRORS):
            grid = loadmat(self.path, appendmat=False)["Position3DGrid"]
            if grid.ndim != 3 or grid.shape[2] != _LAYERS:
                raise ValueError(f"Position3DGrid of 55 x 305 x 4 is wanted, it is {grid.shape}")
            metres = known(grid[..., self.layer])
        size = picture_size(self.image)
        return np.asarray(cv2.resize(metres, size, interpolation=cv2.INTER_NEAREST_EXACT))


@dataclass(frozen=True)
class Make3d:
    """Photos with their grids: 400 to train, 134 to test.

    Attributes:
        root: The folder that holds the unpacked archives.
        split: Which of the two.
        layer: What counts as depth.
    """

    root: Path = Path()
    split: Split = Split.TRAIN
    layer: Make3dLayer = Make3dLayer.DISTANCE

    def load(self) -> StoredPairs:
        """Return the pairs, by name.

        Raises:
            InputError: A folder is missing, or a photo has no grid.
        """
        photos, grids = _FOLDERS[self.split]
        images = named(self.root / photos, r"img-(.+)\.jpg", "img-NAME.jpg")
        depths = named(self.root / grids, r"depth_sph_corr-(.+)\.mat", "depth_sph_corr-NAME.mat")
        rule = f"{photos}/img-NAME.jpg needs a {grids}/depth_sph_corr-NAME.mat"
        return StoredPairs(
            tuple(
                StoredPair(key, image, LaserGrid(depth, image, self.layer), None)
                for key, image, depth in partners(images, depths, rule)
            )
        )
