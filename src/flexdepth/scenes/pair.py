"""Two frames to depth and motion: read, matched, seen singly, solved."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.flow.along_lines import AlongLines
from flexdepth.flow.dis import Dis
from flexdepth.flow.field import FlowField
from flexdepth.flow.matches import Agreement, Akaze, agreement
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.lens import Lens
from flexdepth.scenes.correspondence import FlowFile, FlowMethod, doubts
from flexdepth.scenes.objective import Objective, solved
from flexdepth.scenes.prior import BUNDLED, Told, as_prior, single_image_depth, told
from flexdepth.scenes.stereo import right_view
from flexdepth.scenes.views import Picture, ViewFiles, Views, read_views
from flexdepth.solvers.two_frame import Seen, Stereo, ThirdFrame, TwoFrame

LONG_SIDE = 1280
"""Pixels: larger frames are made so small, for time and memory grow with their area."""


@dataclass(frozen=True)
class PairSettings:
    """What is to be solved, and how.

    Attributes:
        files: The pictures.
        camera: What is known of it: a length, an angle or a file; None leaves it to the photos.
        flow: How key and target are matched; a third frame and the right picture too, unless it
            is a file, which is of key and target alone.
        prior: A model by its name (`runtime.named`), or None for geometry alone, as is chapter
            5's objective.
        baseline: Metres between the key picture and that of the right camera.
        objective: What is minimised.
        long_side: Pixels; larger frames are made so small.
    """

    files: ViewFiles
    camera: Lens | Path | None = None
    flow: FlowMethod = field(default_factory=Dis)
    prior: str | Path | None = BUNDLED
    baseline: float | None = None
    objective: Objective = Objective.DENSE
    long_side: int = LONG_SIDE

    def __post_init__(self) -> None:
        """Refuse half a stereo camera."""
        if (self.files.right is None) != (self.baseline is None):
            raise InputError(
                "--stereo and --baseline belong together: the right camera's picture, and how many "
                "metres it is beside the left one"
            )
        if self.objective.is_the_dissertations and (self.files.third or self.files.right):
            raise InputError(
                f"--objective {self.objective} takes two frames: leave --third and --stereo out"
            )
        if self.objective.is_the_dissertations and self.prior not in (None, BUNDLED):
            raise InputError(
                f"--objective {self.objective} takes no prior: leave --prior {self.prior} out"
            )
        if self.baseline is not None and not 0 < self.baseline < np.inf:
            raise InputError(f"--baseline: wanted metres, above 0, got {self.baseline:g}")

    @property
    def model(self) -> str | Path | None:
        """The prior that is asked: none by chapter 5's objective."""
        return None if self.objective.is_the_dissertations else self.prior


@dataclass(frozen=True, eq=False)
class Solution:
    """What two frames tell.

    Attributes:
        views: The pictures, at the size that was solved.
        flow: From key to target, as it was used: with what a second look has found.
        borne_out: How far AKAZE matches, found by other means, agree with that flow.
        prior: Depth from the key frame alone; None where it was not asked.
        found: Depth and motion of every pixel.
        model: Who made the depth, for its file.
        warnings: What was noticed of the input and of its use, one line each.
    """

    views: Views
    flow: FlowField
    borne_out: Agreement
    prior: DepthMap | None
    found: TwoFrame
    model: str
    warnings: tuple[str, ...]

    @property
    def key(self) -> Picture:
        """The frame whose depth is sought: RGB."""
        return self.views.pictures["key"]

    @property
    def camera(self) -> Intrinsics:
        """Of all frames."""
        return self.views.camera

    @property
    def depth(self) -> DepthMap:
        """Metric where metres are known, else in units of the camera's way; NaN where unknown."""
        space = Space.METRIC if self.found.metric else Space.SCALE
        spread = np.where(self.found.valid, self.found.spread, np.nan).astype(np.float32)
        return DepthMap(self.found.depth.astype(np.float32), space, self.camera, self.model, spread)

    @property
    def confidence(self) -> NDArray[np.float32]:
        """How sure the scale of each pixel's region is beside the static world's, 0 to 1."""
        by_label = np.array([region.confidence for region in self.found.regions], np.float32)
        return by_label[self.found.labels]


def solve(settings: PairSettings, say: Callable[[str], None] = lambda _step: None) -> Solution:
    """Return depth and motion of the key frame's pixels.

    Args:
        settings: What is to be solved.
        say: Is told what is being done.

    Raises:
        InputError: A file cannot be used, the frames do not belong together, or too little of
            the one is found again in the other.
    """
    say("reading the frames")
    views = read_views(settings.files, settings.camera, settings.long_side)
    pictures = views.pictures
    say("matching the frames")
    method, others = settings.flow, settings.flow
    if isinstance(method, FlowFile):
        method, others = replace(method, reduced=views.reduced), Dis()
    flow = method.between(pictures["key"], pictures["target"])
    prior, licence = None, tuple[str, ...]()
    if settings.model is not None:
        say("looking at the key frame alone")
        prior, licence = single_image_depth(settings.model, pictures["key"], views.camera)
        views = _own_camera(views, prior)
    more = _more_views(settings, pictures, others, say)
    seen = Seen(
        flow.flow,
        flow.noise,
        views.camera,
        pictures["key"],
        None if prior is None else as_prior(prior),
        more.third,
        more.stereo,
    )
    if not isinstance(method, FlowFile):
        search = AlongLines(pictures["key"], pictures["target"], views.camera)
        seen = replace(seen, target=pictures["target"], search=search)
    say("solving")
    found = solved(settings.objective, seen, pictures["key"], pictures["target"])
    used = _used(found)
    borne_out = agreement(used, Akaze().between(pictures["key"], pictures["target"]))
    notes = (*views.warnings, *more.notes, *licence, *found.notes, *doubts(borne_out))
    model = _model(settings.objective, prior, found)
    return Solution(views, used, borne_out, prior, found, model, notes)


def _model(objective: Objective, prior: DepthMap | None, found: TwoFrame) -> str:
    """Return who made the depth: the solver, and the prior where it has a part in it."""
    own = f"flexdepth solve ({objective})"
    if prior is None:
        return own
    match told(found):
        case Told.DEPTH:
            return f"{own}, {prior.model}"
        case Told.SKY:
            return f"{own}, sky by {prior.model}"
        case Told.NOTHING:
            return own


def _used(found: TwoFrame) -> FlowField:
    noise = found.noise.astype(np.float32)
    return FlowField(found.flow.astype(np.float32), np.isfinite(noise), noise)


@dataclass(frozen=True, eq=False)
class _More:
    """What is known beside key and target, and what is odd about it."""

    third: ThirdFrame | None
    stereo: Stereo | None
    notes: tuple[str, ...]


def _more_views(
    settings: PairSettings,
    pictures: Mapping[str, Picture],
    method: FlowMethod,
    say: Callable[[str], None],
) -> _More:
    third = stereo = None
    notes: tuple[str, ...] = ()
    if "third" in pictures:
        say("matching the third frame")
        other = _named("the third frame", method, pictures["key"], pictures["third"])
        third = ThirdFrame(other.flow, other.noise)
    if settings.baseline is not None:
        say("matching the right camera's picture")
        other = _named("the right picture", method, pictures["key"], pictures["right"])
        stereo, notes = right_view(other, settings.baseline, str(settings.files.right))
    return _More(third, stereo, notes)


def _own_camera(views: Views, prior: DepthMap | None) -> Views:
    """Return the views with the camera that the model sees in the key frame, if nobody knows it."""
    seen = None if prior is None else prior.intrinsics
    if views.camera.source.is_known or seen is None or seen.source is not FocalSource.PREDICTED:
        return views
    return replace(views, camera=seen)


def _named(name: str, method: FlowMethod, key: Picture, other: Picture) -> FlowField:
    """Return flow to another picture than the target, which a complaint then names."""
    try:
        return method.between(key, other)
    except InputError as mistake:
        raise InputError(f"from the key frame to {name}: {mistake}") from mistake
