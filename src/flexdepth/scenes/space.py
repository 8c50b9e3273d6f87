"""What two frames tell, in space: coloured points, and an arrow where things move by themselves."""

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.cloud import Mesh, Shown, points
from flexdepth.scenes.arrows import arrows, spread_out
from flexdepth.scenes.own_motion import own_ways
from flexdepth.scenes.pair import Solution
from flexdepth.scenes.picture import region_colours
from flexdepth.scenes.words import position

_MOST_POINTS = 500_000
"""Enough to look at on any machine."""

_CAMERA = (20, 90, 230)
"""The arrow of the camera's own way is blue."""


def cloud(solution: Solution) -> Shown:
    """Return the points that are known, with arrows of their own motion and the camera's way.

    An arrow goes from where a point is at the time of the key frame to where it is at that of
    the target, true to scale, in the axes of the key camera; it has the colour of its part.

    Raises:
        InputError: No pixel has depth.
    """
    shown = points(solution.depth, solution.key, _MOST_POINTS)
    return Shown(shown, _joined([_movers(solution), _way(solution, shown.positions)]))


def _movers(solution: Solution) -> Mesh:
    found = solution.found
    chosen = spread_out(found.moving & np.isfinite(found.depth))
    here, ways = own_ways(solution, chosen)
    return arrows(here, ways, region_colours(found)[found.labels[chosen]], here[:, 2])


def _way(solution: Solution, positions: NDArray[np.float32]) -> Mesh:
    """Return the camera's own way as an arrow, as thick as suits the nearer points."""
    way = position(solution.found)[None]
    if not len(positions):
        return arrows(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), np.uint8), np.zeros(0))
    near = np.percentile(positions[:, 2], 20, keepdims=True).astype(np.float64)
    return arrows(np.zeros((1, 3)), way, np.array([_CAMERA], np.uint8), near)


def _joined(parts: list[Mesh]) -> Mesh:
    offsets = np.cumsum([0, *(len(part.positions) for part in parts[:-1])], dtype=np.int32)
    return Mesh(
        np.concatenate([part.positions for part in parts]),
        np.concatenate([part.colours for part in parts]),
        np.concatenate(
            [part.triangles + offset for part, offset in zip(parts, offsets, strict=True)]
        ),
    )
