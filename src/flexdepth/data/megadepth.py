"""MegaDepth: photos of landmarks with depth from structure from motion, as published (v1).

    ROOT/0000/dense0/imgs/NAME.jpg
    ROOT/0000/dense0/depths/NAME.h5             `depth`; 0 is unknown

Depth is right up to one factor for each photo, whose camera is not part of the set. Some maps
hold no depth but an order, which is what their negative numbers are: regions that are surely
nearer and surely farther. Which number is which is not stated where this could be checked: -1 is
taken for the nearer region and -2 for the farther.

References:
    Li and Snavely, CVPR 2018.
"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.hdf5_files import array_of
from flexdepth.data.stored import StoredPair, StoredPairs, known, named, partners
from flexdepth.data.views import Listed, OrdinalRegions
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import read_photo

_STEM = r"(\d{4}/dense\d+)"
_HOLDS = "NNNN/denseN"


@dataclass(frozen=True)
class SfmDepth:
    """Depth up to a factor in an .h5 file.

    Attributes:
        path: The file.
    """

    path: Path

    def values(self) -> NDArray[np.float32]:
        """Return the numbers of the file; the negative ones of an order are unknown."""
        return known(_stored(self.path))


@dataclass(frozen=True)
class MegaDepth:
    """Photos with depth up to a factor; those of a mere order have none.

    Attributes:
        root: The folder that holds a folder of four digits for each landmark.
    """

    root: Path = Path()

    def load(self) -> StoredPairs:
        """Return the pairs, by landmark and name.

        Raises:
            InputError: The folder holds no photos, or a photo has no depth file.
        """
        return StoredPairs(
            tuple(
                StoredPair(key.replace("/", "_"), image, SfmDepth(depth), None, space=Space.SCALE)
                for key, image, depth in _pairs(self.root)
            )
        )


@dataclass(frozen=True)
class MegaDepthOrdinal:
    """Photos with regions that are nearer and farther; those with depth have empty ones.

    Attributes:
        root: As for `MegaDepth`.
        nearer: The number of the nearer region.
        farther: The number of the farther one.
    """

    root: Path = Path()
    nearer: float = -1.0
    farther: float = -2.0

    def load(self) -> Listed[OrdinalRegions]:
        """Return the photos, by landmark and name.

        Raises:
            InputError: The folder holds no photos, or a photo has no depth file.
        """
        return Listed(
            tuple(
                partial(regions, key.replace("/", "_"), image, depth, self.nearer, self.farther)
                for key, image, depth in _pairs(self.root)
            )
        )


def regions(name: str, image: Path, path: Path, nearer: float, farther: float) -> OrdinalRegions:
    """Return a photo and its regions.

    Raises:
        InputError: A file is damaged, or the two differ in size.
    """
    pixels, stored = read_photo(image).pixels, _stored(path)
    if stored.shape != pixels.shape[:2]:
        raise InputError(
            f"{path}: holds {stored.shape[1]}x{stored.shape[0]} values, its image {image} has "
            f"{pixels.shape[1]}x{pixels.shape[0]} pixels; take the files as they are published"
        )
    return OrdinalRegions(name, pixels, stored == nearer, stored == farther)


def _stored(path: Path) -> NDArray[np.float32]:
    return array_of(path, "depth", "a depth map of MegaDepth (HDF5)")


def _pairs(root: Path) -> tuple[tuple[str, Path, Path], ...]:
    images = named(root, rf"{_STEM}/imgs/([^/]+)\.(?:jpg|JPG|png)", f"{_HOLDS}/imgs/NAME.jpg")
    depths = named(root, rf"{_STEM}/depths/([^/]+)\.h5", f"{_HOLDS}/depths/NAME.h5")
    return partners(images, depths, "imgs/NAME.jpg needs a depths/NAME.h5")
