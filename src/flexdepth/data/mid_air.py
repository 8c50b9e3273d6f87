"""Mid-Air: rendered flights of a drone in several climates, as published.

    ROOT/color_left/trajectory_0000/000000.JPEG         1024 x 1024, 90 degrees across
    ROOT/depth/trajectory_0000/000000.PNG               16 bits that are a half float; metres

ROOT is one environment in one climate, such as `Kite_training/sunny`. The set calls its numbers
depth; they are taken for the Euclidean distance to the camera, which is divided out here (this
could not be checked against the set's documentation, therefore `meaning`). Infinite ones are sky.
The principal point is the middle of the image.

References:
    Fonder and Van Droogenbroeck, CVPR workshops 2019; `midair-dataset` for the half floats.
"""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.stored import StoredPair, StoredPairs, named, partners, planar
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.formats import png16

CAMERA = Intrinsics.centred(1024, 1024, 512.0, FocalSource.GIVEN)

_SIZE = (1024, 1024)


class MidAirDepth(StrEnum):
    """What the numbers of the files mean."""

    DISTANCE = "distance"
    """The distance along each ray."""
    DEPTH = "depth"
    """z, for those who find that it is."""


@dataclass(frozen=True)
class HalfFloats:
    """Half floats in a 16-bit PNG.

    Attributes:
        path: The file.
        meaning: What they are.
    """

    path: Path
    meaning: MidAirDepth

    def values(self) -> NDArray[np.float32]:
        """Return z in metres."""
        stored = png16.numbers(self.path).view(np.float16).astype(np.float32)
        metres = np.where(stored > 0, stored, np.float32(np.nan))
        return planar(metres, CAMERA) if self.meaning is MidAirDepth.DISTANCE else metres


@dataclass(frozen=True)
class MidAir:
    """The left colour images of one environment and climate.

    Attributes:
        root: Its folder.
        meaning: What its depth files hold.
    """

    root: Path = Path()
    meaning: MidAirDepth = MidAirDepth.DISTANCE

    def load(self) -> StoredPairs:
        """Return the pairs, by trajectory and frame.

        Raises:
            InputError: A folder is missing, or a frame has no partner.
        """
        stem, holds = r"(trajectory_\d{4})/(\d{6})", "trajectory_NNNN/NNNNNN"
        images = named(self.root / "color_left", rf"{stem}\.JPEG", f"{holds}.JPEG")
        depths = named(self.root / "depth", rf"{stem}\.PNG", f"{holds}.PNG")
        rule = f"color_left/{holds}.JPEG needs a depth/{holds}.PNG"
        return StoredPairs(
            tuple(
                StoredPair(
                    key.replace("/", "_"), image, HalfFloats(depth, self.meaning), CAMERA, _SIZE
                )
                for key, image, depth in partners(images, depths, rule)
            )
        )
