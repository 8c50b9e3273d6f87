"""The score of one image under one protocol."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.views import OrdinalPair
from flexdepth.evaluation.alignment import (
    Alignment,
    Fit,
    Points,
    check_alignment,
    fitted,
    scored_points,
)
from flexdepth.evaluation.boundary import boundary_f1, has_edge
from flexdepth.evaluation.lines import Line, Moments
from flexdepth.evaluation.metrics import METRICS, Metric, Scored
from flexdepth.evaluation.ordinal import OrdinalPairs, whdr
from flexdepth.evaluation.protocols import ScoringProtocol, scored_pixels, truth_of
from flexdepth.evaluation.resize import at_size_of_truth
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError

BOUNDARY_F1, WHDR = "boundary_f1", "whdr"

ALL_METRICS: Mapping[str, Metric] = {
    **METRICS,
    BOUNDARY_F1: Metric(
        "boundary F1",
        "Depth Pro's, of the edges of depth",
        terms=lambda _seen: (),
        value=lambda means, _count: means[0],
        higher_is_better=True,
    ),
    WHDR: Metric(
        "WHDR",
        "share of the images whose pair of points is in the wrong order",
        terms=lambda _seen: (),
        value=lambda means, _count: means[0],
    ),
}
"""Every metric that a protocol may name; those that are not of single pixels have no terms."""

_MOST_POINTS = 1 << 15
"""Of one frame, so many pixels at most take part in the fit of a video by median or by rounds; a
least-squares fit takes all."""

_SUMMED = (Alignment.SCALE, Alignment.LEAST_SQUARES, Alignment.LEAST_SQUARES_DISPARITY)


@dataclass(frozen=True)
class ImageScore:
    """What one image came to.

    Attributes:
        name: Of the image in its set.
        pixels: How many were scored.
        means: What each metric is made of, by its name (`Metric.means`).
        fit: How the prediction was fitted.
    """

    name: str
    pixels: int
    means: Mapping[str, tuple[float, ...]]
    fit: Fit

    @property
    def values(self) -> dict[str, float]:
        """The metrics of this image."""
        return {name: ALL_METRICS[name].of(each, self.pixels) for name, each in self.means.items()}


@dataclass(frozen=True)
class LeftOut:
    """An image that has no score, and why."""

    name: str
    reason: str


@dataclass(frozen=True, eq=False)
class Seen:
    """A prediction beside its truth, as one protocol has them.

    Attributes:
        prediction: At the truth's size.
        truth: Depth in metres, NaN where unknown.
        valid: The scored pixels.
    """

    prediction: DepthMap
    truth: NDArray[np.float32]
    valid: NDArray[np.bool_]

    def only_scored(self) -> "Seen":
        """Return the scored pixels alone, in one row, and nothing of how sure they are."""
        values = self.prediction.values[self.valid][None]
        row = self.truth[self.valid][None]
        scored = replace(self.prediction, values=values, spread=None)
        return Seen(scored, row, np.ones(row.shape, bool))


def video_of(name: str) -> str:
    """Return the video that a frame belongs to: its name without its last number.

    `alley_1_frame_0001` belongs to `alley_1_frame`, and `0001` to the one video of its set.
    """
    found = re.fullmatch(r"(.*?)[\W_]*\d+\D*", name)
    return found[1] if found else name


def seen_by(protocol: ScoringProtocol, truth: DepthMap, prediction: DepthMap) -> Seen:
    """Return the prediction beside its truth.

    Raises:
        InputError: The alignment is too weak for the prediction or for the truth, the protocol is
            for images of another size, or the prediction's shape cannot be that of the image.
    """
    check_alignment(prediction.space, protocol.alignment)
    if truth.space is not Space.METRIC:
        # What undoes a factor of the prediction undoes one of the truth.
        check_alignment(truth.space, protocol.alignment)
    depth = truth_of(truth, protocol)
    valid = scored_pixels(depth, protocol)
    height, width = depth.shape
    return Seen(at_size_of_truth(prediction, (height, width), protocol), depth, valid)


def points_of(seen: Seen, protocol: ScoringProtocol) -> Points:
    """Return what the protocol fits a line to, of one image.

    Raises:
        InputError: The protocol's alignment is too weak for the prediction.
    """
    return scored_points(
        seen.prediction, protocol.alignment, seen.truth, seen.valid, protocol.least_disparity
    )


def video_fit(frames: Iterable[Points], protocol: ScoringProtocol) -> Fit | None:
    """Return one fit to the frames of a video, of which none is kept; None where there is nothing.

    Raises:
        InputError: No factor fits.
    """
    alignment, least = protocol.alignment, protocol.least_disparity
    if alignment not in _SUMMED:
        kept = [_thinned(frame) for frame in frames if frame.x.size]
        if not kept:
            return None
        x, y = (
            np.concatenate(each)
            for each in ([frame.x for frame in kept], [frame.y for frame in kept])
        )
        return fitted(Points(x, y), alignment, least)
    sums = [Moments.of(frame.x, frame.y) for frame in frames if frame.x.size]
    if not sums:
        return None
    whole = sum(sums[1:], start=sums[0])
    line = whole.scale() if alignment is Alignment.SCALE else whole.least_squares()
    return Fit(line, alignment is Alignment.LEAST_SQUARES_DISPARITY, least)


def image_score(
    name: str, seen: Seen, protocol: ScoringProtocol, fit: Fit | None = None
) -> ImageScore | LeftOut:
    """Return the score of one image, or why it has none.

    Args:
        name: Of the image.
        seen: What `seen_by` gave.
        protocol: How to score.
        fit: Of the image's video; None fits the image.

    Raises:
        InputError: The prediction cannot be scored: its alignment is too weak, or it is unknown
            or not positive where the truth is known.
    """
    if not seen.valid.any():
        return LeftOut(name, "no pixel has truth where the protocol scores")
    if BOUNDARY_F1 in protocol.metrics and not has_edge(seen.truth, seen.valid):
        return LeftOut(name, "the truth has no edge where the protocol scores")
    try:
        row = seen.only_scored()
        chosen = fit or fitted(
            points_of(row, protocol), protocol.alignment, protocol.least_disparity
        )
        pixels = _pixels(row, protocol, chosen)
        means = {m: METRICS[m].means(pixels) for m in protocol.metrics if m in METRICS}
        if BOUNDARY_F1 in protocol.metrics:
            depth = chosen.depth(seen.prediction, protocol.clip, protocol.sky)
            means[BOUNDARY_F1] = (boundary_f1(depth, seen.truth, seen.valid),)
    except InputError as error:
        raise InputError(f"{name}: {error}") from error
    return ImageScore(name, pixels.truth.size, means, chosen)


def ordinal_score(pair: OrdinalPair, prediction: DepthMap, protocol: ScoringProtocol) -> ImageScore:
    """Return 1 for a pair of points in the wrong order, and 0 for one in the right order.

    Raises:
        InputError: The prediction has no depth at a point.
    """
    height, width = pair.image.shape[:2]
    seen = at_size_of_truth(prediction, (height, width), protocol)
    disparity = prediction.space is Space.AFFINE_DISPARITY
    farther, nearer = (np.array([each[::-1]]) for each in (pair.farther, pair.nearer))
    points = OrdinalPairs(farther, nearer, np.ones(1))
    try:
        wrong = whdr(-seen.values if disparity else seen.values, points)
    except InputError as error:
        raise InputError(f"{pair.name}: {error}") from error
    return ImageScore(pair.name, 1, {WHDR: (wrong,)}, Fit(Line(1.0), disparity))


def _pixels(row: Seen, protocol: ScoringProtocol, fit: Fit) -> Scored:
    depth = fit.depth(row.prediction, protocol.clip, protocol.sky)
    if protocol.unknown is not None:
        depth = np.where(np.isnan(depth), protocol.unknown, depth)
    return Scored(depth[0], row.truth[0].astype(np.float64))


def _thinned(points: Points) -> Points:
    every = -(-points.x.size // _MOST_POINTS)
    return Points(points.x[::every], points.y[::every])
