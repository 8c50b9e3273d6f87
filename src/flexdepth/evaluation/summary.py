"""One number for a set, how sure it is, and whether two of them differ.

An interval is the percentile bootstrap's: images are drawn again with replacement, or whole
videos where the protocol averages videos. It says what other images of the same kind would have
given; frames of one video, or images of one drive, are more alike than it knows.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from flexdepth.evaluation.protocols import Averaging
from flexdepth.evaluation.score import ALL_METRICS, ImageScore, video_of
from flexdepth.runtime.errors import InputError

_Numbers: TypeAlias = NDArray[np.float64]

RESAMPLES = 2000
SEED = 0
CONFIDENCE = 0.95

_IN_MEMORY = 1 << 22


@dataclass(frozen=True)
class Estimate:
    """A metric of a set.

    Attributes:
        value: What the set gives.
        low: The lower end of its 95 % interval; None where one image or one video gives none.
        high: The upper end.
    """

    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Difference:
    """How two results on the same images differ, in one metric.

    Attributes:
        first: The mean over the images of the first.
        second: Of the second.
        apart: Second less first, with its interval.
        p: The probability that signs drawn at random make a mean difference as large.
        second_better: The share of images on which the second is better.
    """

    first: float
    second: float
    apart: Estimate
    p: float
    second_better: float


def estimates(scores: Sequence[ImageScore], averaging: Averaging) -> dict[str, Estimate]:
    """Return each metric of a set with its interval.

    Raises:
        InputError: No image has a score.
    """
    if not scores:
        raise InputError("no image has a score: none has truth where the protocol scores")
    pixels = np.array([float(each.pixels) for each in scores])
    names = [video_of(each.name) for each in scores]
    _, videos = np.unique(names, return_inverse=True)
    found = {}
    for metric in scores[0].means:
        means = np.array([each.means[metric] for each in scores]).T
        found[metric] = _estimate(_Table(metric, means, pixels, videos), averaging)
    return found


@dataclass(frozen=True, eq=False)
class _Table:
    """What one metric of every image is made of.

    Attributes:
        metric: Its name.
        means: Terms x images.
        pixels: Of each image.
        videos: The number of each image's video.
    """

    metric: str
    means: _Numbers
    pixels: _Numbers
    videos: NDArray[np.intp]

    def value(self, means: _Numbers, count: _Numbers) -> _Numbers:
        """Return the metric of means: terms x any shape."""
        return ALL_METRICS[self.metric].value(tuple(means), count)

    def per_video(self, numbers: _Numbers) -> _Numbers:
        """Return sums over the images of each video; the last axis is images, then videos."""
        belongs = self.videos[:, None] == np.arange(int(self.videos.max()) + 1)
        return np.asarray(numbers @ belongs.astype(np.float64))


def _estimate(table: _Table, averaging: Averaging) -> Estimate:
    """Return the set's number: a weighted mean over its units, then the metric of that."""
    weights, means, counts = _units(table, averaging)
    pooled = averaging is Averaging.PIXELS
    value = float(_number(table, means, weights, counts, pooled)[0])
    units = weights.size
    if units < 2:
        return Estimate(value, None, None)
    draws = np.random.default_rng(SEED)
    at_once = max(1, _IN_MEMORY // units)
    found = []
    for begin in range(0, RESAMPLES, at_once):
        count = min(at_once, RESAMPLES - begin)
        times = draws.multinomial(units, np.full(units, 1 / units), size=count)
        found.append(_number(table, means, weights * times, counts * times, pooled))
    with np.errstate(invalid="ignore"):
        low, high = np.quantile(np.concatenate(found), [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2])
    return Estimate(value, float(low), float(high))


def _units(table: _Table, averaging: Averaging) -> tuple[_Numbers, _Numbers, _Numbers]:
    """Return the weight of each image or video, what is averaged of it, and its pixels.

    What is averaged are the terms of the metric (terms x units) where pixels are pooled, and
    else the metric itself (1 x units).
    """
    each = table.value(table.means, table.pixels)[None]
    match averaging:
        case Averaging.PIXELS:
            return table.pixels, table.means, table.pixels
        case Averaging.IMAGES:
            return np.ones_like(table.pixels), each, table.pixels
        case Averaging.VIDEOS:
            frames = table.per_video(np.ones_like(table.pixels))
            return np.ones_like(frames), table.per_video(each) / frames, frames
    pixels = table.per_video(table.pixels)
    pooled = table.per_video(table.means * table.pixels) / pixels
    return pixels, table.value(pooled, pixels)[None], pixels


def _number(
    table: _Table, means: _Numbers, weights: _Numbers, counts: _Numbers, pooled: bool
) -> _Numbers:
    """Return the set's number for each row of weights."""
    rows = np.atleast_2d(weights)
    together = (means @ rows.T) / rows.sum(1)
    if not pooled:
        return np.asarray(together[0])
    return table.value(together, np.atleast_2d(counts).sum(1))


def differences(
    first: Mapping[str, Mapping[str, float]], second: Mapping[str, Mapping[str, float]]
) -> dict[str, Difference]:
    """Return, for each metric that both have, how two results differ on the images of both.

    The test is paired: an image that is hard for both does not count as a difference. Signs of
    the differences per image are drawn at random; no distribution is assumed.

    Args:
        first: The metrics of each image, by its name.
        second: Likewise.

    Raises:
        InputError: They have fewer than two images in common, or no metric.
    """
    common = [name for name in first if name in second]
    if len(common) < 2:
        raise InputError(f"a comparison needs images of both; they have {len(common)} in common")
    metrics = [m for m in first[common[0]] if m in second[common[0]]]
    if not metrics:
        raise InputError("the two results have no metric in common")
    return {
        metric: _difference(
            np.array([first[name][metric] for name in common]),
            np.array([second[name][metric] for name in common]),
            ALL_METRICS[metric].higher_is_better,
        )
        for metric in metrics
    }


def _difference(first: _Numbers, second: _Numbers, higher_is_better: bool) -> Difference:
    apart = second - first
    draws = np.random.default_rng(SEED)
    at_once = max(1, _IN_MEMORY // apart.size)
    as_large, means = 0, []
    least = abs(apart.mean()) * (1 - 1e-12)
    for begin in range(0, RESAMPLES, at_once):
        count = min(at_once, RESAMPLES - begin)
        signs = draws.choice((-1.0, 1.0), size=(count, apart.size))
        as_large += int(np.count_nonzero(np.abs(signs @ apart / apart.size) >= least))
        times = draws.multinomial(apart.size, np.full(apart.size, 1 / apart.size), size=count)
        means.append(times @ apart / apart.size)
    low, high = np.quantile(np.concatenate(means), [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2])
    better = apart > 0 if higher_is_better else apart < 0
    return Difference(
        float(first.mean()),
        float(second.mean()),
        Estimate(float(apart.mean()), float(low), float(high)),
        (1 + as_large) / (1 + RESAMPLES),
        float(better.mean()),
    )
