"""Which part of an image a protocol looks at: rows and columns, counted from the top left.

A region is a value with `box(height, width)`. Fractions are cut to whole pixels as `int` does it,
downwards, which is what the published code does.
"""

from dataclasses import dataclass
from typing import NamedTuple

from flexdepth.runtime.errors import InputError

KITTI_CROP = (352, 1216)
"""Height and width of KITTI's benchmark crop."""


class Box(NamedTuple):
    """Rows `top` to `bottom` and columns `left` to `right`, the last ones not included."""

    top: int
    bottom: int
    left: int
    right: int

    @property
    def size(self) -> tuple[int, int]:
        """Height and width."""
        return self.bottom - self.top, self.right - self.left

    @property
    def slices(self) -> tuple[slice, slice]:
        """What cuts the box out of an array."""
        return slice(self.top, self.bottom), slice(self.left, self.right)


@dataclass(frozen=True)
class Everything:
    """The whole image."""

    def __str__(self) -> str:
        """Return it in words."""
        return "whole image"

    @property
    def label(self) -> str:
        """For the names of folders."""
        return "whole"

    def box(self, height: int, width: int) -> Box:
        """Return the rows and columns."""
        return Box(0, height, 0, width)


WHOLE = Everything()


@dataclass(frozen=True)
class Fixed:
    """Given rows and columns of images of one size."""

    top: int
    bottom: int
    left: int
    right: int
    height: int
    width: int

    def __str__(self) -> str:
        """Return it in words."""
        rows, columns = f"{self.top}:{self.bottom}", f"{self.left}:{self.right}"
        return f"rows {rows}, columns {columns} of {self.width}x{self.height}"

    @property
    def label(self) -> str:
        """For the names of folders."""
        return "part"

    def box(self, height: int, width: int) -> Box:
        """Return the rows and columns.

        Raises:
            InputError: The image is of another size.
        """
        if (height, width) != (self.height, self.width):
            raise InputError(
                f"the protocol scores rows {self.top}:{self.bottom} and columns "
                f"{self.left}:{self.right} of {self.width}x{self.height}; "
                f"the truth is {width}x{height}: take the set at its published size"
            )
        return Box(self.top, self.bottom, self.left, self.right)


@dataclass(frozen=True)
class Shares:
    """Rows and columns between fractions of height and width."""

    top: float
    bottom: float
    left: float
    right: float

    def __str__(self) -> str:
        """Return it in words."""
        rows, columns = f"{self.top:.4f}:{self.bottom:.4f}", f"{self.left:.4f}:{self.right:.4f}"
        return f"rows {rows}, columns {columns}"

    @property
    def label(self) -> str:
        """For the names of folders."""
        return "part"

    def box(self, height: int, width: int) -> Box:
        """Return the rows and columns."""
        return Box(
            int(self.top * height),
            int(self.bottom * height),
            int(self.left * width),
            int(self.right * width),
        )


@dataclass(frozen=True)
class KittiCrop:
    """A part of KITTI's benchmark crop: 352 rows from below, 1216 columns in the middle.

    Attributes:
        inner: The part, all of it by default.
    """

    inner: Everything | Shares = WHOLE

    def __str__(self) -> str:
        """Return it in words."""
        return f"{self.inner} of KITTI's benchmark crop"

    @property
    def label(self) -> str:
        """For the names of folders."""
        return "kitti-crop"

    def box(self, height: int, width: int) -> Box:
        """Return the rows and columns of the image.

        Raises:
            InputError: The image is smaller than the crop.
        """
        high, wide = KITTI_CROP
        if height < high or width < wide:
            raise InputError(
                f"KITTI's benchmark crop is {wide}x{high}, the image {width}x{height}: this is "
                f"no image of KITTI, or not at its published size"
            )
        top, left = height - high, int((width - wide) / 2)
        inner = self.inner.box(high, wide)
        return Box(top + inner.top, top + inner.bottom, left + inner.left, left + inner.right)


Region = Everything | Fixed | Shares | KittiCrop

GARG = Shares(0.40810811, 0.99189189, 0.03594771, 0.96405229)
"""Garg, Vijay Kumar, Carneiro and Reid, ECCV 2016."""

EIGEN = Shares(0.3324324, 0.91351351, 0.0359477, 0.96405229)
"""Eigen, Puhrsch and Fergus, NeurIPS 2014, on KITTI."""

EIGEN_NYU = Fixed(45, 471, 41, 601, 480, 640)
"""The same on NYU Depth v2."""
