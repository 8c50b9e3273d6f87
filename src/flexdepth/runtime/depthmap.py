"""A depth map that knows what its numbers mean.

Pixel convention of the project: pixel centres lie at half integers and the origin is the image's
top left corner, so a principal point in the middle of a 640-pixel row is 320. Files use OpenCV's
convention (the first pixel's centre is 0, the middle is 319.5); `files.py` converts.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import hypot, isfinite, radians, sqrt, tan

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError


class Space(StrEnum):
    """What a depth map is ambiguous up to."""

    METRIC = "metric"
    """Metres."""
    SCALE = "scale"
    """True depth times one unknown positive factor."""
    AFFINE_DEPTH = "affine_depth"
    """True depth up to an unknown factor and an unknown offset."""
    AFFINE_DISPARITY = "affine_disparity"
    """Inverse depth up to an unknown factor and an unknown offset: larger is nearer."""


class FocalSource(StrEnum):
    """How the focal length came to be known."""

    EXIF = "exif"
    GIVEN = "given"
    PREDICTED = "predicted"
    """A network sees it in the picture."""
    ASSUMED = "assumed"

    @property
    def is_known(self) -> bool:
        """Whether somebody who knows has said it."""
        return self in (FocalSource.EXIF, FocalSource.GIVEN)


@dataclass(frozen=True)
class Intrinsics:
    """A pinhole camera, in pixels of the image it belongs to (corner origin)."""

    focal_x: float
    focal_y: float
    centre_x: float
    centre_y: float
    source: FocalSource

    def __post_init__(self) -> None:
        """Refuse a camera that cannot project."""
        values = (self.focal_x, self.focal_y, self.centre_x, self.centre_y)
        if not all(map(isfinite, values)) or min(self.focal_x, self.focal_y) <= 0:
            raise InputError(f"a camera needs finite numbers and a focal length > 0, got {values}")

    @classmethod
    def centred(cls, width: int, height: int, focal: float, source: FocalSource) -> "Intrinsics":
        """Return the camera with square pixels that looks through the middle of the image."""
        return cls(focal, focal, width / 2, height / 2, source)

    @classmethod
    def from_field_of_view(
        cls, width: int, height: int, degrees: float, source: FocalSource
    ) -> "Intrinsics":
        """Return the centred camera that sees `degrees` from the left edge to the right edge."""
        if not 0 < degrees < 180:
            raise InputError(f"a field of view lies between 0 and 180 degrees, got {degrees:g}")
        return cls.centred(width, height, width / 2 / tan(radians(degrees) / 2), source)

    def scaled(self, x: float, y: float) -> "Intrinsics":
        """Return the camera of the same image resized by `x` across and `y` down."""
        return Intrinsics(
            self.focal_x * x, self.focal_y * y, self.centre_x * x, self.centre_y * y, self.source
        )

    def focal_in_diagonals(self, width: int, height: int) -> float:
        """Return the focal length divided by the image's diagonal: 0.6 for a typical phone."""
        return sqrt(self.focal_x * self.focal_y) / hypot(width, height)

    def focal_by_area(self, width: int, height: int) -> float:
        """Return the focal length divided by the diagonal of a 4:3 image of the same area."""
        return sqrt(self.focal_x * self.focal_y) / diagonal_by_area(width, height)


def diagonal_by_area(width: int, height: int) -> float:
    """Return the diagonal of a 4:3 image of the same area as one of `width` by `height`."""
    return 5 * sqrt(width * height / 12)


@dataclass(frozen=True, eq=False)
class DepthMap:
    """The depth of one image, at that image's size.

    Attributes:
        values: Height by width, float32. Depth is z in front of the camera, larger is farther,
            +inf is sky; in the space `affine_disparity` larger is nearer and -inf is sky. NaN is
            unknown.
        space: What the numbers are ambiguous up to.
        intrinsics: The camera, or None where nothing is known of it.
        model: Who made the numbers, such as "compact 0.1".
        spread: Height by width, float32: the relative standard deviation of each value, the one
            factor of the whole map left out. NaN is unknown; None where nothing is known of it.
        scale_spread: The relative standard deviation of the one factor of the whole map; None
            where it is not known, or open anyhow.
    """

    values: NDArray[np.float32]
    space: Space
    intrinsics: Intrinsics | None = None
    model: str = ""
    spread: NDArray[np.float32] | None = None
    scale_spread: float | None = None

    def __post_init__(self) -> None:
        """Refuse what is not a map of numbers, and a spread that is not of it."""
        spread = self.spread
        if spread is not None and (spread.shape != self.values.shape or spread.dtype != np.float32):
            raise InputError(
                f"a spread is a float32 array of the map's shape {self.values.shape}, got "
                f"{spread.shape} of {spread.dtype}"
            )
        if self.values.ndim != 2 or self.values.dtype != np.float32 or not self.values.size:
            raise InputError(
                f"a depth map is a non-empty height x width array of float32, "
                f"got shape {self.values.shape} of {self.values.dtype}"
            )

    @property
    def depth(self) -> NDArray[np.float32]:
        """Depth, larger is farther. Refused for disparity, which has no depth without a fit."""
        if self.space is Space.AFFINE_DISPARITY:
            raise InputError(
                "this map holds affine disparity: it has neither depth, points nor metres "
                "until it is fitted to measured depth"
            )
        return self.values

    @property
    def disparity(self) -> NDArray[np.float32]:
        """Affine disparity, larger is nearer. Refused for depth."""
        if self.space is not Space.AFFINE_DISPARITY:
            raise InputError(f"this map holds depth ({self.space}), not disparity")
        return self.values

    @property
    def unit(self) -> str:
        """`m` for metric depth, else `relative`."""
        return "m" if self.space is Space.METRIC else "relative"

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Where the map holds a finite number."""
        return np.isfinite(self.values)

    @property
    def sky(self) -> NDArray[np.bool_]:
        """Where the map holds sky."""
        return np.isinf(self.values)
