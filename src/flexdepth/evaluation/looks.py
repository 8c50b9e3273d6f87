"""The ways of looking twice, once in a mirror, that published figures were made with.

Each is a `flexdepth.runtime.predictor.Look`: a network and pictures to depth and sky. The
runtime's own, `mirrored_too`, takes the geometric mean.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.model import Model
from flexdepth.runtime.predictor import Look, mirrored_too, once

_Reals: TypeAlias = NDArray[np.float32]

_ONE, _TWO = np.float32(1), np.float32(2)


def mean_of_mirrored(model: Model, images: _Reals) -> tuple[_Reals, _Reals]:
    """Return the mean of the depths of two looks.

    References:
        Lee et al., BTS, 2019, and AdaBins' evaluate.py; the latter clips each look first.
    """
    (depth, sky), (mirrored, sky_mirrored) = model.run(images), _mirrored(model, images)
    return (depth + mirrored) / _TWO, (sky + sky_mirrored) / _TWO


def ramp_of_mirrored(model: Model, images: _Reals) -> tuple[_Reals, _Reals]:
    """Return monodepth's post-processing (_PP) of two looks, which it does in disparity."""
    (depth, sky), (mirrored, sky_mirrored) = model.run(images), _mirrored(model, images)
    disparity = blended(_ONE / depth, _ONE / mirrored)
    return _ONE / disparity, (sky + sky_mirrored) / _TWO


def blended(seen: _Reals, mirrored: _Reals) -> _Reals:
    """Return monodepth's blend of two disparities: near each side border, one of them alone.

    Stereo training leaves a ramp at the left border of what is seen, and in a mirror at the
    right: on the left twentieth the mirrored look counts, on the right one the other, with a
    change over as much again to the mean of both.

    Args:
        seen: Disparity.
        mirrored: Of the mirrored picture, mirrored back.

    References:
        Godard, Mac Aodha and Brostow, CVPR 2017; monodepth2 `batch_post_process_disparity`.
    """
    across = np.linspace(0, 1, seen.shape[-1], dtype=np.float32)
    left = 1 - np.clip(20 * (across - np.float32(0.05)), 0, 1)
    right = left[::-1]
    mean = (seen + mirrored) / _TWO
    return np.asarray(right * seen + left * mirrored + (1 - left - right) * mean, np.float32)


def _mirrored(model: Model, images: _Reals) -> tuple[_Reals, _Reals]:
    depth, sky = model.run(np.ascontiguousarray(images[..., ::-1]))
    return depth[..., ::-1], sky[..., ::-1]


LOOKS: Mapping[str, Look] = MappingProxyType(
    {
        "once": once,
        "flip": mirrored_too,
        "flip-mean": mean_of_mirrored,
        "flip-ramp": ramp_of_mirrored,
    }
)
"""How a network looks at a picture, by name."""
