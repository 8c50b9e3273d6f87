"""A third frame: what the target hides, it may show."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.correspondences import from_flow
from flexdepth.solvers.ego_motion import camera_motion
from flexdepth.solvers.fusion import common_factor, fused
from flexdepth.solvers.region_motion import region_motion
from flexdepth.solvers.seen import Seen, ThirdFrame
from flexdepth.solvers.sight import Sight
from flexdepth.solvers.world import World, along_of, sight_of

Array = NDArray[np.float64]

_OFF = 3.0
"""Standard deviations off the camera's epipolar lines up to which a hidden pixel is still."""

_LEAST_STILL = 0.05
"""The share of the frame that has to be still and found again to tell the camera's motion."""

_FEWEST = 12

_NOTHING = "the third frame adds nothing: "


def with_third(world: World, seen: Seen, third: ThirdFrame) -> World:
    """Return the world with the depth that the third frame adds.

    Where the target hides a pixel, or both frames show it, the third frame's depth counts by its
    certainty. Where both show it and disagree, one stands alone: of what is still, that which
    leaves less off its epipolar line in its own noise (the smaller of two residuals, after Godard
    et al., ICCV 2019); of what moves by itself, which keeps to no such line, the more certain one.
    """
    other = Seen(third.flow, third.noise, seen.camera)
    still = other.trusted & (world.labels == 0)
    if not world.camera.translates:
        return world.noted(
            _NOTHING + "the camera has not travelled from the key frame to the target"
        )
    if still.sum() < _LEAST_STILL * still.size:
        return world.noted(_NOTHING + "too little of what is still is found in it")
    camera = camera_motion(from_flow(third.flow, still, third.noise, seen.camera))
    if not camera.translates:
        return world.noted(_NOTHING + "the camera has not travelled from the key frame to it")
    sight = replace(sight_of(other), down=world.sight.down)
    along = along_of(sight, camera)
    noise = sight.noise * camera.noise_factor
    labels = _labels(world, sight, np.abs(along.across) < _OFF * noise)
    inverse, spread = np.full(labels.shape, np.nan), np.full(labels.shape, np.inf)
    clear = (labels == 0) & sight.trusted & (along.parallax > 2 * noise)
    inverse[clear], spread[clear] = along.inverse_depth[clear], (along.spread * noise)[clear]
    for label in range(1, len(world.regions)):
        inside = (labels == label) & sight.trusted
        if inside.sum() >= _FEWEST:
            motion = region_motion(sight.pixels(inside), camera.pose, float(np.median(noise)))
            inverse[inside], spread[inside] = motion.inverse_depth, motion.spread
    for label in range(len(world.regions)):
        inside = labels == label
        found = common_factor(inverse, world.inverse_depth, inside / np.maximum(spread, 1e-4) ** 2)
        inverse[inside] *= np.nan if found is None else found[0]
    if not np.isfinite(inverse).any():
        return world.noted(_NOTHING + "too little has depth both in it and in the target")
    spread = np.where(np.isfinite(inverse), np.hypot(spread, _MODEL), np.inf)
    off = np.abs(along.across) / noise
    return _joined(replace(world, labels=labels), (inverse, spread), off)


_MODEL = 0.01
"""What the third frame's scale may err by."""


def _labels(world: World, sight: Sight, still: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return the labels, where pixels that the target hides are still if the third says so."""
    hidden = ~world.sight.trusted & sight.trusted
    return np.where(hidden & still, 0, world.labels).astype(np.int32)


def _joined(world: World, third: tuple[Array, Array], off: Array) -> World:
    """Return the world with the third frame's depths in it.

    Args:
        world: As the target shows it.
        third: Inverse depth and its relative standard deviation, as the third frame shows it.
        off: Standard deviations of its flow off the camera's epipolar lines.
    """
    trusted = world.sight.trusted
    own = np.where(trusted, world.inverse_depth, np.nan)
    spread = np.where(np.isfinite(own) & (own > 0), world.shape_spread, np.inf)
    inverse, left, _ = fused((own, spread), third)
    both = np.isfinite(spread) & np.isfinite(third[1])
    with np.errstate(invalid="ignore", divide="ignore"):
        apart = np.abs(np.log(third[0] / own)) > 3 * np.hypot(spread, third[1]) + 0.01
    across = np.abs(along_of(world.sight, world.camera).across)
    nearer = across / (world.sight.noise * world.camera.noise_factor) <= off
    first = np.where(world.labels == 0, nearer, spread <= third[1])
    for at, (depth, certain) in (
        (both & apart & first, (own, spread)),
        (both & apart & ~first, third),
    ):
        inverse[at], left[at] = depth[at], certain[at]
    moved = world.labels == 0
    still = world.camera.pose
    return replace(
        world,
        inverse_depth=inverse,
        shape_spread=left,
        rotation=np.where(
            moved[..., None, None] & ~trusted[..., None, None], still.rotation, world.rotation
        ),
        translation=np.where(
            moved[..., None] & ~trusted[..., None], still.translation, world.translation
        ),
    )
