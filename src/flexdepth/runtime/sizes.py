"""The size at which the network looks at a picture, and the way there and back."""

from dataclasses import dataclass
from itertools import product
from math import log, sqrt
from typing import Protocol, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError

Number = TypeVar("Number", np.uint8, np.float32)


@dataclass(frozen=True)
class Area:
    """How large a network wants its pictures.

    Attributes:
        area: Width and height whose product is the number of pixels.
        multiple: Width and height are multiples of this.
    """

    area: tuple[int, int]
    multiple: int


class HasArea(Protocol):
    """What says how large a network wants its pictures: an `Area`, or a bundle's description."""

    @property
    def area(self) -> tuple[int, int]:
        """Width and height whose product is the number of pixels."""
        ...

    @property
    def multiple(self) -> int:
        """Width and height are multiples of this."""
        ...


_AREA_AGAINST_ASPECT = 0.5
"""How much an area off by a factor counts against an aspect off by the same factor."""


def network_size(
    width: int, height: int, wanted: HasArea, long_side: int | None = None
) -> tuple[int, int]:
    """Return width and height of what the network is given for a picture.

    Both are multiples of the network's. Without `long_side` their product is near its
    area and, of the roundings, the one that least changes the picture's aspect is taken: 640 x
    480 becomes 384 x 288, KITTI's 1242 x 375 becomes 608 x 192. A picture so long that it would
    be thinner than one multiple is squeezed along its length, so that the area stays.

    Args:
        width: Of the picture, in pixels.
        height: In pixels.
        wanted: The network's area and multiple.
        long_side: Take this as the longer side instead, rounded to the nearest multiple.

    Raises:
        InputError: `long_side` is less than one multiple.
    """
    multiple = wanted.multiple
    if long_side is not None:
        if long_side < multiple:
            raise InputError(
                f"--long-side: wanted a number of pixels >= {multiple}, got {long_side}"
            )
        scale = round(long_side / multiple) * multiple / max(width, height)
        return _nearest(width * scale, multiple), _nearest(height * scale, multiple)
    area = wanted.area[0] * wanted.area[1]
    scale = sqrt(area / (width * height))
    longest = max(area // multiple // multiple, 1) * multiple

    def stretch(size: tuple[int, int]) -> float:
        aspect = log(size[0] / size[1] * height / width)
        return abs(aspect) + _AREA_AGAINST_ASPECT * abs(log(size[0] * size[1] / area))

    sides = (_around(width * scale, multiple, longest), _around(height * scale, multiple, longest))
    return min(product(*sides), key=stretch)


def times_larger(size: tuple[int, int], times: float, multiple: int) -> tuple[int, int]:
    """Return the network's size for a picture whose own network size, width and height, is `size`.

    Its area is near that of the other `times` as wide and high; at `times` 1 it is the same.
    """
    if times == 1:
        return size
    width, height = size
    return network_size(*size, Area((round(width * times), round(height * times)), multiple))


def resized(values: NDArray[Number], size: tuple[int, int]) -> NDArray[Number]:
    """Return `values` at `size` (width, height): means where it shrinks, else interpolated.

    Pixel centres lie at half integers in both.
    """
    height, width = values.shape[:2]
    shrinks = size[0] <= width and size[1] <= height
    how = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(values, size, interpolation=how), values.dtype)


def _nearest(length: float, multiple: int) -> int:
    return max(round(length / multiple), 1) * multiple


def _around(length: float, multiple: int, longest: int) -> tuple[int, int]:
    """Return the multiples below and above `length`, within one multiple and `longest`."""
    below = min(max(int(length) // multiple * multiple, multiple), longest)
    return below, min(below + multiple, longest)
