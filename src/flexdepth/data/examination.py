"""What the checks of a data set need to know of one pair: numbers, not pictures."""

from collections.abc import Callable
from dataclasses import dataclass
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.folder import Pair
from flexdepth.data.perpendicular import right_angles
from flexdepth.data.registration import agreement
from flexdepth.runtime.depthmap import DepthMap, Intrinsics, Space

_SKETCH = (24, 32)
_SAMPLE = 20_000

Predict = Callable[[Pair], DepthMap]
"""A model's depth of a pair's picture, for the pair's camera."""


@dataclass(frozen=True, eq=False)
class Look:
    """What is kept of one pair once it has been looked at.

    Attributes:
        name: Of the pair.
        space: Of its truth.
        size: Width and height.
        camera: If it is known.
        known: Share of pixels with depth or sky.
        largest: The largest depth; 0 where nothing is known.
        at_largest: Share of the known pixels that hold it.
        levels: How many different depths there are among 20,000 of them.
        pixels: How many pixels have depth.
        digest: Of the truth's bytes.
        ratio: Median of truth by prediction, for an assumed lens where no camera is known; NaN
            where there is none.
        correlation: Of the logarithms of truth and prediction; NaN where there is none.
        agreement: Of edges, by shift, as `registration.agreement`.
        angles: As `perpendicular.right_angles`.
        sketch: Logarithms of truth and of prediction at 24 x 32 places spread over the picture,
            NaN where unknown; None where there is no prediction.
    """

    name: str
    space: Space
    size: tuple[int, int]
    camera: Intrinsics | None
    known: float
    largest: float
    at_largest: float
    levels: int
    pixels: int
    digest: bytes
    ratio: float
    correlation: float
    agreement: NDArray[np.float64] | None
    angles: NDArray[np.float64] | None
    sketch: NDArray[np.float64] | None


def examined(pair: Pair, predict: Predict) -> Look:
    """Return what the checks need of one pair."""
    values, truth = pair.truth.values, pair.truth
    depth = values[np.isfinite(values) & (values > 0)]
    largest = float(depth.max()) if depth.size else 0.0
    ratio, correlation, sketch = _compared(pair, predict) if depth.size else (np.nan, np.nan, None)
    metric = truth.space is Space.METRIC
    return Look(
        name=pair.name,
        space=truth.space,
        size=(values.shape[1], values.shape[0]),
        camera=truth.intrinsics,
        known=float((depth.size + truth.sky.sum()) / values.size),
        largest=largest,
        at_largest=float((depth == largest).mean()) if depth.size else 0.0,
        levels=len(np.unique(depth[:: max(1, depth.size // _SAMPLE)])),
        pixels=depth.size,
        digest=blake2b(np.ascontiguousarray(values).tobytes(), digest_size=16).digest(),
        ratio=ratio,
        correlation=correlation,
        agreement=agreement(pair),
        angles=right_angles(pair) if metric else None,
        sketch=sketch,
    )


def correlated(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Return the correlation of two maps where both are known; NaN of fewer than 30 places."""
    both = np.isfinite(a) & np.isfinite(b)
    a, b = a[both], b[both]
    if len(a) < 30 or a.std() == 0 or b.std() == 0:
        return np.nan
    return float(np.corrcoef(a, b)[0, 1])


def _compared(pair: Pair, predict: Predict) -> tuple[float, float, NDArray[np.float64] | None]:
    """Return the median ratio of truth to prediction, the correlation of logarithms, a sketch."""
    truth, seen = pair.truth, predict(pair)
    logs = np.full((2, *truth.values.shape), np.nan)
    for log, each in zip(logs, (truth, seen), strict=True):
        np.log(each.values, out=log, where=each.valid & (each.values > 0))
    if truth.space is Space.AFFINE_DISPARITY:
        logs[0] *= -1
    if np.isfinite(logs).all(axis=0).sum() < 100:
        return np.nan, np.nan, None
    metric = truth.space is Space.METRIC
    ratio = float(np.exp(np.nanmedian(logs[0] - logs[1]))) if metric else np.nan
    places = np.ix_(
        *(
            ((np.arange(n) + 0.5) * side / n).astype(int)
            for n, side in zip(_SKETCH, truth.values.shape, strict=True)
        )
    )
    return ratio, correlated(*logs), np.stack([log[places] for log in logs])
