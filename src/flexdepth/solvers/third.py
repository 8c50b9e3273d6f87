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
from flexdepth.solvers.two_view import Along
from flexdepth.solvers.world import World, along_of, sight_of

Array = NDArray[np.float64]

_OFF = 3.0
"""Standard deviations off the camera's epipolar lines up to which a hidden pixel is still."""

_FEWEST = 12


def with_third(world: World, seen: Seen, third: ThirdFrame) -> World:
    """Return the world with the depth that the third frame adds.

    Where the target hides a pixel, or both frames show it, the third frame's depth counts by its
    certainty; where both show it and disagree, the one that leaves less off its epipolar line
    stands alone (the smaller of two residuals, after Godard et al., ICCV 2019).
    """
    other = Seen(third.flow, third.noise, seen.camera)
    still = other.trusted & (world.labels == 0)
    if not world.camera.translates or still.sum() < 0.05 * still.size:
        return world
    camera = camera_motion(from_flow(third.flow, still, third.noise, seen.camera))
    if not camera.translates:
        return world
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
    spread = np.where(np.isfinite(inverse), np.hypot(spread, _MODEL), np.inf)
    return _joined(replace(world, labels=labels), (inverse, spread), along)


_MODEL = 0.01
"""What the third frame's scale may err by."""


def _labels(world: World, sight: Sight, still: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return the labels, where pixels that the target hides are still if the third says so."""
    hidden = ~world.sight.trusted & sight.trusted
    return np.where(hidden & still, 0, world.labels).astype(np.int32)


def _joined(world: World, third: tuple[Array, Array], along: Along) -> World:
    trusted = world.sight.trusted
    own = np.where(trusted, world.inverse_depth, np.nan)
    spread = np.where(np.isfinite(own) & (own > 0), world.shape_spread, np.inf)
    inverse, left, _ = fused((own, spread), third)
    both = np.isfinite(spread) & np.isfinite(third[1])
    with np.errstate(invalid="ignore", divide="ignore"):
        apart = np.abs(np.log(third[0] / own)) > 3 * np.hypot(spread, third[1]) + 0.01
    first = np.abs(along_of(world.sight, world.camera).across) <= np.abs(along.across)
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
