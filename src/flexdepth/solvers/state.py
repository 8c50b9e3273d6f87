"""The world as regions with a motion each, and the answer that is made of it."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence, Kind, Region, TwoFrame, Unknown
from flexdepth.solvers.borders import border, surroundings
from flexdepth.solvers.correspondences import Correspondences, from_flow, pixel_centres, rays
from flexdepth.solvers.ego_motion import CameraMotion, camera_motion
from flexdepth.solvers.epipolar import Epipolar
from flexdepth.solvers.ground import ground
from flexdepth.solvers.least_squares import refined
from flexdepth.solvers.pieces import Labels, pieces
from flexdepth.solvers.regions import filled, moving_regions
from flexdepth.solvers.relative_scale import Clues, Scale, relative_scale
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.things import Sight, Thing, middle_motion, scaled, things, wobble
from flexdepth.solvers.two_view import Along, seen_along

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_PULLS = 3.0
"""Standard deviations at which a pixel stops pulling at the camera's motion."""


@dataclass(frozen=True, eq=False)
class World:
    """Depth and motion of every pixel, before it is said which of them are known.

    Attributes:
        sight: What is seen.
        camera: The camera's motion.
        labels: Number of each pixel's region; 0 is the static world.
        regions: What is known of each.
        inverse_depth: Of each pixel; NaN where there is none.
        spread: Its relative standard deviation, that of its region's scale included.
        rotation: Of each region, regions x 3 x 3.
        translation: Of each, regions x 3.
    """

    sight: Sight
    camera: CameraMotion
    labels: Labels
    regions: tuple[Region, ...]
    inverse_depth: Array
    spread: Array
    rotation: Array
    translation: Array


def sight_of(seen: Seen) -> Sight:
    """Return the maps that the parts of the solver look at."""
    centres = pixel_centres(*seen.noise.shape)
    flow = np.where(seen.known[..., None], seen.flow, 0.0).astype(np.float64)
    return Sight(
        rays(centres, seen.camera),
        rays(centres + flow, seen.camera),
        flow,
        np.where(seen.trusted, seen.noise, 1.0).astype(np.float64),
        seen.trusted,
        np.array([seen.camera.focal_x, seen.camera.focal_y]),
    )


def solved_regions(seen: Seen, clear: float) -> World:
    """Return the world as a few regions.

    Camera and moving regions are found in turn, twice: the first camera counts what moves as
    outliers, the second leaves it out, and the plane, if it was one, does no longer bind it.

    Args:
        seen: The two frames.
        clear: Standard deviations of parallax that make a depth.
    """
    sight = sight_of(seen)
    trusted = seen.trusted
    camera = camera_motion(from_flow(seen.flow, trusted, seen.noise, seen.camera))
    along = _along(sight, camera)
    cut = pieces(sight.flow, along.across, float(np.median(sight.noise[trusted])), seen.image)
    moving = moving_regions(cut, sight.flow, along, sight.noise, trusted)
    still = trusted & (moving.labels == 0)
    if moving.labels.any() and still.sum() > 0.2 * trusted.sum():
        camera = _refined(camera, from_flow(seen.flow, still, seen.noise, seen.camera))
        along = _along(sight, camera)
        moving = moving_regions(cut, sight.flow, along, sight.noise, trusted)
    labels, found = things(filled(moving.labels, trusted), sight, camera.pose, moving.strays)
    return _scaled_world(sight, camera, along, (labels, found, clear))


def _refined(camera: CameraMotion, still: Correspondences) -> CameraMotion:
    """Return the camera's motion at what is still: nothing that moves pulls at it any more."""
    if not camera.translates:
        return camera
    epipolar = Epipolar(*still.rays(), still.focal, still.noise * camera.noise_factor)
    return replace(camera, pose=refined(epipolar, camera.pose, _PULLS))


def _along(sight: Sight, camera: CameraMotion) -> Along:
    """Return what the flow says of depth, were all still.

    A camera that has stayed shows no parallax: all that its turning leaves is off.
    """
    if camera.translates:
        return seen_along(sight.key, sight.target, camera.pose, sight.focal)
    place = sight.key @ camera.pose.rotation.T
    left = (sight.target[..., :2] - place[..., :2] / place[..., 2:]) * sight.focal
    nothing = np.zeros(left.shape[:2])
    off = np.linalg.norm(left, axis=-1)
    return Along(nothing, off, np.full_like(nothing, np.nan), np.full_like(nothing, np.inf))


def _scaled_world(
    sight: Sight,
    camera: CameraMotion,
    along: Along,
    regions: tuple[Labels, list[Thing], float],
) -> World:
    labels, found, clear = regions
    noise = sight.noise * camera.noise_factor
    static = sight.trusted & (labels == 0)
    static &= (along.parallax > clear * noise) & (along.inverse_depth > 0)
    inverse = np.where(labels == 0, along.inverse_depth, np.nan)
    spread = np.where(labels == 0, along.spread * noise, np.inf)
    around = surroundings(np.where(static, inverse, 0.0), static, sight.flow, sight.trusted)
    floor = ground(sight.key, along.inverse_depth, static)
    typical = float(np.log(np.median(inverse[static]))) if static.any() else 0.0
    count = int(labels.max()) + 1
    rotation = np.broadcast_to(camera.pose.rotation, (count, 3, 3)).copy()
    translation = np.broadcast_to(camera.pose.translation, (count, 3)).copy()
    told = [Region(0, Kind.STATIC, Evidence.CAMERA, 1.0, 0.0, int((labels == 0).sum()))] * count
    for thing in found:
        own = _own_inverse_depth(labels, thing, sight.trusted)
        inside = np.isin(labels, thing.labels) & sight.trusted
        counts = np.array([(labels == each).sum() for each in thing.labels], np.float64)
        middles = np.array([sight.key[labels == each].mean(axis=0) for each in thing.labels])
        scale = relative_scale(
            Clues(
                thing.kind,
                border(inside, own, around),
                middle_motion(thing, counts, middles, camera.pose),
                wobble(thing, sight, labels, camera.pose),
                camera.pose.rotation.T @ camera.pose.translation,
                floor,
                typical,
            )
        )
        for label, motion in zip(thing.labels, thing.motions, strict=True):
            at = (labels == label) & sight.trusted
            nearer = scaled(motion, scale.value)
            inverse[at] = nearer.inverse_depth
            spread[at] = np.hypot(motion.spread, scale.spread)
            rotation[label] = nearer.pose.rotation
            translation[label] = nearer.pose.translation
            told[label] = _region(label, motion.kind, scale, int((labels == label).sum()))
    return World(sight, camera, labels, tuple(told), inverse, spread, rotation, translation)


def _region(label: int, kind: Kind, scale: Scale, pixels: int) -> Region:
    return Region(label, kind, scale.evidence, scale.confidence, scale.spread, pixels)


def _own_inverse_depth(labels: Labels, thing: Thing, trusted: Mask) -> Array:
    own = np.zeros(labels.shape)
    for label, motion in zip(thing.labels, thing.motions, strict=True):
        own[labels == label] = 1.0
        own[(labels == label) & trusted] = motion.inverse_depth
    return own


def answer(world: World, seen: Seen, clear: float) -> TwoFrame:
    """Return what is known of the world, and why the rest is not."""
    sight, labels, camera = world.sight, world.labels, world.camera
    rotation, translation = world.rotation[labels], world.translation[labels]
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
    along = _along(sight, camera)
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
    axes = np.array([np.asarray(cv2.Rodrigues(each)[0]).ravel() for each in world.rotation])
    nothing = np.where(seen.known, 0.0, np.nan)
    return TwoFrame(
        depth=np.where(known, 1 / np.where(known, inverse, 1.0), np.nan),
        rotation=axes[labels],
        translation=translation,
        labels=labels,
        regions=world.regions,
        moving=labels > 0,
        parallax=parallax + nothing,
        residual=residual + nothing,
        spread=np.where(known, world.spread, np.inf),
        unknown=unknown.astype(np.uint8),
        camera_motion=camera,
        prior_share=None,
        metric=False,
    )
