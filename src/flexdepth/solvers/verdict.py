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
    sight, rotation, translation = world.sight, world.rotation, world.translation
    place = np.einsum("hwab,hwb->hwa", rotation, sight.key)
    inverse = np.where(np.isfinite(world.inverse_depth), world.inverse_depth, 0.0)
    there = place + np.maximum(inverse, 0.0)[..., None] * translation
    ahead = there[..., 2] > 1e-6
    z = np.where(ahead, there[..., 2], 1.0)[..., None]
    infinity = place[..., :2] / np.maximum(place[..., 2:], 1e-6)
    residual = np.linalg.norm((sight.target[..., :2] - there[..., :2] / z) * sight.focal, axis=-1)
    way = (there[..., :2] / z - infinity) * sight.focal
    parallax = np.linalg.norm(way, axis=-1)
    static = world.labels == 0
    parallax = np.where(static, along_of(sight, world.camera).parallax, parallax)
    flowing = seen.known | sight.trusted
    unknown = _reasons(world, flowing, parallax < -clear * sight.noise * world.camera.noise_factor)
    known = unknown == Unknown.KNOWN
    scales = np.array([region.scale_spread for region in world.regions])[world.labels]
    nothing = np.where(flowing, 0.0, np.nan)
    depth = np.where(known, 1 / np.where(known, inverse, 1.0), np.nan)
    return TwoFrame(
        depth=np.where(unknown == Unknown.SKY, np.inf, depth),
        rotation=axis_angles(rotation),
        translation=translation,
        labels=world.labels,
        regions=world.regions,
        moving=~static,
        parallax=parallax + nothing,
        residual=residual + nothing,
        flow=sight.flow + nothing[..., None],
        noise=np.where(sight.trusted, sight.noise, np.nan),
        spread=np.where(known, np.hypot(world.shape_spread, scales), np.inf),
        unknown=unknown.astype(np.uint8),
        inferred=np.zeros_like(static),
        camera_motion=world.camera,
        prior_share=world.prior_share,
        metric=world.metric,
        notes=world.notes,
    )


def _reasons(
    world: World, flowing: NDArray[np.bool_], behind: NDArray[np.bool_]
) -> NDArray[np.intp]:
    """Return why each pixel has no depth, by the flow that was used.

    Args:
        world: As it was solved.
        flowing: Where there is any flow, trusted or not.
        behind: Where flow would put what is still behind the camera.
    """
    lost = np.array([region.evidence is Evidence.UNKNOWN for region in world.regions])
    lost = lost[world.labels]
    known = np.isfinite(world.shape_spread) & (world.inverse_depth > 0) & ~lost
    sky = np.zeros_like(known) if world.sky is None else world.sky
    tests = [sky, known, ~flowing, ~world.sight.trusted, lost, behind & (world.labels == 0)]
    reasons = [
        Unknown.SKY,
        Unknown.KNOWN,
        Unknown.NO_FLOW,
        Unknown.OCCLUDED,
        Unknown.SCALE,
        Unknown.BEHIND,
    ]
    return np.asarray(np.select(tests, reasons, Unknown.LOW_PARALLAX))
