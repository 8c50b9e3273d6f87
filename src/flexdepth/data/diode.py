"""DIODE: indoor and outdoor laser scans, as published.

    ROOT/val/indoors/scene_00019/scan_00183/00019_00183_indoors_000_010.png         1024 x 768
    ROOT/val/indoors/scene_00019/scan_00183/00019_00183_indoors_000_010_depth.npy   768 x 1024 x 1
    ROOT/val/indoors/scene_00019/scan_00183/00019_00183_indoors_000_010_depth_mask.npy

Depth is in metres, and known where the mask is 1. Neither the paper nor the development kit says
whether it is z or the distance along the ray; it is taken for z, as all published figures do. The
camera is that of the kit's `intrinsics.txt`, whose focal lengths do differ. Its principal point is
the middle of the image: 512, 384 where the corner counts as 0, as here.

References:
    Vasiljevic et al., DIODE, arXiv 1908.00463, and `diode-devkit`.
"""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.stored import StoredPair, StoredPairs, existing, known, named, partners
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats.reading import reading

CAMERA = Intrinsics(886.81, 927.06, 512.0, 384.0, FocalSource.GIVEN)

_SIZE = (1024, 768)
_STEM = r"((?:indoors|outdoor)/scene_\d{5}/scan_\d{5}/[^/]+?)"
_HOLDS = "indoors/scene_NNNNN/scan_NNNNN/NAME"


class DiodeSplit(StrEnum):
    """A published part of the set; the test images are not public."""

    TRAIN = "train"
    VAL = "val"


class DiodePlace(StrEnum):
    """Where it was taken."""

    INDOORS = "indoors"
    OUTDOOR = "outdoor"


@dataclass(frozen=True)
class MaskedMetres:
    """Depth and its mask in two .npy files.

    Attributes:
        path: Depth.
        mask: 1 where it is measured.
    """

    path: Path
    mask: Path

    def values(self) -> NDArray[np.float32]:
        """Return metres."""
        depth, mask = _numbers(self.path), _numbers(self.mask)
        if depth.shape != mask.shape:
            raise InputError(
                f"{self.mask}: is of shape {mask.shape}, its depth of {depth.shape}; "
                "take the files as they are published"
            )
        return np.where(mask > 0, known(depth), np.float32(np.nan))


@dataclass(frozen=True)
class Diode:
    """Images with laser depth.

    Attributes:
        root: The folder that holds `train` and `val`.
        split: Which of the two.
        place: Indoors or outdoor; None takes both.
    """

    root: Path = Path()
    split: DiodeSplit = DiodeSplit.VAL
    place: DiodePlace | None = None

    def load(self) -> StoredPairs:
        """Return the pairs, by place, scene and scan.

        Raises:
            InputError: A folder is missing, or an image lacks its depth or its mask.
        """
        folder = existing(self.root / self.split, f"{_HOLDS}.png")
        images = named(folder, rf"{_STEM}\.png", f"{_HOLDS}.png")
        depths = named(folder, rf"{_STEM}_depth\.npy", f"{_HOLDS}_depth.npy")
        masks = named(folder, rf"{_STEM}_depth_mask\.npy", f"{_HOLDS}_depth_mask.npy")
        partners(images, masks, "NAME.png needs a NAME_depth_mask.npy")
        pairs = partners(images, depths, "NAME.png needs a NAME_depth.npy")
        chosen = [pair for pair in pairs if self.place in (None, pair[0].split("/")[0])]
        if not chosen:
            raise InputError(f"{folder / str(self.place)}: holds no {_HOLDS}.png")
        return StoredPairs(
            tuple(
                StoredPair(image.stem, image, MaskedMetres(depth, masks[key]), CAMERA, _SIZE)
                for key, image, depth in chosen
            )
        )


def _numbers(path: Path) -> NDArray[np.float32]:
    with reading(path, "a map of numbers (.npy)", (ValueError, TypeError, EOFError, SyntaxError)):
        values = np.load(path, allow_pickle=False)
        if values.dtype.kind not in "fiub" or values.squeeze().ndim != 2:
            raise ValueError(f"a map is wanted, it holds {values.dtype} of shape {values.shape}")
    return np.asarray(values.squeeze(), np.float32)
