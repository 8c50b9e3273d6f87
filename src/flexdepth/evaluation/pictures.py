"""Where a prediction is wrong, to look at: input, truth, prediction and error side by side."""

from math import log2, sqrt
from pathlib import Path
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from flexdepth.data.views import OrdinalPair
from flexdepth.evaluation.evaluate import Evaluation, Frame, Pairs
from flexdepth.evaluation.predictions import Predictions
from flexdepth.evaluation.protocols import ScoringProtocol
from flexdepth.evaluation.score import ALL_METRICS, ImageScore, seen_by
from flexdepth.runtime.colour import UNKNOWN, Pixels
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.origin import picture_origin, write_picture
from flexdepth.runtime.picture import limits, panels, preview

_Reals: TypeAlias = NDArray[np.float64]

_NEAR, _RIGHT, _FAR = (33, 102, 172), (247, 247, 247), (178, 24, 43)
_PROTOCOL = "protocol"

_NARROWEST = 100
"""Pictures narrower than so many pixels get no legend."""
_WIDE = 1.8
_DENSE = 0.5
_REACH = 2.5
"""Pixels: of sparse truth each point is drawn so much larger, or nobody would see it."""


def worst(evaluation: Evaluation, count: int) -> list[tuple[int, ImageScore]]:
    """Return the images with the worst first metric, the worst first, with their numbers."""
    metric = next(iter(evaluation.results))
    sign = -1 if ALL_METRICS[metric].higher_is_better else 1
    every = zip(evaluation.numbers, evaluation.scores, strict=True)
    return sorted(every, key=lambda each: -sign * each[1].values[metric])[:count]


def write_worst(
    folder: Path, evaluation: Evaluation, pairs: Pairs, predictions: Predictions, count: int
) -> None:
    """Write the worst images as NN-NAME.png; what was written here before is replaced.

    Raises:
        InputError: A file is missing or broken, or cannot be written.
    """
    origin = {_PROTOCOL: evaluation.protocol.title}
    for old in folder.glob("[0-9][0-9]-*.png"):
        if _PROTOCOL in (picture_origin(old) or {}):
            old.unlink()
    for rank, (number, score) in enumerate(worst(evaluation, count), 1):
        pair = pairs[number]
        if isinstance(pair, OrdinalPair):
            continue
        prediction = predictions.of(pair, number, evaluation.protocol.view)
        picture = sheet(Frame(number, pair, prediction), score, evaluation.protocol)
        write_picture(folder / f"{rank:02d}-{score.name}.png", picture, origin)


def sheet(frame: Frame, score: ImageScore, protocol: ScoringProtocol) -> Pixels:
    """Return an image, its truth, what was predicted of it as it was scored, and the error.

    Wide images come in two rows. Prediction and truth share their colours. Truth and error are
    shown where they count.

    Raises:
        TypeError: The set holds no depth.
    """
    if isinstance(frame.pair, OrdinalPair):
        raise TypeError("pairs of points have no truth to be drawn")
    seen = seen_by(protocol, frame.pair.truth, frame.prediction)
    depth = score.fit.depth(seen.prediction, protocol.clip, protocol.sky)
    truth = np.where(seen.valid, seen.truth, np.nan).astype(np.float64)
    ratio = np.full(truth.shape, np.nan)
    both = seen.valid & (depth > 0)
    ratio[both] = np.log2(depth[both] / truth[both])
    truth, ratio = (_enlarged(each, seen.valid) for each in (truth, ratio))
    measured = DepthMap(truth.astype(np.float32), Space.METRIC)
    predicted = DepthMap(depth.astype(np.float32), Space.METRIC)
    shown = limits(measured)
    metric, value = next(iter(score.values.items()))
    pictures = [frame.pair.image, preview(measured, shown), preview(predicted, shown), error(ratio)]
    titles = [score.name, "truth", "prediction", f"error: {ALL_METRICS[metric].title} {value:.3f}"]
    height, width = truth.shape
    if width < _WIDE * height:
        return panels(pictures, titles)
    rows = [panels(pictures[each], titles[each]) for each in (slice(2), slice(2, 4))]
    return np.concatenate(rows)


def error(ratio: _Reals) -> Pixels:
    """Return the error in colours with a legend: blue is too near, red too far, white is right.

    Args:
        ratio: The logarithm to the base 2 of predicted by true depth; NaN is unknown.
    """
    known = np.isfinite(ratio)
    strength = np.clip(np.where(known, ratio, 0), -1, 1)[..., None]
    end = np.where(strength < 0, np.array(_NEAR), np.array(_FAR))
    colours = np.array(_RIGHT) + np.abs(strength) * (end - np.array(_RIGHT))
    picture = np.rint(colours).astype(np.uint8)
    picture[~known] = UNKNOWN
    width = picture.shape[1]
    return picture if width < _NARROWEST else np.concatenate([picture, _legend(*picture.shape[:2])])


def _enlarged(values: _Reals, known: NDArray[np.bool_]) -> _Reals:
    """Return sparse values with each spread over the unknown pixels around it."""
    if known.mean() > _DENSE or not known.any():
        return values
    distance, label = cv2.distanceTransformWithLabels(
        (~known).astype(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL
    )
    of_label = np.zeros(int(label.max()) + 1, np.float64)
    of_label[label[known]] = values[known]
    return np.where(distance <= _REACH, of_label[label], np.nan)


def _legend(height: int, width: int) -> Pixels:
    size = max(10, round(min(sqrt(width * height) / 34, width / 12)))
    strip = Image.new("RGB", (width, round(3.2 * size)), (255, 255, 255))
    draw, font = ImageDraw.Draw(strip), ImageFont.load_default(size)
    margin, top, bottom = size // 2, round(0.7 * size), round(1.6 * size)
    length = max(2, width - 2 * margin)
    bar = _bar(length)
    strip.paste(Image.fromarray(np.repeat(bar, bottom - top, 0)), (margin, top))
    for factor, word, anchor in (
        (0.5, "half", "ls"),
        (1, "right", "ms"),
        (2, "twice", "rs"),
    ):
        across = margin + (log2(factor) + 1) / 2 * length
        draw.text((across, 2.8 * size), word, (40, 40, 40), font, anchor=anchor)
    return np.asarray(strip)


def _bar(length: int) -> Pixels:
    at = np.linspace(-1, 1, length)
    bar = [np.interp(at, (-1, 0, 1), each) for each in zip(_NEAR, _RIGHT, _FAR, strict=True)]
    return np.rint(np.stack(bar, axis=-1)).astype(np.uint8)[None]
