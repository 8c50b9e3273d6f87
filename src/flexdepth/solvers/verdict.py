"""What is known of a solved world, and why the rest is not."""

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence, TwoFrame, Unknown
from flexdepth.solvers.rotations import axis_angles
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.world import World, along_of

Array = NDArray[np.float64]


def answer(world: World, seen: Seen, clear: float) -> TwoFrame:
    """Return what is known of the world, and why the rest is not."""
    sight, labels, camera = world.sight, world.labels, world.camera
    rotation, translation = world.rotation, world.translation
    noise = sight.noise * camera.noise_factor
    place = np.einsum("hwab,hwb->hwa", rotation, sight.key)
    inverse = np.where(np.isfinite(world.inverse_depth), world.inverse_depth, 0.0)
    there = place + np.maximum(inverse, 0.0)[..., None] * translation
    ahead = there[..., 2] > 1e-6
    z = np.where(ahead, there[..., 2], 1.0)[..., None]
    infinity = place[..., :2] / np.maximum(place[..., 2:], 1e-6)
    residual = np.linalg.norm((sight.target[..., :2] - there[..., :2] / z) * sight.focal, axis=-1)
    way = (there[..., :2] / z - infinity) * sight.focal
    parallax = np.linalg.norm(way, axis=-1)
    lost = np.array([region.evidence is Evidence.UNKNOWN for region in world.regions])[labels]
    static = labels == 0
    along = along_of(sight, camera)
    parallax = np.where(static, along.parallax, parallax)
    unknown = np.select(
        [
            ~seen.known,
            ~seen.trusted,
            lost,
            static & (parallax < -clear * noise),
            static & ~((parallax > clear * noise) & (inverse > 0)),
            ~(inverse > 0),
        ],
        [
            Unknown.NO_FLOW,
            Unknown.OCCLUDED,
            Unknown.SCALE,
            Unknown.BEHIND,
            Unknown.LOW_PARALLAX,
            Unknown.BEHIND,
        ],
        Unknown.KNOWN,
    )
    known = unknown == Unknown.KNOWN
    scales = np.array([region.scale_spread for region in world.regions])[labels]
    nothing = np.where(seen.known, 0.0, np.nan)
    return TwoFrame(
        depth=np.where(known, 1 / np.where(known, inverse, 1.0), np.nan),
        rotation=axis_angles(rotation),
        translation=translation,
        labels=labels,
        regions=world.regions,
        moving=labels > 0,
        parallax=parallax + nothing,
        residual=residual + nothing,
        spread=np.where(known, np.hypot(world.shape_spread, scales), np.inf),
        unknown=unknown.astype(np.uint8),
        camera_motion=camera,
        prior_share=None,
        metric=False,
    )
