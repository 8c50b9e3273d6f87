"""Scoring predictions on a set: images one after another, in memory that does not grow with them.

What stays of an image are the few numbers of its score. A protocol that fits a line to a whole
video goes over the set twice.
"""

import hashlib
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from itertools import groupby
from typing import Protocol, runtime_checkable

import numpy as np

from flexdepth.data.views import OrdinalPair
from flexdepth.evaluation.alignment import Fit
from flexdepth.evaluation.predictions import Image, Predictions
from flexdepth.evaluation.protocols import Scope, ScoringProtocol
from flexdepth.evaluation.score import (
    WHDR,
    ImageScore,
    LeftOut,
    Seen,
    image_score,
    ordinal_score,
    points_of,
    seen_by,
    video_fit,
    video_of,
)
from flexdepth.evaluation.summary import Estimate, estimates
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.errors import InputError

_AHEAD = 4
_READERS = 2

Watch = Callable[[int], None]
"""Is told how many images are done."""


@runtime_checkable
class Pairs(Protocol):
    """The images of a set with their truth, by number."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> Image: ...


@dataclass(frozen=True, eq=False)
class Frame:
    """An image of a set beside its prediction.

    Attributes:
        number: Of the image in its set.
        pair: The image and what is known of it.
        prediction: As it was made, at its own size.
    """

    number: int
    pair: Image
    prediction: DepthMap


@dataclass(frozen=True)
class Evaluation:
    """What a set came to under one protocol.

    Attributes:
        protocol: How it was scored.
        numbers: Of the scored images in the set.
        scores: Of the same images.
        left_out: The images that have no score, with the reason.
        results: Each metric with its interval.
        truth: A digest of all truth that was read, to know the same truth again.
        sizes: How many predictions there were of which width, height and space.
    """

    protocol: ScoringProtocol
    numbers: tuple[int, ...]
    scores: tuple[ImageScore, ...]
    left_out: tuple[LeftOut, ...]
    results: dict[str, Estimate]
    truth: str
    sizes: dict[str, int]


def frames(
    pairs: Pairs, predictions: Predictions, protocol: ScoringProtocol, readers: int = _READERS
) -> Iterator[Frame]:
    """Yield the images that a protocol scores with their predictions, read a little ahead.

    Raises:
        InputError: A file is missing or broken, or a prediction cannot be made.
    """
    selected = _selection(protocol)

    def read(number: int) -> Frame | None:
        pair = pairs[number]
        if not selected(pair.name):
            return None
        return Frame(number, pair, predictions.of(pair, number, protocol.view))

    # Which frames come first in a video shows in their order, so one reader reads those.
    count = 1 if protocol.frames is not None else readers
    found = (frame for frame in _ahead(read, len(pairs), count) if frame is not None)
    yield from found


def evaluate(
    pairs: Pairs, predictions: Predictions, protocol: ScoringProtocol, watch: Watch
) -> Evaluation:
    """Return the scores of a set.

    Raises:
        InputError: The set is empty, no image has a score, the alignment is too weak for the
            predictions, or a file is missing or broken.
    """
    (found,) = evaluate_all(pairs, predictions, (protocol,), watch)
    return found


def evaluate_all(
    pairs: Pairs,
    predictions: Predictions,
    protocols: Sequence[ScoringProtocol],
    watch: Watch,
) -> list[Evaluation]:
    """Return the scores of a set under several protocols that select and show the same images.

    Raises:
        InputError: As in `evaluate`.
    """
    videos = [_video_fits(pairs, predictions, each) for each in protocols]
    found: list[list[tuple[int, ImageScore | LeftOut]]] = [[] for _ in protocols]
    truth, sizes = hashlib.sha256(), Counter[str]()
    for done, frame in enumerate(frames(pairs, predictions, protocols[0]), 1):
        name, values = frame.pair.name, frame.prediction.values
        truth.update(name.encode() + _truth(frame.pair))
        sizes[f"{values.shape[1]}x{values.shape[0]} {frame.prediction.space}"] += 1
        for protocol, fits, scores in zip(protocols, videos, found, strict=True):
            scores.append((frame.number, _scored(frame, protocol, fits)))
        watch(done)
    return [
        _evaluation(protocol, scores, truth.hexdigest(), dict(sizes))
        for protocol, scores in zip(protocols, found, strict=True)
    ]


def _truth(pair: Image) -> bytes:
    if isinstance(pair, OrdinalPair):
        return f"{pair.farther} {pair.nearer}".encode()
    return np.ascontiguousarray(pair.truth.values).tobytes()


def _evaluation(
    protocol: ScoringProtocol,
    found: Sequence[tuple[int, ImageScore | LeftOut]],
    truth: str,
    sizes: dict[str, int],
) -> Evaluation:
    scored = [(number, each) for number, each in found if isinstance(each, ImageScore)]
    left_out = tuple(each for _, each in found if isinstance(each, LeftOut))
    if not scored:
        why = left_out[0].reason if left_out else "the set has no image that the protocol selects"
        raise InputError(f"{protocol.name}: no image has a score: {why}")
    numbers, scores = zip(*scored, strict=True)
    results = estimates(scores, protocol.averaging)
    return Evaluation(protocol, numbers, scores, left_out, results, truth, sizes)


def _scored(
    frame: Frame, protocol: ScoringProtocol, fits: Mapping[str, Fit | None]
) -> ImageScore | LeftOut:
    if isinstance(frame.pair, OrdinalPair) and WHDR in protocol.metrics:
        return ordinal_score(frame.pair, frame.prediction, protocol)
    name = frame.pair.name
    return image_score(name, _seen(frame, protocol), protocol, fits.get(video_of(name)))


def _seen(frame: Frame, protocol: ScoringProtocol) -> Seen:
    if isinstance(frame.pair, OrdinalPair):
        raise InputError(f"{protocol.name}: this set holds pairs of points and no depth; try whdr")
    try:
        return seen_by(protocol, frame.pair.truth, frame.prediction)
    except InputError as error:
        raise InputError(f"{frame.pair.name}: {error}") from error


def _video_fits(
    pairs: Pairs, predictions: Predictions, protocol: ScoringProtocol
) -> dict[str, Fit | None]:
    """Return one fit for each video, by its name; none where images are fitted alone."""
    if protocol.per is Scope.IMAGE:
        return {}
    fits: dict[str, Fit | None] = {}
    for video, group in groupby(
        frames(pairs, predictions, protocol), lambda frame: video_of(frame.pair.name)
    ):
        points = (points_of(_seen(frame, protocol), protocol) for frame in group)
        try:
            if video in fits:
                raise InputError("its frames do not follow one another in the set")
            fits[video] = video_fit(points, protocol)
        except InputError as error:
            raise InputError(f"video {video or '(the whole set)'}: {error}") from error
    return fits


def _selection(protocol: ScoringProtocol) -> Callable[[str], bool]:
    """Return what says whether an image is scored; it is asked once for each, in order."""
    asked: Counter[str] = Counter()

    def selected(name: str) -> bool:
        video = video_of(name)
        asked[video] += 1
        early = protocol.frames is None or asked[video] <= protocol.frames
        return early and (not protocol.videos or _is_of(video, protocol.videos))

    return selected


def _is_of(video: str, videos: Sequence[str]) -> bool:
    return any(video == each or video.startswith(f"{each}_") for each in videos)


def _ahead(read: Callable[[int], Frame | None], count: int, readers: int) -> Iterator[Frame | None]:
    """Yield what is read, in order; a few are read while the last one is worked on."""
    with ThreadPoolExecutor(readers) as pool:
        waiting: deque[Future[Frame | None]] = deque()
        try:
            for number in range(count):
                waiting.append(pool.submit(read, number))
                if len(waiting) > _AHEAD:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for each in waiting:
                each.cancel()
