"""What a thing's own shape tells of its scale: how large it would be, and whether it is a ball."""

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.ground import Ground

Array = NDArray[np.float64]

_ROUND = 0.02
"""What a ball's points are off its sphere, in radii."""

_SHOWN = 0.75
"""The radius of a ball, in square roots of the area that it shows, is no more than this."""

_FEWEST = 30


def ball_at_rest(points: Array, size: float, floor: Ground) -> float | None:
    """Return ln s at which a ball lies on the ground; None for what is no ball.

    Where a ball touches the ground is hidden by the ball: what is seen below its outline lies
    farther than that. But its middle, at C, is its radius r above the ground: s = |g| (n·C + r).

    Args:
        points: Of a rigid thing at scale 1, n x 3.
        size: The square root of the area that it shows, at scale 1.
        floor: The ground, g = |g| n.
    """
    if len(points) < _FEWEST:
        return None
    rows = np.column_stack([2 * points, np.ones(len(points))])
    solved = np.linalg.lstsq(rows, (points**2).sum(axis=1), rcond=None)[0]
    middle, square = solved[:3], float(solved[3] + solved[:3] @ solved[:3])
    if not 0 < square < (_SHOWN * size) ** 2:
        return None
    radius = float(np.sqrt(square))
    off = np.linalg.norm(points - middle, axis=1) - radius
    deep = float(floor.normal @ middle) + radius
    if float(np.sqrt(np.mean(off**2))) > _ROUND * radius or deep <= 0:
        return None
    return float(np.log(deep * np.linalg.norm(floor.plane)))
