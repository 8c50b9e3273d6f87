"""How a depth is scored against the truth of a pair, and how scores are told.

Scored are the pixels that both frames show, without the sky and without static pixels whose
parallax is below half a pixel. Depth has one scale for the pair: the median of truth / depth over
the scored pixels that have one. A scored pixel without depth stands at the median depth.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pairs import FLEXIBLE, RIGID, STATIC, Pair, parallax

LEAST_PARALLAX = 0.5
GROUPS = ("all", "static", "rigid", "flexible", "moving")
Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Score:
    """AbsRel, delta1 and the share of pixels with a depth; of one group of pixels."""

    abs_rel: float
    delta1: float
    coverage: float


Scores = dict[str, Score]


def scored(truth: Pair) -> Mask:
    """Return the pixels that are scored."""
    seen = np.isfinite(truth.flow).all(axis=-1) & ~truth.occluded & np.isfinite(truth.depth)
    still = truth.kind == STATIC
    return np.asarray(seen & (~still | (parallax(truth) >= LEAST_PARALLAX)))


def groups(truth: Pair) -> dict[str, Mask]:
    """Return the scored pixels of each group."""
    counts = scored(truth)
    return {
        "all": counts,
        "static": counts & (truth.kind == STATIC),
        "rigid": counts & (truth.kind == RIGID),
        "flexible": counts & (truth.kind == FLEXIBLE),
        "moving": counts & (truth.kind != STATIC),
    }


def scores(depth: Array, truth: Pair) -> Scores:
    """Return the score of each group that the pair has.

    Args:
        depth: Height x width, up to one factor; what is not finite and above 0 is no depth.
        truth: Of the same pair.
    """
    parts = groups(truth)
    said = np.isfinite(depth) & (depth > 0)
    both = parts["all"] & said
    scale = np.median(truth.depth[both] / depth[both]) if both.any() else 1.0
    scaled = np.where(said, depth, np.nan) * scale
    middle = np.median(scaled[both]) if both.any() else np.median(truth.depth[parts["all"]])
    full = np.where(said, scaled, middle)
    with np.errstate(invalid="ignore", divide="ignore"):
        off = np.abs(full - truth.depth) / truth.depth
        near = np.maximum(full / truth.depth, truth.depth / full) < 1.25
    return {
        name: Score(float(off[part].mean()), float(near[part].mean()), float(said[part].mean()))
        for name, part in parts.items()
        if part.any()
    }


def mean(of_pairs: Sequence[Scores]) -> Scores:
    """Return the mean of each group over the pairs that have it."""
    means = {}
    for group in GROUPS:
        having = [one[group] for one in of_pairs if group in one]
        if having:
            rows = np.array([[s.abs_rel, s.delta1, s.coverage] for s in having])
            means[group] = Score(*map(float, rows.mean(0)))
    return means
