"""Those who never look at the picture: what a model that sees must beat."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import DepthMap, Intrinsics, Space

CAMERA_HEIGHT = 1.65
"""Metres above the road, KITTI's. A fit in disparity leaves it no say but through the cap."""
GROUND_CAP = 40.0
"""Metres: the ground plane goes no farther, and stands for everything above the horizon."""

CONSTANT, BEST_CONSTANT, RAMP, GROUND = "constant", "best constant", "ramp", "ground plane"


def constant(height: int, _camera: Intrinsics) -> DepthMap:
    """Return one depth for all rows."""
    return _column(np.ones(height), Space.SCALE)


def ramp(height: int, _camera: Intrinsics) -> DepthMap:
    """Return disparity that grows evenly from 0 at the upper edge."""
    return _column(height / (np.arange(height) + 0.5), Space.SCALE)


def ground(height: int, camera: Intrinsics) -> DepthMap:
    """Return the flat ground below a camera that looks at the horizon, in metres."""
    rows = np.arange(height) + 0.5
    road = (rows - camera.centre_y) / (camera.focal_y * CAMERA_HEIGHT)
    return _column(1 / np.maximum(road, 1 / GROUND_CAP), Space.METRIC)


BLIND: Mapping[str, Callable[[int, Intrinsics], DepthMap]] = MappingProxyType(
    {CONSTANT: constant, RAMP: ramp, GROUND: ground}
)
"""By name: the depth of a column of so many rows, seen by a camera."""


def best_constant(truth: NDArray[np.float64]) -> float:
    """Return the constant with the least AbsRel of all, which takes the truth to know.

    mean(|c - g| / g) is least at the median of g, each of them counted 1/g times.

    Args:
        truth: Measured depth at the scored pixels; at least one.
    """
    depths = np.sort(truth)
    counts = np.cumsum(1 / depths)
    return float(depths[np.searchsorted(counts, counts[-1] / 2)])


def widened(column: DepthMap, width: int) -> DepthMap:
    """Return a map whose columns are all alike."""
    return DepthMap(np.tile(column.values, (1, width)), column.space)


def _column(depth: NDArray[np.float64], space: Space) -> DepthMap:
    return DepthMap(depth[:, None].astype(np.float32), space)
