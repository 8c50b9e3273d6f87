"""What moves along the camera's epipolar lines: only its place among other things gives it away.

A car that drives as the camera does leaves no trace across the lines. Taken to be still, it is
farther than the road on which it stands, and than things that it hides: it has sunk into them.
(What seems too near is let be: it may hang, as a lamp does or the crown of a tree.)
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.borders import Border, border, surroundings
from flexdepth.solvers.ground import ground
from flexdepth.solvers.pieces import Labels
from flexdepth.solvers.regions import connected
from flexdepth.solvers.sight import Sight
from flexdepth.solvers.two_view import Along

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_SUNK = 1.25
"""How many times nearer the ground at a thing's foot is than the thing, for it to have sunk."""

_LARGEST = 0.25
"""The share of the frame up to which a region is a thing."""

_NEAR = 0.08
"""Relative inverse depth within which the surface below a thing is the ground."""

_FEWEST = 5

_SMOOTH = 0.2
"""Pixels of flow: beyond a larger jump another thing begins."""


@dataclass(frozen=True, eq=False)
class Still:
    """What moves as the camera's own motion says.

    Attributes:
        cut: Pieces of the frame.
        labels: 0 where nothing moves by itself.
        along: What the flow says of depth.
    """

    cut: Labels
    labels: Labels
    along: Along


def with_sunk(still: Still, sight: Sight) -> Labels:
    """Return the labels, with the things that have sunk among what is still as new regions."""
    labels = still.labels.copy()
    known = sight.trusted & (labels == 0) & (still.along.parallax > 2 * sight.noise)
    known &= still.along.inverse_depth > 0
    inverse = np.where(known, still.along.inverse_depth, 0.0)
    floor = ground(sight.key, inverse, known)
    if floor is None:
        return labels
    smooth = max(_SMOOTH, 4 * float(np.median(sight.noise[sight.trusted])))
    surfaces = connected(still.cut, still.labels == 0, sight.flow, smooth)
    for surface in range(1, int(surfaces.max()) + 1):
        whole = (surfaces == surface) & (labels == 0)
        inside = whole & sight.trusted
        if not 0 < inside.sum() < _LARGEST * inside.size or _cut_off(whole):
            continue
        around = surroundings(inverse, known & ~inside, sight.flow, sight.trusted)
        if _sunk(border(inside, inverse, around), inverse, sight.key @ floor.plane):
            labels[whole] = labels.max() + 1
    return labels


def _cut_off(inside: Mask) -> bool:
    """Return whether a region touches the frame's edge: then its foot may be beyond it."""
    edges = inside[0].any() or inside[-1].any() or inside[:, 0].any() or inside[:, -1].any()
    return bool(edges)


def _sunk(edge: Border, inverse: Array, floor: Array) -> bool:
    """Return whether the ground at a region's foot is nearer than the region.

    What the ground hides, as the country behind a crest, is no thing that stands on it.
    """
    if len(edge) < _FEWEST:
        return False
    at = edge.row, edge.column
    on_floor = np.abs(edge.ratio * inverse[at] / floor[at] - 1) < _NEAR
    foot = edge.down & on_floor & (edge.row >= np.quantile(edge.row, 0.8))
    hidden = int((edge.hidden < 0).sum()) > max(2, int((edge.hidden > 0).sum()))
    return bool(foot.sum() >= _FEWEST and not hidden and np.median(edge.ratio[foot]) > _SUNK)
