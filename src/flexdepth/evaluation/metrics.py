"""The error of a depth map against measured depth.

Every metric is a mean over the scored pixels, or a number made of such means. So one definition
serves both ways of summing up a set: per image, the metric is taken for each image and then
averaged; pooled, the means are taken over all pixels of all images and the metric once. The
first is what is meant where nothing is said. Arithmetic is float64.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError

_Reals: TypeAlias = NDArray[np.floating]
Numbers: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Scored:
    """Predicted and measured depth at the scored pixels of one image, all of them positive.

    Attributes:
        depth: Predicted, in the unit of `truth`. +inf (sky) is scored as it stands.
        truth: Measured.
    """

    depth: Numbers
    truth: Numbers

    def __post_init__(self) -> None:
        """Refuse what has no error.

        A negative depth would pass delta1, since its ratio lies below 1.25, and a NaN would count
        as a mere miss: both are refused.

        Raises:
            InputError: No pixel is scored, or a scored pixel holds no positive depth: an image
                without truth has no error, neither 0 nor any other.
        """
        if not self.truth.size:
            raise InputError("no pixel of this image is scored; leave the image out and report it")
        if not (np.isfinite(self.truth) & (self.truth > 0)).all():
            raise InputError(
                "a scored pixel has no measured depth; leave it out of the scored pixels"
            )
        unknown = int(np.count_nonzero(~(self.depth > 0)))
        if unknown:
            raise InputError(
                f"the prediction has no depth > 0 at {unknown} of {self.depth.size} scored pixels"
            )

    @cached_property
    def difference(self) -> Numbers:
        """Predicted less measured depth."""
        return self.depth - self.truth

    @cached_property
    def log_difference(self) -> Numbers:
        """The natural logarithm of predicted by measured depth."""
        return np.log(self.depth) - np.log(self.truth)

    @cached_property
    def ratio(self) -> Numbers:
        """The larger of the two by the smaller."""
        return np.maximum(self.depth / self.truth, self.truth / self.depth)


@dataclass(frozen=True)
class Metric:
    """One way to say how far predicted depth is from measured depth.

    Attributes:
        title: As papers write it.
        formula: With p and g for predicted and measured depth, d for ln p − ln g, E for the mean.
        terms: What is averaged over the pixels.
        value: The metric from those means and the number of pixels; any shape.
        higher_is_better: Otherwise 0 is perfect.
    """

    title: str
    formula: str
    terms: Callable[[Scored], tuple[Numbers, ...]]
    value: Callable[[tuple[Numbers, ...], Numbers], Numbers]
    higher_is_better: bool = False

    def means(self, scored: Scored) -> tuple[float, ...]:
        """Return the means over one image's pixels that the metric is made of."""
        return tuple(float(term.mean()) for term in self.terms(scored))

    def __call__(self, depth: _Reals, truth: _Reals, valid: NDArray[np.bool_]) -> float:
        """Return the metric of one image.

        Args:
            depth: Predicted depth, in the unit of `truth`.
            truth: Measured depth; read at the scored pixels only.
            valid: The scored pixels.

        Raises:
            InputError: The sizes differ, or there is nothing to score (`Scored`).
        """
        seen = scored(depth, truth, valid)
        return self.of(self.means(seen), seen.truth.size)

    def of(self, means: tuple[float, ...], count: int) -> float:
        """Return the metric from its means over so many pixels."""
        return float(
            self.value(tuple(np.array([each]) for each in means), np.array([float(count)]))[0]
        )


def scored(depth: _Reals, truth: _Reals, valid: NDArray[np.bool_]) -> Scored:
    """Return depth and truth at the scored pixels.

    Raises:
        InputError: The sizes differ, or there is nothing to score (`Scored`).
    """
    if not depth.shape == truth.shape == valid.shape:
        raise InputError(
            f"depth, truth and scored pixels must be of one size, "
            f"got {depth.shape}, {truth.shape} and {valid.shape}"
        )
    return Scored(depth[valid].astype(np.float64), truth[valid].astype(np.float64))


def _mean(means: tuple[Numbers, ...], _count: Numbers) -> Numbers:
    return means[0]


def _root(means: tuple[Numbers, ...], _count: Numbers) -> Numbers:
    return np.sqrt(means[0])


def _logs(seen: Scored) -> tuple[Numbers, ...]:
    return seen.log_difference, np.square(seen.log_difference)


def _variance(means: tuple[Numbers, ...], _count: Numbers) -> Numbers:
    return np.maximum(means[1] - np.square(means[0]), 0)


def _deviation(means: tuple[Numbers, ...], count: Numbers) -> Numbers:
    return np.sqrt(_variance(means, count))


def _half_focused(means: tuple[Numbers, ...], _count: Numbers) -> Numbers:
    return np.sqrt(np.maximum(means[1] - 0.5 * np.square(means[0]), 0))


def _sample_deviation(means: tuple[Numbers, ...], count: Numbers) -> Numbers:
    """Divide by one pixel less, as torch.std does; a single pixel has no deviation: 0."""
    return np.sqrt(_variance(means, count) * count / np.maximum(count - 1, 1))


def _share_below(threshold: float) -> Callable[[Scored], tuple[Numbers, ...]]:
    return lambda seen: ((seen.ratio < threshold).astype(np.float64),)


abs_rel = Metric(
    "AbsRel", "E[|p − g| / g]", lambda seen: (np.abs(seen.difference) / seen.truth,), _mean
)
sq_rel = Metric(
    "SqRel", "E[(p − g)² / g], m", lambda seen: (np.square(seen.difference) / seen.truth,), _mean
)
sq_rel_squared = Metric(
    "SqRel/g²",
    "E[(p − g)² / g²]; what VNL and table 5.2 of the dissertation call SqRel",
    lambda seen: (np.square(seen.difference / seen.truth),),
    _mean,
)
rmse = Metric("RMSE", "√E[(p − g)²], m", lambda seen: (np.square(seen.difference),), _root)
rmse_log = Metric("RMSElog", "√E[d²]", lambda seen: (np.square(seen.log_difference),), _root)
log10 = Metric("log10", "E[|d|] / ln 10", lambda s: (np.abs(s.log_difference) / np.log(10),), _mean)
silog = Metric(
    "SILog",
    "100 √(E[d²] − E[d]²): KITTI's server, BTS, AdaBins",
    _logs,
    lambda means, count: 100 * _deviation(means, count),
)
silog_half = Metric(
    "SILog½",
    "√(E[d²] − ½ E[d]²), not times 100: Depth Anything V2, mmsegmentation; not blind to scale",
    _logs,
    _half_focused,
)
silog_sample = Metric(
    "SILog n−1",
    "100 √((E[d²] − E[d]²) n / (n − 1)): UniDepth",
    _logs,
    lambda means, count: 100 * _sample_deviation(means, count),
)
scale_invariant = Metric(
    "SI error",
    "E[d²] − E[d]² = Σᵢⱼ (dᵢ − dⱼ)² / 2n². Eigen, Puhrsch and Fergus, NeurIPS 2014, eq. 3; "
    "eq. 1 there and (1.8) of the dissertation divide by 2n, half of it",
    _logs,
    _variance,
)
delta1 = Metric("δ1", "share of max(p/g, g/p) < 1.25", _share_below(1.25), _mean, True)
delta2 = Metric("δ2", "share of max(p/g, g/p) < 1.25²", _share_below(1.25**2), _mean, True)
delta3 = Metric("δ3", "share of max(p/g, g/p) < 1.25³", _share_below(1.25**3), _mean, True)

METRICS: Mapping[str, Metric] = MappingProxyType(
    {
        "abs_rel": abs_rel,
        "sq_rel": sq_rel,
        "sq_rel_squared": sq_rel_squared,
        "rmse": rmse,
        "rmse_log": rmse_log,
        "log10": log10,
        "silog": silog,
        "silog_half": silog_half,
        "silog_sample": silog_sample,
        "scale_invariant": scale_invariant,
        "delta1": delta1,
        "delta2": delta2,
        "delta3": delta3,
    }
)
"""The metrics of pixels by name. Those of whole maps are in `boundary.py` and `ordinal.py`."""
