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

from flexdepth.synth.motion import Footing

LEAST_PARALLAX = 0.5
GROUPS = ("all", "static", "rigid", "flexible", "moving", *(each.value for each in Footing))
SHAPES = {"rigid shape": "rigid", "flexible shape": "flexible"}
"""A mover scored after a scale of its own: what is left of its error without its relative scale."""

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
    moving, footing = counts & (truth.kind != STATIC), truth.footing[truth.kind]
    return {
        "all": counts,
        "static": counts & (truth.kind == STATIC),
        "rigid": counts & (truth.kind == RIGID),
        "flexible": counts & (truth.kind == FLEXIBLE),
        "moving": moving,
        **{each.value: moving & (footing == code) for code, each in enumerate(Footing)},
    }


def scores(depth: Array, truth: Pair) -> Scores:
    """Return the score of each group that the pair has.

    Args:
        depth: Height x width, up to one factor; what is not finite and above 0 is no depth.
        truth: Of the same pair.
    """
    parts = groups(truth)
    together = _scaled(depth, truth.depth, parts["all"])
    found = {
        name: _score(together, truth.depth, depth, part)
        for name, part in parts.items()
        if part.any()
    }
    for name, group in SHAPES.items():
        part = parts[group]
        if part.any():
            alone = _scaled(depth, truth.depth, part)
            found[name] = _score(alone, truth.depth, depth, part)
    return found


def _known(depth: Array) -> Mask:
    return np.asarray(np.isfinite(depth) & (depth > 0))


def _scaled(depth: Array, truth: Array, part: Mask) -> Array:
    """Return the depth times the median ratio over a part, filled with its median there."""
    both = part & _known(depth)
    if not both.any():
        return np.full_like(truth, np.median(truth[part]))
    scaled = depth * np.median(truth[both] / depth[both])
    return np.where(_known(depth), scaled, np.median(scaled[both]))


def _score(scaled: Array, truth: Array, depth: Array, part: Mask) -> Score:
    said, true = scaled[part], truth[part]
    return Score(
        float((np.abs(said - true) / true).mean()),
        float((np.maximum(said / true, true / said) < 1.25).mean()),
        float(_known(depth)[part].mean()),
    )


def mean(of_pairs: Sequence[Scores]) -> Scores:
    """Return the mean of each group over the pairs that have it."""
    means = {}
    for group in (*GROUPS, *SHAPES):
        having = [one[group] for one in of_pairs if group in one]
        if having:
            rows = np.array([[s.abs_rel, s.delta1, s.coverage] for s in having])
            means[group] = Score(*map(float, rows.mean(0)))
    return means
