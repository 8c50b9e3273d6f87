"""Depth from the key frame alone, as the solver takes it."""

from enum import StrEnum
from pathlib import Path

import numpy as np

from flexdepth.runtime.depthmap import DepthMap, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.estimator import Estimator
from flexdepth.runtime.images import Photo
from flexdepth.runtime.lens import FocalLength
from flexdepth.runtime.licences import remark
from flexdepth.runtime.named import Wishes, named_estimator
from flexdepth.scenes.views import Picture
from flexdepth.solvers.two_frame import Prior, TwoFrame, Unknown

BUNDLED = "compact"
"""The model that comes with flexdepth."""

SPREAD = 0.15
"""Relative standard deviation of single-image depth beyond one common factor, where the model does
not say its own: between what the bundled model is off by on KITTI and on NYU."""

_LEAST_SPREAD = 0.02
"""No single picture tells depth better than this."""


class Told(StrEnum):
    """What of a solution the prior has a part in."""

    DEPTH = "depth"
    SKY = "sky"
    """Alone: its unit could not be tied to what the frames show."""
    NOTHING = "nothing"


def told(found: TwoFrame) -> Told:
    """Return what the prior has a part in, of what was solved with one."""
    share = found.prior_share
    if share is not None and (share[found.valid] > 0).any():
        return Told.DEPTH
    return Told.SKY if (found.unknown == Unknown.SKY).any() else Told.NOTHING


def opened(model: str | Path, camera: Intrinsics | None = None) -> Estimator:
    """Return a model by its name, for pictures of this camera.

    Args:
        model: See `runtime.named`.
        camera: None, and one whose focal length nobody knows, leave it to the model.

    Raises:
        InputError: There is no such model, or it is broken.
    """
    known = camera is not None and camera.source.is_known
    lens = FocalLength((camera.focal_x * camera.focal_y) ** 0.5) if camera and known else None
    return named_estimator(model, Wishes(lens))


def single_image_depth(
    model: str | Path, picture: Picture, camera: Intrinsics
) -> tuple[DepthMap, tuple[str, ...]]:
    """Return what a model makes of the key frame alone, and what its licence forbids.

    Args:
        model: See `runtime.named`.
        picture: RGB.
        camera: Its camera; where nobody knows the focal length, there are no metres.

    Raises:
        InputError: There is no such model, it fails, or gives what is no depth.
    """
    found = opened(model, camera)
    depth = found.predict(Photo(picture, None, ()))
    if depth.space not in (Space.METRIC, Space.SCALE):
        raise InputError(
            f"--prior {model} gives {depth.space}, which has an unknown offset; depth that is "
            "metric or known up to scale is wanted: take another model, or --prior none"
        )
    said = remark(found.about)
    return depth, () if said is None else (said,)


def as_prior(depth: DepthMap) -> Prior:
    """Return depth and its spread; where the model says none, `SPREAD`."""
    spread = np.full(depth.values.shape, SPREAD, np.float32)
    if depth.spread is not None:
        known = np.isfinite(depth.spread)
        spread = np.where(known, np.maximum(depth.spread, np.float32(_LEAST_SPREAD)), spread)
    return Prior(depth.depth, spread, depth.space is Space.METRIC)
