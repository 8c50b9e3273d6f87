"""The ways of looking twice, once in a mirror, that published figures were made with.

Each is a `flexdepth.runtime.looks.Look`; the runtime's own, which take geometric means, stand
beside them in `LOOKS`.
"""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from flexdepth.runtime.answer import Answer, Reals
from flexdepth.runtime.looks import Look, Shown, at_three_sizes, both_ways, mirrored_too, once
from flexdepth.runtime.model import Model

_ONE, _TWO = np.float32(1), np.float32(2)


def mean_of_mirrored(model: Model, shown: Shown) -> Answer:
    """Return the mean of the depths of two looks.

    References:
        Lee et al., BTS, 2019, and AdaBins' evaluate.py; the latter clips each look first.
    """
    seen, mirrored = both_ways(model, shown)
    return Answer.joined([seen, mirrored], (seen.depth + mirrored.depth) / _TWO)


def ramp_of_mirrored(model: Model, shown: Shown) -> Answer:
    """Return monodepth's post-processing (_PP) of two looks, which it does in disparity."""
    seen, mirrored = both_ways(model, shown)
    depth = _ONE / blended(_ONE / seen.depth, _ONE / mirrored.depth)
    return Answer.joined([seen, mirrored], depth)


def blended(seen: Reals, mirrored: Reals) -> Reals:
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


LOOKS: Mapping[str, Look] = MappingProxyType(
    {
        "once": once,
        "flip": mirrored_too,
        "flip-mean": mean_of_mirrored,
        "flip-ramp": ramp_of_mirrored,
        "sizes": at_three_sizes,
    }
)
"""How a network looks at a picture, by name."""
