"""What a depth map says of the surfaces in it: where they lie, where they end, how they face.

Everything here works in inverse depth, for there a plane is an affine function of the pixel,
however grazing the view: with the ray r = ((u − cx)/fx, (v − cy)/fy, 1) and X = z r, the plane
n·X = c reads n·r = c/z. So a wall seen edge on has slope but no curvature, and a step has both.
Coordinates are x right, y down, z forward; pixel centres lie at half integers, corner origin.
"""

from math import ceil
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import DepthMap, Intrinsics, Space
from flexdepth.runtime.errors import InputError

Floats: TypeAlias = NDArray[np.float32]
Mask: TypeAlias = NDArray[np.bool_]

_JUMP = 0.05
"""Neighbours further apart than this share of their depth may lie on two surfaces."""
_STEEPER = 3.0
"""How many times steeper than the surfaces around it a step is."""
_SMOOTH = 1e-3
"""Second differences below this share of the inverse depth count as none."""
_FINENESS = 384
"""A step spreads over few of so many parts of the longer side: what networks resolve."""
_BAND = 1 << 20
"""Pixels handled at a time where the temporary arrays are many."""


def camera_of(depth_map: DepthMap) -> Intrinsics:
    """Return the camera through which the map becomes points.

    Raises:
        InputError: The map is known only up to an offset, or nothing is known of its camera.
    """
    if depth_map.space not in (Space.METRIC, Space.SCALE):
        raise InputError(
            f"points and normals need depth that is metric or known up to scale, but this map "
            f"is {depth_map.space}: fit it to measured depth first"
        )
    if depth_map.intrinsics is None:
        raise InputError(
            "points and normals need a camera, but this map has no intrinsics: "
            "give a focal length or a field of view"
        )
    return depth_map.intrinsics


def rays(rows: NDArray[np.intp], columns: NDArray[np.intp], camera: Intrinsics) -> Floats:
    """Return ((u − cx)/fx, (v − cy)/fy, 1) through the centres of the pixels: times z, a point."""
    x = (columns + 0.5 - camera.centre_x) / camera.focal_x
    y = (rows + 0.5 - camera.centre_y) / camera.focal_y
    return np.stack(np.broadcast_arrays(x, y, 1), -1, dtype=np.float32, casting="same_kind")


def inverse_depth(depth: Floats) -> Floats:
    """Return 1/z: sky is 0, as far as can be; NaN where the depth is unknown or not positive."""
    known = depth > 0
    return np.where(known, 1 / np.where(known, depth, 1), np.nan).astype(np.float32)


def flying(depth: Floats) -> Mask:
    """Return the pixels that hang in the air between a near surface and a far one.

    Networks, resizing and sensors smear a step over some pixels. Such a pixel lies, along its
    row or its column, on a rise of inverse depth (one neighbour nearer, the other farther) that
    is at least three times as steep as the flattest place within reach on either side, and so
    steep that over three times the reach it would make up the whole change within reach, which is
    more than 5 % of the depth. A plane is equally steep everywhere, so a slanted wall or a floor
    stays at any angle; a clean step has no pixel in the middle, so its edges stay; a thin pole is
    no rise but a ridge, and stays. A side wall at a grazing angle between two such surfaces
    looks the same as a smeared step: narrower than the reach (1/128 of the longer side, at least
    2 pixels) it goes, wider than twice that it stays.

    Args:
        depth: Larger is farther, +inf is sky; elsewhere finite and positive where it is known.
    """
    inverse = inverse_depth(depth)
    reach = max(2, ceil(3 * max(depth.shape) / _FINENESS))
    across = _on_a_rise(inverse, reach)
    down = _on_a_rise(np.ascontiguousarray(inverse.T), reach).T
    return across | down


def _on_a_rise(inverse: Floats, reach: int) -> Mask:
    """Return the pixels on a smeared step along their row, as `flying` defines it."""
    step = np.diff(inverse, axis=1, prepend=np.nan, append=np.nan)
    left, right = step[:, :-1], step[:, 1:]
    slope = np.where(left * right > 0, np.minimum(abs(left), abs(right)), 0)
    known = ~np.isnan(inverse)
    window = np.ones((1, 2 * reach + 1), np.uint8)
    nearest = cv2.dilate(np.where(known, inverse, 0), window)
    farthest = cv2.erode(np.where(known, inverse, np.inf), window)
    change = nearest - farthest
    # Only the few pixels that may qualify are looked at closely.
    row, column = np.nonzero((change > _JUMP * inverse) & (3 * reach * slope > change))
    steepness = np.where(np.isnan(step), np.inf, abs(step))
    flattest_left = np.full(row.shape, np.inf, np.float32)
    flattest_right = flattest_left.copy()
    for far in range(1, reach + 1):
        before = np.maximum(column - far, 0)
        after = np.minimum(column + 1 + far, inverse.shape[1])
        flattest_left = np.minimum(flattest_left, steepness[row, before])
        flattest_right = np.minimum(flattest_right, steepness[row, after])
    surroundings = _STEEPER * np.maximum(flattest_left, flattest_right)
    found = np.zeros(inverse.shape, bool)
    found[row, column] = slope[row, column] > surroundings
    return found


def steps(inverse: Floats) -> Mask:
    """Return where a row breaks between a pixel and the next: height x (width − 1).

    A break is a change by more than 5 % of the nearer one's depth that the slope on neither side
    foretells: more than three times as steep, or the other way. Sky and the unknown are no
    surface, so nothing joins them.
    """
    change = np.diff(inverse, axis=1)
    nearer = np.fmax(inverse[:, :-1], inverse[:, 1:])
    beside = np.pad(change, ((0, 0), (1, 1)))
    direction = np.sign(change)
    foretold = np.fmax(beside[:, :-2] * direction, beside[:, 2:] * direction)
    unforetold = abs(change) > _STEEPER * np.nan_to_num(foretold, nan=0)
    broken = (abs(change) > _JUMP * nearer) & unforetold
    return broken | ~(inverse[:, :-1] > 0) | ~(inverse[:, 1:] > 0)


def normals(depth_map: DepthMap) -> Floats:
    """Return the unit normal at every pixel, towards the camera: height x width x (x, y, z).

    x is right, y down, z forward: a wall that faces the camera is (0, 0, −1). With q = 1/z, the
    normal is −(fx q_u, fy q_v, q − (u − cx) q_u − (v − cy) q_v), scaled to length one, which is
    exact on planes. Slopes are taken between pixels 1/384 of the longer side apart (at least 1),
    more from the smoother side, so that at a step each surface keeps its own normal. NaN where
    the depth is unknown, where it is sky, and where no neighbour tells a slope.

    Raises:
        InputError: The map is known only up to an offset, or nothing is known of its camera.

    References:
        The formula: Fan et al., Three-Filters-to-Normal, RA-L 2021. The sides are weighted as in
        Jiang and Shu's WENO schemes, JCP 1996.
    """
    camera = camera_of(depth_map)
    height, width = depth_map.values.shape
    apart = max(1, round(max(height, width) / _FINENESS))
    result = np.empty((height, width, 3), np.float32)
    band = max(1, _BAND // width)
    for top in range(0, height, band):
        bottom = min(top + band, height)
        first, last = max(0, top - 2 * apart), min(height, bottom + 2 * apart)
        found = _normals(depth_map.values[first:last], first, camera, apart)
        result[top:bottom] = found[top - first : bottom - first]
    return result


def _normals(depth: Floats, top: int, camera: Intrinsics, apart: int) -> Floats:
    """Return the normals of the rows that begin with row `top` of the image."""
    height, width = depth.shape
    inverse = inverse_depth(np.where(np.isfinite(depth), depth, np.nan))
    across = _slope(inverse, apart)
    down = _slope(inverse.T, apart).T
    from_centre_x = np.float32(0.5 - camera.centre_x) + np.arange(width, dtype=np.float32)
    from_centre_y = np.float32(top + 0.5 - camera.centre_y) + np.arange(height, dtype=np.float32)
    x = np.float32(camera.focal_x) * across
    y = np.float32(camera.focal_y) * down
    z = inverse - from_centre_x * across - from_centre_y[:, None] * down
    outward = np.stack([x, y, z], -1)
    unit: Floats = -outward / np.linalg.norm(outward, axis=-1, keepdims=True)
    return unit


def _slope(inverse: Floats, apart: int) -> Floats:
    """Return the slope along the rows, from the side on which the row bends less.

    Each side is weighted by 1 / (small + bend²)²: equal on smooth ground, all on one side at a
    step. A side that reaches over the border or to the unknown has no weight; one whose bend
    alone cannot be seen has a little.
    """
    height, width = inverse.shape
    beyond = np.full((height, 2 * apart), np.nan, np.float32)
    wide = np.concatenate([beyond, inverse, beyond], 1)
    far_left, left, here, right, far_right = (wide[:, k * apart :][:, :width] for k in range(5))
    return _blend(
        (here - left, abs(here - 2 * left + far_left)),
        (right - here, abs(here - 2 * right + far_right)),
        here,
    ) / np.float32(apart)


def _blend(left: tuple[Floats, Floats], right: tuple[Floats, Floats], scale: Floats) -> Floats:
    """Return the mean of both changes, each weighted by how little it bends."""
    total = np.zeros_like(scale)
    weights = np.zeros_like(scale)
    for change, bend in (left, right):
        unseen = np.where(np.isnan(bend), 1, bend / scale)
        weight = np.where(np.isnan(change), 0, (_SMOOTH**2 + unseen**2) ** -2)
        total += np.where(np.isnan(change), 0, change * weight)
        weights += weight
    known = weights > 0
    return np.where(known, total / np.where(known, weights, 1), np.nan).astype(np.float32)


def normals_picture(unit: Floats) -> NDArray[np.uint8]:
    """Return normals as colours, (n + 1)/2 with red right, green up and blue towards the camera.

    These are the usual axes of such pictures, so y and z change sign: what faces the camera is
    (128, 128, 255), a floor is green. Black, which no unit vector gives, is the unknown.

    Args:
        unit: As `normals` returns them: x right, y down, z forward, NaN where unknown.
    """
    coded = unit * np.array([127.5, -127.5, -127.5], np.float32)
    coded += 127.5
    np.rint(coded, out=coded)
    return np.nan_to_num(coded, copy=False, nan=0).astype(np.uint8)
