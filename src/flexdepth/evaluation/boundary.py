"""How sharp the edges of a depth map are, and whether they lie where the true ones do.

Two neighbours make an edge where one is farther than the other by more than a factor. Counted in
four directions (the farther one to the left, above, to the right, below), so an edge that has
near and far the wrong way round is a miss. A factor on the whole map changes nothing.

References:
    Bochkovskii et al., Depth Pro, ICLR 2025, section 3.4: thresholds 1.05 to 1.25, the ratio
    times 4 directions averaged, thresholds weighted by their size. Ours differs in two things:
    pairs that hold an unknown pixel are not counted, and an image without any true edge has no
    score, where the published code gives 0.
"""

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError

_Reals: TypeAlias = NDArray[np.floating]
_Mask: TypeAlias = NDArray[np.bool_]

THRESHOLDS = np.linspace(1.05, 1.25, 10)
"""How many times farther than its neighbour a pixel must be."""

MATTE = 0.1
"""A pixel of a matte is foreground where it is more opaque than this."""


def boundary_f1(depth: _Reals, truth: _Reals, valid: _Mask) -> float:
    """Return how well the edges of a depth map agree with those of a dense true one: 1 is perfect.

    Precision and recall are taken in each direction and averaged, their harmonic mean is taken at
    each threshold, and those are averaged with the thresholds as weights.

    Args:
        depth: Predicted depth, up to a factor; positive where valid.
        truth: Measured depth, known almost everywhere: edges are sought between neighbours.
        valid: The pixels that count.

    Raises:
        InputError: The sizes differ, a valid pixel holds no positive depth, or the truth has no
            edge at all.
    """
    _check(depth, truth, valid)
    pairs = list(zip(_ratios(depth, valid), _ratios(truth, valid), strict=True))
    if not has_edge(truth, valid):
        raise InputError("the truth has no edge; leave the image out and report it")
    return float(np.average([_f1(pairs, each) for each in THRESHOLDS], weights=THRESHOLDS))


def has_edge(truth: _Reals, valid: _Mask) -> bool:
    """Return whether a true map has an edge at the lowest threshold."""
    return any((ratio > THRESHOLDS[0]).any() for ratio in _ratios(truth, valid))


def boundary_recall(depth: _Reals, opacity: _Reals) -> float:
    """Return how much of a matte's outline is an edge in the depth map: 1 is perfect.

    What is opaque is near. The prediction's edges are thinned first: of edges that follow one
    another across a row or a column only the strongest counts.

    Args:
        depth: Predicted depth, up to a factor; positive.
        opacity: Of the foreground, 0 to 1.

    Raises:
        InputError: The sizes differ, a pixel holds no positive depth, or the matte has no outline.
    """
    everywhere = np.ones(depth.shape, dtype=bool)
    _check(depth, np.ones(opacity.shape), everywhere)
    outlines = list(_outlines(opacity > MATTE))
    if not any(outline.any() for outline in outlines):
        raise InputError("the matte has no outline; leave the image out and report it")
    ratios = list(_ratios(depth, everywhere))
    recalls = [
        np.mean([_share(_thinned(r, each), o) for r, o in zip(ratios, outlines, strict=True)])
        for each in THRESHOLDS
    ]
    return float(np.average(recalls, weights=THRESHOLDS))


def _check(depth: _Reals, truth: _Reals, valid: _Mask) -> None:
    if not depth.shape == truth.shape == valid.shape:
        raise InputError(
            f"depth, truth and scored pixels must be of one size, "
            f"got {depth.shape}, {truth.shape} and {valid.shape}"
        )
    for name, values in (("prediction", depth), ("truth", truth)):
        unknown = int(np.count_nonzero(~(values[valid] > 0)))
        if unknown:
            raise InputError(
                f"the {name} has no depth > 0 at {unknown} of {np.count_nonzero(valid)} "
                f"scored pixels"
            )


def _ratios(depth: _Reals, valid: _Mask) -> Iterator[NDArray[np.float64]]:
    """Yield, for each of four directions, by which factor the neighbour there is farther.

    The arrays lie along rows: those up and down are transposed. 0 where one of the two is unknown.
    """
    known = np.where(valid, depth, np.nan).astype(np.float64)
    for turned in (known, known.T):
        for near, far in ((turned[:, :-1], turned[:, 1:]), (turned[:, 1:], turned[:, :-1])):
            both = np.isfinite(near) & np.isfinite(far)
            yield np.where(both, far, 0.0) / np.where(both, near, 1.0)


def _outlines(foreground: _Mask) -> Iterator[_Mask]:
    """Yield, for each direction of `_ratios`, where foreground has background there."""
    for turned in (foreground, foreground.T):
        for near, far in ((turned[:, :-1], turned[:, 1:]), (turned[:, 1:], turned[:, :-1])):
            yield near & ~far


def _f1(pairs: list[tuple[NDArray[np.float64], NDArray[np.float64]]], threshold: float) -> float:
    edges = [(seen > threshold, true > threshold) for seen, true in pairs]
    precision = np.mean([_share(true, seen) for seen, true in edges])
    recall = np.mean([_share(seen, true) for seen, true in edges])
    both = float(precision + recall)
    return float(2 * precision * recall / both) if both else 0.0


def _share(hits: _Mask, of: _Mask) -> float:
    """Return which part of `of` is hit; 0 where there is nothing to hit."""
    return int(np.count_nonzero(hits & of)) / max(int(np.count_nonzero(of)), 1)


def _thinned(ratio: NDArray[np.float64], threshold: float) -> _Mask:
    """Return the strongest edge of each unbroken run of edges along a row, the first of equals."""
    edges = ratio > threshold
    thin = np.zeros_like(edges)
    if not edges.any():
        return thin
    rows, columns = np.nonzero(edges)
    begins = np.flatnonzero((np.diff(rows, prepend=-1) != 0) | (np.diff(columns, prepend=-9) != 1))
    run = np.repeat(np.arange(begins.size), np.diff(begins, append=rows.size))
    strength = ratio[rows, columns]
    order = np.lexsort((columns, -strength, run))
    best = order[begins]
    thin[rows[best], columns[best]] = True
    return thin
