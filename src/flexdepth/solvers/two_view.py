"""Depth of the static world from one motion of the camera, and where it cannot be known.

With q = R x, a point at inverse depth ρ (1/z in the key camera) is seen at π(q + ρ t). From π(q),
where it would be seen at infinity, it has moved along its epipolar line by the parallax

    s = ρ |v| / (q_z + ρ t_z),   v = f (t_xy - π(q) t_z),   so   ρ = s q_z / (|v| - s t_z)

in pixels; what the flow shows across that line no depth explains.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.solvers.correspondences import pixel_centres, rays
from flexdepth.solvers.pose import Pose

Array = NDArray[np.float64]

_STILL = 1e-12


@dataclass(frozen=True, eq=False)
class Along:
    """What is seen along and across the epipolar lines of a motion, for points of any shape.

    Attributes:
        parallax: s, pixels; below 0 where the point would be behind the key camera.
        across: Pixels from the line, signed.
        inverse_depth: ρ at |t| as given; NaN where no depth explains s.
        spread: |dρ/ds| / |ρ|, per pixel: times the flow's noise it is the depth's relative
            standard deviation; +inf where s = 0.
    """

    parallax: Array
    across: Array
    inverse_depth: Array
    spread: Array


def seen_along(key: Array, target: Array, pose: Pose, focal: Array) -> Along:
    """Return what matched rays say of depth.

    Args:
        key: ... x 3, z = 1.
        target: Likewise.
        pose: `target_from_key`.
        focal: Across and down, pixels.
    """
    turned = key @ pose.rotation.T
    ahead = turned[..., 2] > 0
    z = np.where(ahead, turned[..., 2], 1.0)
    infinity = turned[..., :2] / z[..., None]
    t_xy, t_z = pose.translation[:2], pose.translation[2]
    way = focal * (t_xy - infinity * t_z)
    length = np.linalg.norm(way, axis=-1)
    known = ahead & (length > _STILL)
    unit = way / np.where(known, length, 1.0)[..., None]
    shift = (target[..., :2] - infinity) * focal
    parallax = (shift * unit).sum(-1)
    across = shift[..., 1] * unit[..., 0] - shift[..., 0] * unit[..., 1]
    rest = length - parallax * t_z
    possible = known & (rest > _STILL)
    inverse = parallax * z / np.where(possible, rest, 1.0)
    with np.errstate(divide="ignore"):
        relative = length / np.where(possible, rest, 1.0) / np.abs(parallax)
    return Along(
        np.where(known, parallax, 0.0),
        across,
        np.where(possible, inverse, np.nan),
        np.where(possible, relative, np.inf),
    )


@dataclass(frozen=True, eq=False)
class StaticDepth:
    """Depth of each pixel as if it belonged to the static world; each height x width.

    Attributes:
        depth: z in the key camera, in units of the camera's way |t|; NaN where not valid.
        spread: The depth's relative standard deviation; +inf where there is no parallax.
        parallax: Pixels; 0 where the camera has not moved, NaN where there is no flow.
        across: Pixels from the epipolar line, signed: noise, or motion of the pixel's own. Where
            the camera has not moved, the length of what rotation leaves.
        valid: Where the flow is known, the parallax clears its noise, and the point is ahead.
    """

    depth: Array
    spread: Array
    parallax: Array
    across: Array
    valid: NDArray[np.bool_]


def static_depth(
    flow: NDArray[np.float32],
    noise: NDArray[np.float32],
    camera: Intrinsics,
    pose: Pose,
    clear: float = 2.0,
) -> StaticDepth:
    """Return the depth that one motion of the camera gives each pixel.

    Nothing is invented: where parallax is below `clear` standard deviations of the flow's noise,
    as around the point the camera drives to, or the flow is unknown, there is no depth.

    Args:
        flow: Height x width x 2, pixels; NaN is unknown.
        noise: Standard deviation of each component, pixels; NaN where flow is not to be trusted.
        camera: Of both frames.
        pose: `target_from_key`; a translation of 0 is a camera that has stayed.
        clear: How many standard deviations of parallax make a depth.
    """
    centres = pixel_centres(*noise.shape)
    known = np.isfinite(flow).all(axis=-1) & np.isfinite(noise)
    shift = np.where(known[..., None], flow, 0.0).astype(np.float64)
    key, target = rays(centres, camera), rays(centres + shift, camera)
    focal = np.array([camera.focal_x, camera.focal_y])
    if not pose.translation.any():
        turned = key @ pose.rotation.T
        left = (target[..., :2] - turned[..., :2] / turned[..., 2:]) * focal
        nothing = np.full(known.shape, np.nan)
        return StaticDepth(
            nothing,
            np.full(known.shape, np.inf),
            np.where(known, 0.0, np.nan),
            np.where(known, np.linalg.norm(left, axis=-1), np.nan),
            np.zeros_like(known),
        )
    along = seen_along(key, target, pose, focal)
    deviation = np.where(known, noise, 1.0).astype(np.float64)
    valid: NDArray[np.bool_] = (
        known & (along.parallax > clear * deviation) & (along.inverse_depth > 0)
    )
    return StaticDepth(
        np.where(valid, 1 / np.where(valid, along.inverse_depth, 1.0), np.nan),
        np.where(known, along.spread * deviation, np.inf),
        np.where(known, along.parallax, np.nan),
        np.where(known, along.across, np.nan),
        valid,
    )
