"""Rigid things that were taken for parts of a bending region, because flow happens to go on.

Where two movers touch, flow may hardly jump. What bends is then searched for pieces that one rigid
motion explains to the noise of the flow, and that are as large as a thing: so many motions as the
residuals ask for.
"""

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Kind
from flexdepth.solvers.pieces import Labels
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.region_motion import RegionMotion, explained, region_motion
from flexdepth.solvers.sight import Sight

Mask = NDArray[np.bool_]

_LARGE = 8e-3
"""The share of the frame that a rigid part has at least."""

_PART = 0.15
"""And its share of the region; no more than 1 less this is left with it."""

_EXACT = 1.0
"""What a rigid motion leaves across the lines, in standard deviations of the flow."""

_TRIED = 2
"""Pieces of a region, the largest first, whose motion is tried."""


def split(
    labels: Labels,
    motions: dict[int, RegionMotion],
    cut: Labels,
    sight: Sight,
    context: tuple[Pose, float],
) -> tuple[Labels, dict[int, RegionMotion]]:
    """Return the moving regions with rigid parts of what bends as regions of their own.

    Args:
        labels: Of the moving regions, 0 is still.
        motions: Of each.
        cut: Pieces of the frame.
        sight: What is seen.
        context: The camera's motion, and the pixels that what is still is off its epipolar lines.
    """
    labels, motions = labels.copy(), dict(motions)
    least = _LARGE * labels.size
    for label in sorted(motions):
        region = (labels == label) & sight.trusted
        if motions[label].kind is Kind.RIGID or region.sum() < 2 * least:
            continue
        part = _part(region, cut, sight, context)
        if least <= part.sum() and _PART < part.sum() / region.sum() < 1 - _PART:
            new = max(motions) + 1
            labels[np.isin(cut, np.unique(cut[part])) & (labels == label)] = new
            for each in (label, new):
                motions[each] = region_motion(sight.pixels(labels == each), *context)
    return labels, motions


def _part(region: Mask, cut: Labels, sight: Sight, context: tuple[Pose, float]) -> Mask:
    """Return the largest rigid part of a region; nothing where none is found."""
    camera, floor = context
    size = np.bincount(cut[region])
    pieces = np.flatnonzero(size >= 12)
    best = np.zeros_like(region)
    for piece in pieces[np.argsort(-size[pieces])][:_TRIED]:
        inside = region & (cut == piece)
        if inside.sum() < 60 or best[inside].any():
            continue
        motion = region_motion(sight.pixels(inside), camera, floor)
        if not _exact(motion, float(np.median(sight.noise[inside]))):
            continue
        with_it = [
            each
            for each in pieces
            if each == piece or explained(sight.pixels(region & (cut == each)), motion.pose, floor)
        ]
        part = region & np.isin(cut, with_it)
        if part.sum() > best.sum():
            best = part
    return best


def _exact(motion: RegionMotion, noise: float) -> bool:
    return motion.kind is Kind.RIGID and motion.across < _EXACT * noise
