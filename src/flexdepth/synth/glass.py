"""What rays meet behind clear surfaces: they go straight on, coloured by what they pass."""

from dataclasses import fields, replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.synth.stage import OFFSET, Array, Hits, Stage

LAYERS = 6
"""Clear surfaces that a ray passes at most, such as three tumblers in a row."""


def passed(
    stage: Stage, first: Hits, far: Array, directions: Array, focal: float
) -> tuple[Hits, list[Hits]]:
    """Return what rays meet in the end, and the clear surfaces that they pass, nearest first.

    Rays that meet nothing behind the last of these are in none of what is met in the end.

    Args:
        stage: The scene.
        first: What the rays meet first.
        far: The ray parameter of that, for each ray.
        directions: Of each ray.
        focal: As in `Stage.hits`.
    """
    panes: list[Hits] = []
    if not stage.glazed:
        return first, panes
    gone, reached, met = far.copy(), first, []
    for _ in range(LAYERS):
        clear = stage.clear(reached.triangle)
        if not clear.any():
            break
        met.append(_picked(reached, ~clear))
        pane = _picked(reached, clear)
        panes.append(pane)
        behind = pane.point - 2 * OFFSET * pane.normal
        found, further = stage.hits(behind, directions[pane.ray], focal, gone[pane.ray])
        gone[pane.ray] += further
        reached = replace(found, ray=pane.ray[found.ray])
    return _together([*met, reached]), panes


def unblocked(
    stage: Stage, origins: Array, paths: Array, end: float = np.inf
) -> tuple[Array, Array]:
    """Return how far light can go along paths, and the share of it that clear surfaces let pass.

    The first is the ray parameter of what it cannot pass, for each path; 1e37 where nothing is.
    The second is paths by red, green, blue, or one row for all. A path ends at the ray parameter
    `end`: no clear surface beyond it counts, and light that comes so far is said to come farther.
    """
    if not stage.glazed:
        return stage.tracer.run(origins, paths, query="DISTANCE"), np.ones((1, 3), np.float32)
    found = stage.tracer.run(origins, paths, output=1)
    distance, share = found["tfar"].copy(), np.ones((len(paths), 3), np.float32)
    ray, triangle = np.arange(len(paths)), found["primID"]
    for _ in range(LAYERS):
        clear = (triangle >= 0) & stage.clear(triangle) & (distance[ray] < end)
        ray = ray[clear]
        if not ray.size:
            break
        share[ray] *= stage.passing(triangle[clear])
        gone = distance[ray] + OFFSET / np.linalg.norm(paths[ray], axis=1)
        found = stage.tracer.run(origins[ray] + gone[:, None] * paths[ray], paths[ray], output=1)
        distance[ray], triangle = gone + found["tfar"], found["primID"]
    return distance, share


def _picked(hits: Hits, which: NDArray[np.bool_]) -> Hits:
    return Hits(**{each.name: getattr(hits, each.name)[which] for each in fields(Hits)})


def _together(several: list[Hits]) -> Hits:
    return Hits(
        **{
            each.name: np.concatenate([getattr(hits, each.name) for hits in several])
            for each in fields(Hits)
        }
    )
