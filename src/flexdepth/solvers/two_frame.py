"""Depth and motion of every pixel from two frames of a world in which things move and bend.

The camera's own motion comes first; what does not move as it says are regions of their own.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence, Kind, Region, TwoFrame, Unknown
from flexdepth.solvers.correspondences import from_flow
from flexdepth.solvers.ego_motion import camera_motion
from flexdepth.solvers.seen import Prior, Seen, Stereo, ThirdFrame
from flexdepth.solvers.two_view import static_depth

__all__ = [
    "Dense",
    "Evidence",
    "Kind",
    "Prior",
    "Region",
    "Seen",
    "Stereo",
    "ThirdFrame",
    "TwoFrame",
    "TwoFrameSettings",
    "Unknown",
    "two_frame",
]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Dense:
    """Refinement of depth and motion at every pixel.

    Attributes:
        steps: Gauss-Newton steps at the finest level.
    """

    steps: int = 6


@dataclass(frozen=True)
class TwoFrameSettings:
    """How two frames are solved.

    Attributes:
        dense: The refinement of every pixel; None is regions alone.
        clear: How many standard deviations of parallax make a depth.
    """

    dense: Dense | None = Dense()
    clear: float = 2.0


def two_frame(seen: Seen, settings: TwoFrameSettings = TwoFrameSettings()) -> TwoFrame:
    """Return depth and motion of every pixel.

    Raises:
        InputError: Fewer than 16 pixels have flow that is to be trusted.
    """
    motion = camera_motion(from_flow(seen.flow, seen.trusted, seen.noise, seen.camera))
    noise = seen.noise * np.float32(motion.noise_factor)
    found = static_depth(seen.flow, noise, seen.camera, motion.pose, settings.clear)
    unknown = np.select(
        [~seen.known, ~seen.trusted, found.valid, found.parallax < -settings.clear * noise],
        [Unknown.NO_FLOW, Unknown.OCCLUDED, Unknown.KNOWN, Unknown.BEHIND],
        Unknown.LOW_PARALLAX,
    )
    shape = seen.noise.shape
    axis = np.asarray(cv2.Rodrigues(motion.pose.rotation)[0], np.float64).ravel()
    still = Region(0, Kind.STATIC, Evidence.CAMERA, 1.0, 0.0, int(np.prod(shape)))
    return TwoFrame(
        depth=found.depth,
        rotation=np.broadcast_to(axis, (*shape, 3)).copy(),
        translation=np.broadcast_to(motion.pose.translation, (*shape, 3)).copy(),
        labels=np.zeros(shape, np.int32),
        regions=(still,),
        moving=np.zeros(shape, bool),
        parallax=found.parallax,
        residual=np.abs(found.across),
        spread=found.spread,
        unknown=unknown.astype(np.uint8),
        camera_motion=motion,
        prior_share=None,
        metric=False,
    )
