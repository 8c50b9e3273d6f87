"""Bringing a prediction to the size of the truth that it is scored against."""

from dataclasses import replace
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.evaluation.protocols import Resize, ScoringProtocol
from flexdepth.evaluation.region import KITTI_CROP, Box, KittiCrop
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError

_Reals: TypeAlias = NDArray[np.float32]

_MOST_STRETCH = 1.6
"""A prediction whose shape is off by more than this factor is of something else, or lies on its
side."""
_OPENCV = {Resize.BILINEAR: cv2.INTER_LINEAR, Resize.CUBIC: cv2.INTER_CUBIC}


def at_size_of_truth(
    prediction: DepthMap, shape: tuple[int, int], protocol: ScoringProtocol
) -> DepthMap:
    """Return the prediction at the truth's size, unknown where it does not reach.

    Args:
        prediction: At the truth's size, at that of KITTI's benchmark crop, or at any size, of the
            part of the image that the protocol's network sees.
        shape: The truth's height and width.
        protocol: Says which part that is, and how to resize.

    Raises:
        InputError: The prediction's shape cannot be that of the image.
    """
    if prediction.values.shape == shape:
        return prediction
    is_kitti = prediction.values.shape == KITTI_CROP and min(np.subtract(shape, KITTI_CROP)) >= 0
    box = (KittiCrop() if is_kitti else protocol.view).box(*shape)
    values = prediction.values
    if values.shape != box.size:
        _check_shape(values.shape, box.size)
        values = resized(values, box.size, protocol.resize, prediction.space)
    return replace(prediction, values=_placed(values, box, shape), spread=None)


def resized(values: _Reals, size: tuple[int, int], how: Resize, space: Space) -> _Reals:
    """Return a map at another size. Unknown and sky stay whole pixels: they are not mixed in.

    Args:
        values: As in `DepthMap`.
        size: Height and width.
        how: The interpolation.
        space: Of the map, in which larger may be nearer.
    """
    inverse = how is Resize.DISPARITY and space is not Space.AFFINE_DISPARITY
    known = np.isfinite(values) & ((values > 0) if inverse else True)
    numbers = np.where(known, values, 1)
    if inverse:
        numbers = 1 / numbers
    share = _interpolated(known.astype(np.float32), size, how)
    numbers = _interpolated(np.where(known, numbers, 0), size, how)
    enough = share >= 0.5
    numbers = np.divide(numbers, share, where=enough, out=np.full(size, np.nan, np.float32))
    if inverse:
        numbers = 1 / numbers
    sky = cv2.resize(
        np.isinf(values).astype(np.uint8), size[::-1], interpolation=cv2.INTER_NEAREST_EXACT
    )
    far = np.float32(-np.inf if space is Space.AFFINE_DISPARITY else np.inf)
    return np.where(~enough & (sky > 0), far, numbers).astype(np.float32)


def _interpolated(values: _Reals, size: tuple[int, int], how: Resize) -> _Reals:
    height, width = size
    if how is Resize.CORNERS:
        rows, columns = (
            np.linspace(0, there - 1, here, dtype=np.float32)
            for there, here in zip(values.shape, size, strict=True)
        )
        return _remapped(values, rows, columns)
    flags = _OPENCV.get(how, cv2.INTER_LINEAR)
    return np.asarray(cv2.resize(values, (width, height), interpolation=flags), np.float32)


def _remapped(values: _Reals, rows: _Reals, columns: _Reals) -> _Reals:
    """Return the values between pixels; `cv2.remap` would round places to 1/32 of a pixel."""
    above, left = (np.floor(each).astype(int) for each in (rows, columns))
    below = np.minimum(above + 1, values.shape[0] - 1)
    right = np.minimum(left + 1, values.shape[1] - 1)
    down, across = (rows - above)[:, None], (columns - left)[None]
    upper = values[above][:, left] * (1 - across) + values[above][:, right] * across
    lower = values[below][:, left] * (1 - across) + values[below][:, right] * across
    return np.asarray(upper * (1 - down) + lower * down, np.float32)


def _placed(values: _Reals, box: Box, shape: tuple[int, int]) -> _Reals:
    if values.shape == shape:
        return values
    whole = np.full(shape, np.nan, np.float32)
    whole[box.slices] = values
    return whole


def _check_shape(got: tuple[int, ...], wanted: tuple[int, int]) -> None:
    stretch = (got[1] / got[0]) / (wanted[1] / wanted[0])
    if not 1 / _MOST_STRETCH < stretch < _MOST_STRETCH:
        raise InputError(
            f"the prediction is {got[1]}x{got[0]}, what it is scored against "
            f"{wanted[1]}x{wanted[0]}: one cannot be a resized version of the other"
        )
