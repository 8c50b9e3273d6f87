"""The focal length that makes walls perpendicular to floors.

On a plane the inverse depth is affine in the pixel, 1/z = a u + b v + c with u and v from the
principal point, and the plane's normal is along (a f, b f, c). Depth alone thus gives a, b, c of
every flat patch, and the focal length decides under which angles they meet. What people build
meets at right angles: at the true focal length more pairs of patches do than at any other.

References:
    The constraint is that of a calibration by vanishing points: Caprile and Torre, IJCV 1990.
"""

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.folder import Pair

FACTORS: NDArray[np.float64] = np.exp(np.linspace(-np.log(2.6), np.log(2.6), 49))
"""Of the stated focal length: those that are tried; the middle one is 1."""

_PATCH = 16
_WIDTH = 640
_FLAT = 0.004
_RIGHT = 0.04
_MOST, _FEWEST = 250, 30


def right_angles(pair: Pair) -> NDArray[np.float64] | None:
    """Return which share of the pairs of patches is perpendicular, by factor on the focal length.

    Args:
        pair: With metric depth and a camera.

    Returns:
        None where there are too few flat patches.
    """
    planes = flat_patches(pair)
    if len(planes) < _FEWEST:
        return None
    every = -(-len(planes) // _MOST)
    planes = planes[::every]
    shares = []
    for factor in FACTORS:
        normals = planes * (factor, factor, 1.0)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        shares.append(float((np.abs(normals @ normals.T) < _RIGHT).mean()))
    return np.array(shares)


def flat_patches(pair: Pair) -> NDArray[np.float64]:
    """Return (a f, b f, c) of each patch that is flat to 0.4 %, for the stated camera: n x 3.

    Patches are squares, 16 pixels wide in a picture of 640; those with holes are left out.
    """
    camera = pair.truth.intrinsics
    if camera is None:
        return np.zeros((0, 3))
    side = _PATCH * max(1, round(pair.truth.values.shape[1] / _WIDTH))
    rows, columns = (length // side for length in pair.truth.values.shape)
    known = np.where(pair.truth.values > 0, pair.truth.values, np.nan)
    cut = known[: rows * side, : columns * side].astype(np.float64)
    blocks = (1 / cut).reshape(rows, side, columns, side).transpose(0, 2, 1, 3)
    patches = blocks.reshape(rows * columns, side * side)
    row, column = (index.ravel() for index in np.mgrid[:rows, :columns])
    whole = np.isfinite(patches).all(axis=1) & (patches > 0).all(axis=1)
    patches, row, column = patches[whole], row[whole], column[whole]
    v, u = (index.ravel() + 0.5 - side / 2 for index in np.mgrid[:side, :side])
    basis = np.stack([u, v, np.ones(side * side)], axis=1)
    planes = patches @ np.linalg.pinv(basis).T
    spread = np.sqrt(((patches - planes @ basis.T) ** 2).mean(axis=1))
    a, b, middle = planes[spread < _FLAT * planes[:, 2]].T
    flat = spread < _FLAT * planes[:, 2]
    across = (column[flat] + 0.5) * side - camera.centre_x
    down = (row[flat] + 0.5) * side - camera.centre_y
    return np.stack([a * camera.focal_x, b * camera.focal_y, middle - a * across - b * down], 1)
