"""From depth to colour: near is bright, far is dark.

The colours are OpenCV's Inferno, whose lightness rises evenly, so that the order of depths is
seen without reading a legend and survives a gray print. Sky is blue and the unknown gray, for
Inferno holds neither.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, isnan, nan
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError

Pixels: TypeAlias = NDArray[np.uint8]
Colour: TypeAlias = tuple[int, int, int]

SKY: Colour = (150, 190, 230)
"""The colour of sky."""
UNKNOWN: Colour = (128, 128, 128)
"""The colour of pixels whose depth is unknown."""

_DARKEST = 12
"""Where the colours begin: Inferno's first are hardly told from black."""


@dataclass(frozen=True)
class Limits:
    """The two ends of a colour scale.

    Attributes:
        nearest: The value with the nearest colour, in the map's own numbers.
        farthest: The value with the farthest colour; for affine disparity it is the smaller.
            Both are NaN where there is nothing but sky and the unknown.
        sky: Whether the legend explains the colour of sky.
    """

    nearest: float
    farthest: float
    sky: bool = False

    def __post_init__(self) -> None:
        """Refuse a scale without length."""
        if self.nearest == self.farthest or isnan(self.nearest) != isnan(self.farthest):
            raise InputError(
                f"a colour scale needs two different ends, got {self.nearest} and {self.farthest}"
            )

    @property
    def empty(self) -> bool:
        """Whether there is no value to show."""
        return isnan(self.nearest)


def limits(depth_map: DepthMap) -> Limits:
    """Return the range of a map without its rarest 1 % at either end.

    A map of one single value gets a range of 5 % around it.
    """
    every = ceil((depth_map.values.size / 1_000_000) ** 0.5)
    values = depth_map.values[::every, ::every]
    values = values[_shown(values, depth_map.space)]
    sky = bool(depth_map.sky.any())
    if not values.size:
        return Limits(nan, nan, sky)
    low, high = (float(value) for value in np.percentile(values, [1, 99]))
    if high - low <= 1e-6 * max(abs(low), abs(high)):
        around = 0.05 * abs(low) or 0.05
        low, high = low - around, high + around
    if depth_map.space is Space.AFFINE_DISPARITY:
        return Limits(high, low, sky)
    return Limits(low, high, sky)


def merged(each: Iterable[Limits]) -> Limits:
    """Return the limits that hold all the given ones: one colour scale over a clip.

    Args:
        each: Limits of maps of one space.
    """
    every = tuple(each)
    sky = any(one.sky for one in every)
    filled = [one for one in every if not one.empty]
    if not filled:
        return Limits(nan, nan, sky)
    near, far = [one.nearest for one in filled], [one.farthest for one in filled]
    if near[0] < far[0]:
        return Limits(min(near), max(far), sky)
    return Limits(max(near), min(far), sky)


def _logarithmic(space: Space) -> bool:
    """Return whether the space has a zero, so that ratios of its numbers mean something."""
    return space in (Space.METRIC, Space.SCALE)


def _shown(values: NDArray[np.float32], space: Space) -> NDArray[np.bool_]:
    """Return which values have a place on the colour scale."""
    finite = np.isfinite(values)
    return finite & (values > 0) if _logarithmic(space) else finite


def nearness(values: NDArray[np.float32], ends: Limits, space: Space) -> NDArray[np.float32]:
    """Return 1 at the nearest end of the scale and 0 at the farthest, without clipping."""
    scale = np.log if _logarithmic(space) else np.asarray
    near, far = (float(scale(end)) for end in (ends.nearest, ends.farthest))
    fraction: NDArray[np.float32] = (scale(values) - np.float32(far)) / np.float32(near - far)
    return fraction


def palette() -> Pixels:
    """Return the colours from far to near: 256 x 3, RGB."""
    levels = np.linspace(_DARKEST, 255, 256).round().astype(np.uint8)
    coloured = cv2.applyColorMap(levels[:, None], cv2.COLORMAP_INFERNO)
    return np.ascontiguousarray(coloured[:, 0, ::-1], np.uint8)


def coloured(depth_map: DepthMap, ends: Limits) -> Pixels:
    """Return the colour of every pixel: RGB, uint8.

    Depth that is metric or known up to scale is coloured by its logarithm, so that near and far
    both show their shape; affine depth and disparity, which have no zero, evenly.

    Args:
        depth_map: The map.
        ends: The ends of the colours, beyond which they stay.

    Raises:
        InputError: The limits are the wrong way round, or not positive under the logarithm.
    """
    _check(ends, depth_map.space)
    shown = _shown(depth_map.values, depth_map.space)
    near = nearness(np.where(shown, depth_map.values, 1), ends, depth_map.space)
    near = np.nan_to_num(near, copy=False).clip(0, 1)
    picture = palette()[np.rint(near * 255).astype(np.uint8)]
    picture[~shown] = UNKNOWN
    picture[depth_map.sky] = SKY
    return picture


def _check(ends: Limits, space: Space) -> None:
    """Refuse limits that do not suit the numbers of a space."""
    if ends.empty:
        return
    if _logarithmic(space) and min(ends.nearest, ends.farthest) <= 0:
        raise InputError(
            f"the colour scale of {space} depth needs limits > 0, "
            f"got {ends.nearest:g} and {ends.farthest:g}"
        )
    if (ends.nearest > ends.farthest) != (space is Space.AFFINE_DISPARITY):
        raise InputError(
            f"the nearest of {space} lies on the other side of the farthest: "
            f"got nearest {ends.nearest:g} and farthest {ends.farthest:g}; exchange them"
        )
