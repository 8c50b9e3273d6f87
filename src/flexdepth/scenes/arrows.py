"""How things move, as arrows in space: thin shafts with a cone, true to scale."""

from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.cloud import Mesh

Array = NDArray[np.float64]

MOST = 400
"""Arrows of a picture: more hide what they stand for."""

_SIDES = 5
_RADIUS, _HEAD_RADIUS, _HEAD_LENGTH = 0.0012, 0.0045, 0.015
"""Of an arrow, as shares of its distance, so that near and far look alike from the camera."""

_SHORTEST = 0.002
"""Of its distance: a shorter arrow would be all head."""


def spread_out(mask: NDArray[np.bool_], most: int = MOST) -> NDArray[np.bool_]:
    """Return at most about so many of the pixels of a mask, on an even grid."""
    every = max(1, ceil(sqrt(mask.sum() / most)))
    chosen = np.zeros_like(mask)
    chosen[every // 2 :: every, every // 2 :: every] = True
    return chosen & mask


def arrows(starts: Array, ways: Array, colours: NDArray[np.uint8], thick: Array) -> Mesh:
    """Return an arrow for each start, from there along its way.

    Args:
        starts: Arrows by 3.
        ways: Arrows by 3, from tail to tip. Those shorter than .2 % of `thick` are left out.
        colours: Arrows by 3, RGB.
        thick: Distances in whose proportion the arrows are thick, of each.
    """
    length = np.linalg.norm(ways, axis=1)
    long = length > _SHORTEST * thick
    starts, ways, colours, thick = starts[long], ways[long], colours[long], thick[long]
    if not len(starts):
        return Mesh(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint8), _no_triangles())
    unit = ways / length[long, None]
    head = np.minimum(_HEAD_LENGTH * thick, 0.4 * length[long])
    ring = _ring(unit)
    neck = starts + ways - unit * head[:, None]
    narrow = np.minimum(_RADIUS * thick, 0.3 * head)[:, None, None] * ring
    wide = np.minimum(_HEAD_RADIUS * thick, head)[:, None, None] * ring
    corners = np.concatenate(
        [
            starts[:, None] + narrow,
            neck[:, None] + narrow,
            neck[:, None] + wide,
            (starts + ways)[:, None],
        ],
        axis=1,
    )
    per = corners.shape[1]
    triangles = _pattern()[None] + per * np.arange(len(starts), dtype=np.int32)[:, None, None]
    return Mesh(
        corners.reshape(-1, 3).astype(np.float32),
        np.repeat(colours, per, axis=0),
        triangles.reshape(-1, 3),
    )


def _ring(unit: Array) -> Array:
    """Return points on unit circles across some directions: directions by sides by 3."""
    away = np.eye(3)[np.abs(unit).argmin(axis=1)]
    first = np.cross(unit, away)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(unit, first)
    angle = 2 * np.pi * np.arange(_SIDES) / _SIDES
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return np.asarray(cosine * first[:, None] + sine * second[:, None])


def _pattern() -> NDArray[np.int32]:
    """Return the triangles of one arrow: tail ring, neck ring, head ring, tip."""
    here = np.arange(_SIDES)
    beside = (here + 1) % _SIDES
    tail, neck, head, tip = 0, _SIDES, 2 * _SIDES, np.full(_SIDES, 3 * _SIDES)
    parts = [
        (tail + here, tail + beside, neck + here),
        (neck + here, tail + beside, neck + beside),
        (neck + here, neck + beside, head + here),
        (head + here, neck + beside, head + beside),
        (head + here, head + beside, tip),
    ]
    return np.concatenate([np.stack(part, axis=1) for part in parts]).astype(np.int32)


def _no_triangles() -> NDArray[np.int32]:
    return np.zeros((0, 3), np.int32)
