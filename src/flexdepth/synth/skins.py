"""Skins: smooth surfaces through rings around a bending line, for bodies that move.

The same rings at another time give the same triangles elsewhere, so a texture sticks to them.
"""

from math import pi

import numpy as np
from numpy.typing import ArrayLike

from flexdepth.synth.shapes import Array, Mesh, surface

SEGMENTS = 10
"""Corners of a ring."""


def skin(centres: ArrayLike, across: ArrayLike, radii: ArrayLike, segments: int = SEGMENTS) -> Mesh:
    """Return the surface through elliptic rings around a line of points, closed at both ends.

    Args:
        centres: Points of the line by (x, y, z).
        across: The direction of the first radius, one for all rings or one for each.
        radii: Points by two: the radius along `across`, and the one at right angles to it and
            to the line.
        segments: Corners of a ring.
    """
    middle, radius = np.asarray(centres, float), np.asarray(radii, float)
    along = _unit(np.gradient(middle, axis=0))
    side = np.broadcast_to(np.asarray(across, float), middle.shape)
    side = _unit(side - (side * along).sum(1, keepdims=True) * along)
    front = np.cross(side, along)
    angle = np.linspace(0, 2 * pi, segments + 1)[None, :, None]
    first = radius[:, None, :1] * np.cos(angle) * side[:, None]
    second = radius[:, None, 1:] * np.sin(angle) * front[:, None]
    rings = middle[:, None] + first + second
    ends = [np.broadcast_to(middle[k], rings[:1].shape) for k in (0, -1)]
    return surface(np.concatenate([ends[0], rings, ends[1]]))


def limb(joints: ArrayLike, across: Array, radii: ArrayLike, stations: int = 4) -> Mesh:
    """Return a limb through its joints, rounded where it bends and at its ends.

    Args:
        joints: Shoulder, elbow and wrist, or hip, knee and ankle, or more; points by (x, y, z).
        across: The hinges' direction.
        radii: As many as there are stations, evenly spaced from the first joint to the last.
        stations: Rings from one joint to the next.
    """
    corner = np.asarray(joints, float)
    place = np.linspace(0, len(corner) - 1, stations * (len(corner) - 1) + 1)
    line = np.stack([np.interp(place, np.arange(len(corner)), axis) for axis in corner.T], 1)
    line[1:-1] = 0.25 * line[:-2] + 0.5 * line[1:-1] + 0.25 * line[2:]
    given = np.asarray(radii, float)
    radius = np.interp(place / place[-1], np.linspace(0, 1, len(given)), given)
    for end, inner in ((0, 1), (-1, -2)):
        outward = 0.8 * radius[end] * _unit(line[end] - line[inner])
        line = np.insert(line, len(line) if end else 0, line[end] + outward, axis=0)
        radius = np.insert(radius, len(radius) if end else 0, 0.6 * radius[end])
    return skin(line, across, np.stack([radius, radius], 1))


def _unit(vectors: Array) -> Array:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))
