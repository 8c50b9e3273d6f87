"""What a scoring protocol is: every choice that changes a number, in one value.

The published ones are in `published.py`, with where each was read; docs/protocols.md has them in
words.
"""

from dataclasses import Field, dataclass
from enum import StrEnum
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.region import WHOLE, Region
from flexdepth.runtime.depthmap import DepthMap

STANDARD = (
    "abs_rel",
    "sq_rel",
    "rmse",
    "rmse_log",
    "log10",
    "silog",
    "delta1",
    "delta2",
    "delta3",
)
"""What most tables show."""


@runtime_checkable
class DataSettings(Protocol):
    """The settings of a data set: any frozen dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


class Scope(StrEnum):
    """Over what one fit is made."""

    IMAGE = "image"
    VIDEO = "video"


class Resize(StrEnum):
    """How a prediction of another size comes to the truth's."""

    BILINEAR = "bilinear"
    """Pixel centres at half integers: OpenCV's, and torch's with align_corners=False."""
    CORNERS = "corners"
    """Bilinear with align_corners=True: the corner pixels' centres fall together."""
    CUBIC = "cubic"
    """OpenCV's bicubic, pixel centres at half integers."""
    DISPARITY = "disparity"
    """Bilinear like the first, of inverse depth."""


class Averaging(StrEnum):
    """How the images of a set become one number."""

    IMAGES = "images"
    """The metric of each image, then the mean."""
    PIXELS = "pixels"
    """The metric once, over all pixels of all images: pooled."""
    VIDEOS = "videos"
    """The metric of each frame, the mean of each video, the mean of the videos."""
    VIDEOS_BY_PIXELS = "videos_by_pixels"
    """Pooled in each video; then the mean of the videos, each weighted by its scored pixels."""


@dataclass(frozen=True)
class Range:
    """Depths between two ends, in metres.

    Attributes:
        nearest: The lower end.
        farthest: The upper end.
        closed: Whether the ends belong to it.
    """

    nearest: float
    farthest: float
    closed: bool = False

    def __str__(self) -> str:
        """Return it in words."""
        ends = "with" if self.closed else "without"
        return f"{self.nearest:g} to {self.farthest:g} m, {ends} the ends"

    def holds(self, depth: NDArray[np.floating]) -> NDArray[np.bool_]:
        """Return which depths lie in the range; NaN does not."""
        if self.closed:
            return (depth >= self.nearest) & (depth <= self.farthest)
        return (depth > self.nearest) & (depth < self.farthest)


@dataclass(frozen=True)
class WholeMetres:
    """Truth as Video-Depth-Anything's released extractor leaves it on Sintel.

    It writes depth as 16-bit integers without scaling it, and the loader divides them: whole
    metres, a hundredth as far.
    """

    divisor: float = 65535 / 650

    def __call__(self, depth: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the depth that the loader finds."""
        known = np.isfinite(depth)
        found = np.floor(np.where(known, depth, 0)) / np.float32(self.divisor)
        return np.where(known, found, np.float32(np.nan)).astype(np.float32)


@dataclass(frozen=True)
class AsMeasured:
    """Truth as the set gives it."""

    def __call__(self, depth: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the depth."""
        return depth


AS_MEASURED = AsMeasured()


@dataclass(frozen=True)
class ScoringProtocol:
    """How predictions on a set are scored.

    Attributes:
        name: Such as `nyu-eigen`.
        version: Goes up whenever a number would change.
        summary: In one line.
        source: Where it was read.
        sets: The data sets it is for, by the names of their settings' classes; none means any.
        images: How many images the published figures are taken over; None where any number is.
        settings: What the set's settings should be, by field: which split, which truth. A set
            without the field has no choice there.
        scored: The truth that counts.
        region: Where it counts.
        recoded: What is done to the truth first.
        view: What part of an image the network sees. A prediction at the truth's size is taken as
            it is; any other is one of the view, and is brought to its size.
        resize: How.
        alignment: How predictions are fitted to the truth.
        per: Over what.
        least_disparity: Predicted disparity below this is raised to it before the fit.
        clip: Predictions are brought between these depths, after the fit.
        sky: The depth that the sky of a prediction is scored as.
        unknown: The depth that an unknown pixel of a prediction is scored as; None refuses it.
        frames: Of each video, only the first so many.
        videos: Only these; none means all.
        averaging: How the images become one number.
        metrics: By the names of `METRICS`, and `boundary_f1`.
    """

    name: str
    version: int
    summary: str
    source: str
    sets: tuple[str, ...] = ()
    images: int | None = None
    settings: tuple[tuple[str, str], ...] = ()
    scored: Range = Range(1e-3, 80.0)
    region: Region = WHOLE
    recoded: AsMeasured | WholeMetres = AS_MEASURED
    view: Region = WHOLE
    resize: Resize = Resize.BILINEAR
    alignment: Alignment = Alignment.NONE
    per: Scope = Scope.IMAGE
    least_disparity: float | None = None
    clip: tuple[float, float] | None = (1e-3, 80.0)
    sky: float = 80.0
    unknown: float | None = None
    frames: int | None = None
    videos: tuple[str, ...] = ()
    averaging: Averaging = Averaging.IMAGES
    metrics: tuple[str, ...] = STANDARD

    @property
    def title(self) -> str:
        """Name and version, such as "nyu-eigen v1"."""
        return f"{self.name} v{self.version}"

    def is_for(self, settings: object) -> bool:
        """Return whether it is made for a set, by the set's settings."""
        return not self.sets or type(settings).__name__ in self.sets


def truth_of(truth: DepthMap, protocol: ScoringProtocol) -> NDArray[np.float32]:
    """Return the depth that predictions are compared with, in metres; NaN where unknown."""
    depth = truth.depth
    return protocol.recoded(np.where(truth.valid, depth, np.float32(np.nan)))


def scored_pixels(depth: NDArray[np.float32], protocol: ScoringProtocol) -> NDArray[np.bool_]:
    """Return the pixels of one image that the protocol scores.

    Raises:
        InputError: The protocol is for images of another size.
    """
    inside = np.zeros(depth.shape, dtype=bool)
    part = protocol.region.box(*depth.shape).slices
    inside[part] = protocol.scored.holds(depth[part])
    return inside
