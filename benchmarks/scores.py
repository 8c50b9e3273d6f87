"""How models and the blind are scored on a set: three fits, from the strongest to none."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from types import MappingProxyType

import numpy as np
from blind import BEST_CONSTANT, BLIND, CONSTANT, best_constant, widened
from numpy.typing import NDArray
from samples import NEAREST, Readable, SampleSet, Score, scored_pixels

from flexdepth.data.folder import Pair
from flexdepth.evaluation.alignment import Alignment, aligned
from flexdepth.evaluation.metrics import abs_rel, delta1
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import Photo
from flexdepth.runtime.lens import Said, intrinsics

Predict = Callable[[Photo], DepthMap]


class Fit(StrEnum):
    """What of a prediction is fitted to the truth of its image before it is scored."""

    DISPARITY = "fitted in disparity"
    """Factor and offset, least squares in 1/depth."""
    MEDIAN = "median scale only"
    METRES = "metres, nothing fitted"
    """The focal length is the true one."""


_ALIGNMENTS = MappingProxyType(
    {
        Fit.DISPARITY: Alignment.LEAST_SQUARES_DISPARITY,
        Fit.MEDIAN: Alignment.MEDIAN,
        Fit.METRES: Alignment.NONE,
    }
)
_FITS: Mapping[Space, tuple[Fit, ...]] = MappingProxyType(
    {
        Space.METRIC: tuple(Fit),
        Space.SCALE: (Fit.DISPARITY, Fit.MEDIAN),
        Space.AFFINE_DISPARITY: (Fit.DISPARITY,),
        Space.AFFINE_DEPTH: (),
    }
)
"""The fits that undo what a space leaves open."""


@dataclass(frozen=True)
class Result:
    """The mean scores of one set.

    Attributes:
        frames: How many pictures it has.
        unscored: How many of them have no depth in range.
        scores: By fit, then by who predicted. Who does not allow a fit is not there.
        enlarged: By model, how many times too large its metres are: the geometric mean over the
            images of median(depth / truth). A model without metres is not there.
    """

    frames: int
    unscored: int
    scores: dict[str, dict[str, Score]]
    enlarged: dict[str, float]


@dataclass(frozen=True, eq=False)
class Seen:
    """What was predicted for one picture.

    Attributes:
        pair: The picture and its truth.
        maps: By model.
    """

    pair: Pair
    maps: Mapping[str, DepthMap]


def looked_at(files: Sequence[Readable], models: Mapping[str, Predict]) -> Iterator[Seen]:
    """Yield what the models predict for each picture, told its true focal length if known."""
    for file in files:
        pair = file.read()
        camera = pair.truth.intrinsics
        height, width = pair.image.shape[:2]
        focal = None if camera is None else camera.focal_in_diagonals(width, height)
        photo = Photo(pair.image, focal, ())
        yield Seen(pair, {name: predict(photo) for name, predict in models.items()})


def fitted(
    prediction: DepthMap, fit: Fit, truth: NDArray[np.float64], valid: NDArray[np.bool_], cap: float
) -> NDArray[np.float64]:
    """Return a prediction as it is scored; what it does not know counts as 1 mm."""
    depth = aligned(prediction, _ALIGNMENTS[fit], truth, valid, cap)
    return np.where(np.isnan(depth), NEAREST, depth)


def score_frame(seen: Seen, cap: float) -> dict[Fit, dict[str, Score]]:
    """Return the scores of models and of the blind; none where no truth is in range."""
    truth = np.nan_to_num(seen.pair.truth.values.astype(np.float64), nan=0.0, posinf=0.0)
    valid = scored_pixels(truth, cap)
    if not valid.any():
        return {}
    found: dict[Fit, dict[str, Score]] = {fit: {} for fit in Fit}
    for name, prediction in {**seen.maps, **blind(seen.pair)}.items():
        fits = (Fit.DISPARITY,) if name == CONSTANT else _FITS[prediction.space]
        for fit in fits:
            depth = fitted(prediction, fit, truth, valid, cap)
            found[fit][name] = Score(abs_rel(depth, truth, valid), delta1(depth, truth, valid))
    level = np.full(truth.shape, best_constant(truth[valid]))
    best = Score(abs_rel(level, truth, valid), delta1(level, truth, valid))
    for scores in found.values():
        scores[BEST_CONSTANT] = best
    return found


def blind(pair: Pair) -> dict[str, DepthMap]:
    """Return the predictions of those who never look at the picture.

    Where nobody says the camera, the usual one is assumed, and there are no metres.
    """
    height, width = pair.image.shape[:2]
    camera = pair.truth.intrinsics or intrinsics(width, height, None, Said())
    maps = {name: widened(make(height, camera), width) for name, make in BLIND.items()}
    if camera.source is FocalSource.ASSUMED:
        maps = {name: replace(each, space=Space.SCALE) for name, each in maps.items()}
    return maps


def enlarged(seen: Seen, cap: float) -> dict[str, float]:
    """Return median(depth / truth) of each model whose map is in metres."""
    truth = seen.pair.truth.values
    inside = scored_pixels(np.nan_to_num(truth, nan=0.0).astype(np.float64), cap)
    found = {}
    for name, depth_map in seen.maps.items():
        valid = inside & depth_map.valid
        if depth_map.space is Space.METRIC and valid.any():
            found[name] = float(np.median(depth_map.depth[valid] / truth[valid]))
    return found


def score_set(sample_set: SampleSet, pictures: Iterator[Seen]) -> Result:
    """Return the mean scores of a set: each picture counts the same, however many pixels it has.

    Raises:
        InputError: No picture has depth in range.
    """
    scored, sizes, frames = [], [], 0
    for seen in pictures:
        frames += 1
        sizes.append(enlarged(seen, sample_set.cap))
        if scores := score_frame(seen, sample_set.cap):
            scored.append(scores)
    if not scored:
        raise InputError(f"{sample_set.name}: no frame has measured depth below the cap")
    means = {
        str(fit): {who: _mean([each[fit][who] for each in scored]) for who in of_one}
        for fit, of_one in scored[0].items()
    }
    logs = {who: [np.log(each[who]) for each in sizes if who in each] for who in sizes[0]}
    return Result(
        frames,
        frames - len(scored),
        means,
        {who: float(np.exp(np.mean(each))) for who, each in logs.items()},
    )


def _mean(scores: Sequence[Score]) -> Score:
    return Score(
        float(np.mean([score.abs_rel for score in scores])),
        float(np.mean([score.delta1 for score in scores])),
    )
