"""What a region's border tells of its depth beside that of the static world around it."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_WAYS = ((1, 0), (-1, 0), (0, 1), (0, -1))
"""Down, up, right, left."""

_REACH = 10
_FEWEST = 3
_INSIDE = 3
"""Samples across a border: on the outside, how many at least of them, and on the inside."""

_TOUCHES = 12
"""Pairs of pixels, up to two apart, that make two regions touch."""

_SAME_MOTION = 4.0
"""Pixels between flows, in frames of 160 x 120, below which motion goes on across a border."""

_SAME_PART = 2.0
"""And likewise between a bending thing and a rigid part of it."""

_JOINED = 0.3
"""The share of the pairs across which motion goes on, for two regions to be parts of one body."""

_LEAP = 0.25
"""A relative change of inverse depth from one sample to the next that ends the surface."""


@dataclass(frozen=True, eq=False)
class Border:
    """Pixels at the inner border of a region, beside the static world; n of them.

    Attributes:
        row: Of each.
        column: Likewise.
        down: Whether the static world is below.
        ratio: Inverse depth of the static surface, drawn out to the border, over the region's.
        slope: Relative change of the static inverse depth from one pixel to the next outward;
            above 0 on ground that is seen below the region.
        jump: Pixels of flow between the region and the static world.
        hidden: How many of the static samples the target hides, less those of the region.
        lower: Rows of all of the region's pixels with none of it below, not n: whatever is there.
    """

    row: NDArray[np.intp]
    column: NDArray[np.intp]
    down: Mask
    ratio: Array
    slope: Array
    jump: Array
    hidden: Array
    lower: NDArray[np.intp]

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.ratio)


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Maps, height x width, that borders are read from.

    Attributes:
        inverse_depth: Finite where `static`.
        static: Where the static world has a depth.
        flow: x 2, pixels, finite.
        trusted: Where flow is to be trusted: not hidden in the target.
        unit: Pixels between samples: 1 in frames of 160 x 120.
    """

    inverse_depth: Array
    static: Mask
    flow: Array
    trusted: Mask
    unit: int


def surroundings(inverse_depth: Array, static: Mask, flow: Array, trusted: Mask) -> Surroundings:
    """Return the maps with the static inverse depth smoothed within itself."""
    unit = _unit(static.size)
    weight = static.astype(np.float64)
    filled = np.where(static, inverse_depth, 0.0)
    size = (2 * unit + 1, 2 * unit + 1)
    smooth = cv2.blur(filled, size) / np.maximum(cv2.blur(weight, size), 1e-9)
    near = np.abs(smooth - filled) < 0.1 * np.abs(filled)
    return Surroundings(np.where(near, smooth, filled), static, flow, trusted, unit)


def border(
    inside: Mask, inverse_depth: Array, around: Surroundings, others: Mask | None = None
) -> Border:
    """Return what is seen along the border of a region.

    Args:
        inside: The region.
        inverse_depth: Height x width; the region's own.
        around: The static world.
        others: Where other things move: what lies beyond them is not beside the region.
    """
    passed = inside if others is None else inside | others
    parts = [_one_way((inside, passed), inverse_depth, around, way) for way in _WAYS]
    joined = [np.concatenate(each) for each in zip(*parts, strict=True)]
    row, column, down, ratio, slope, jump, hidden = joined
    lower = np.nonzero(inside & ~np.pad(inside, ((0, 1), (0, 0)))[1:])[0]
    return Border(
        row.astype(np.intp), column.astype(np.intp), down > 0, ratio, slope, jump, hidden, lower
    )


def nearness_beside(inside: Mask, own: Array, others: Array, around: Surroundings) -> float | None:
    """Return the median of others' inverse depth over a region's own where motion goes on.

    None where the two do not touch, or mostly move differently: one may pass before the other.

    Args:
        inside: The region.
        own: Height x width: its inverse depth.
        others: Likewise, of what it may touch; NaN elsewhere.
        around: Whose flow tells how the two move.
    """
    here, there = _pairs(inside & (own > 0), np.isfinite(others))
    joined = _jumps(here, there, around.flow) < _SAME_MOTION * around.unit
    if len(joined) < _TOUCHES or joined.mean() < _JOINED:
        return None
    return float(np.median((others[there] / own[here])[joined]))


def goes_on(first: Mask, second: Mask, flow: Array) -> bool:
    """Return whether motion goes on from one region to another, as it does within a body."""
    same = _jumps(*_pairs(first, second), flow) < _SAME_PART * _unit(first.size)
    return len(same) > 0 and bool(same.mean() >= _JOINED)


def grown(region: Mask) -> Mask:
    """Return a region with all that is up to two pixels from it."""
    return np.asarray(cv2.dilate(region.astype(np.uint8), np.ones((5, 5), np.uint8))).astype(bool)


Places = tuple[NDArray[np.intp], NDArray[np.intp]]
"""Rows and columns."""


def _pairs(first: Mask, second: Mask) -> tuple[Places, Places]:
    """Return the pairs of pixels, up to two apart in a row or a column, of two regions."""
    height, width = first.shape
    row, column = np.nonzero(first)
    here, there = [], []
    for down, right in _WAYS:
        for step in (1, 2):
            r, c = row + step * down, column + step * right
            touches = (r >= 0) & (r < height) & (c >= 0) & (c < width)
            touches[touches] = second[r[touches], c[touches]]
            here.append((row[touches], column[touches]))
            there.append((r[touches], c[touches]))
    rows, columns = (np.concatenate(each) for each in zip(*here, strict=True))
    other_rows, other_columns = (np.concatenate(each) for each in zip(*there, strict=True))
    return (rows, columns), (other_rows, other_columns)


def _jumps(here: Places, there: Places, flow: Array) -> Array:
    return np.asarray(np.linalg.norm(flow[there] - flow[here], axis=-1))


def _unit(pixels: int) -> int:
    """Return how many pixels of a frame of so many are one in frames of 160 x 120."""
    return max(1, round(float(np.sqrt(pixels / 19200))))


def _one_way(
    masks: tuple[Mask, Mask], inverse_depth: Array, around: Surroundings, way: tuple[int, int]
) -> tuple[Array, ...]:
    """Return what is seen on one side; `masks` are the region, and what the border is not at."""
    inside, passed = masks
    height, width = inside.shape
    beyond = inside & ~np.roll(passed, (-way[0], -way[1]), (0, 1))
    beyond[0 if way[0] < 0 else -1, :] &= way[0] == 0
    beyond[:, 0 if way[1] < 0 else -1] &= way[1] == 0
    row, column = np.nonzero(beyond)

    def at(steps: NDArray[np.signedinteger]) -> tuple[NDArray[np.intp], NDArray[np.intp], Mask]:
        r = row[:, None] + way[0] * steps
        c = column[:, None] + way[1] * steps
        good = (r >= 0) & (r < height) & (c >= 0) & (c < width)
        return np.clip(r, 0, height - 1), np.clip(c, 0, width - 1), good

    steps = around.unit * np.arange(1, _REACH + 1)
    r, c, good = at(steps)
    outside, smooth_slope, enough, first = _drawn_out(
        around.inverse_depth[r, c], good & around.static[r, c], steps.astype(np.float64)
    )
    ri, ci, within = at(-around.unit * np.arange(_INSIDE))
    within &= inside[ri, ci]
    own = _at_the_rim(inverse_depth[ri, ci], within)
    pick = np.arange(len(row))
    jump = np.linalg.norm(
        around.flow[r[pick, first], c[pick, first]] - around.flow[row, column], axis=1
    )
    hidden = (good & ~around.trusted[r, c] & ~inside[r, c])[:, :5].sum(1) - (
        within & ~around.trusted[ri, ci]
    ).sum(1)
    keep = enough & (own > 0)
    down = np.full(len(row), float(way == (1, 0)))
    values = (row, column, down, outside / np.where(own > 0, own, 1), smooth_slope, jump, hidden)
    return tuple(np.asarray(each, np.float64)[keep] for each in values)


def _drawn_out(
    values: Array, good: Mask, steps: Array
) -> tuple[Array, Array, Mask, NDArray[np.intp]]:
    """Return straight lines through samples, drawn out to step 0, and their relative slopes.

    A line ends where the samples leap: another surface begins there. Planes have inverse depth
    that is straight along every line of the picture.
    """
    first = np.argmax(good, axis=1)
    reached = good.any(axis=1)
    start = values[np.arange(len(values)), first]
    steady = good.copy()
    last = start.copy()
    alive = reached.copy()
    for k in range(values.shape[1]):
        here = good[:, k]
        leap = here & (np.abs(values[:, k] - last) > _LEAP * np.abs(last))
        alive &= ~leap
        steady[:, k] &= alive
        last = np.where(here & alive, values[:, k], last)
    weight = steady.astype(np.float64)
    count = weight.sum(1)
    safe = np.maximum(count, 1)
    values = np.where(steady, values, 0.0)
    middle, mean = (weight * steps).sum(1) / safe, (weight * values).sum(1) / safe
    spread = (weight * (steps - middle[:, None]) ** 2).sum(1)
    lean = (weight * (steps - middle[:, None]) * values).sum(1) / np.maximum(spread, 1e-12)
    return mean - lean * middle, lean / np.maximum(mean, 1e-12), count >= _FEWEST, first


def _at_the_rim(values: Array, good: Mask) -> Array:
    """Return the inverse depth at the very rim, half a pixel outside of the first value.

    A round thing recedes there with the root of the distance: from .5 and 2.5 pixels inside, .8
    of their difference remains. Where the first leaps away from the last, flow was smoothed over
    the rim and tells of neither side: then it is the last.
    """
    last = values[np.arange(len(values)), np.maximum(good.sum(axis=1) - 1, 0)]
    first = values[:, 0]
    leaps = np.abs(first - last) > _LEAP * np.abs(last)
    rim = first - 0.8 * np.where(leaps, 0.0, last - first)
    return np.where(good.any(axis=1), np.where(leaps, last, rim), 0.0)
