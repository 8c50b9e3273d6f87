"""The world as a few regions with a motion each."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence, Kind, Region
from flexdepth.solvers.body import ball, tipping
from flexdepth.solvers.borders import Surroundings, border, nearness_beside, surroundings
from flexdepth.solvers.clues import Clues
from flexdepth.solvers.correspondences import Correspondences, from_flow
from flexdepth.solvers.criterion import MotionKind
from flexdepth.solvers.ego_motion import CameraMotion, camera_motion, forward
from flexdepth.solvers.epipolar import Epipolar
from flexdepth.solvers.ground import Ground, ground
from flexdepth.solvers.least_squares import cost, refined, squares
from flexdepth.solvers.ordering import Still, with_sunk
from flexdepth.solvers.pictured import Pictured, pictured
from flexdepth.solvers.pictures import standing, told_by_pictures
from flexdepth.solvers.pieces import Labels, pieces
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.regions import filled, moving_regions
from flexdepth.solvers.relative_scale import Scale, relative_scale
from flexdepth.solvers.seen import Prior, Seen
from flexdepth.solvers.sight import Sight
from flexdepth.solvers.still import looked_again
from flexdepth.solvers.things import Thing, middle_motion, own_turn, scaled, things, wobble
from flexdepth.solvers.two_view import Along, seen_along
from flexdepth.solvers.world import World, along_of, sight_of

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_BODY = 0.2
"""The least size of a body, in that of its part."""

_LOWEST = 0.05
"""The rows that are the lowest part of a thing, as a part of all."""

_TELLS = (Evidence.CONTACT, Evidence.MOTION, Evidence.PRIOR)
"""What tells enough of a thing's scale that those of its parts may hang on it."""

_PULLS = 3.0
"""Standard deviations at which a pixel stops pulling at the camera's motion."""

_CLEAR = 2.0
"""Standard deviations of negative parallax that put a match behind the camera."""

_FAR = 1e12
"""The squared residual of what no motion explains."""

_WAYS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [3, 0, 2], [3, 0, -2], [0, 3, 2], [0, 3, -2]])
"""Ways that the camera may have gone, to begin with."""


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
    every = from_flow(seen.flow, trusted, seen.noise, seen.camera)
    camera = _likelier(camera_motion(every), every)
    along = along_of(sight, camera)
    cut = pieces(sight.flow, along.across, float(np.median(sight.noise[trusted])), seen.image)
    moving = moving_regions(cut, sight.flow, along, sight.noise, trusted)
    still = trusted & (moving.labels == 0)
    if moving.labels.any() and still.sum() > 0.2 * trusted.sum():
        camera = _refined(camera, from_flow(seen.flow, still, seen.noise, seen.camera))
        along = along_of(sight, camera)
        moving = moving_regions(cut, sight.flow, along, sight.noise, trusted)
    if seen.image is not None and seen.target is not None:
        labels = told_by_pictures(
            moving.labels, sight, standing(sight, camera), (seen.image, seen.target)
        )
        sight = replace(sight, trusted=trusted & ((labels > 0) | (moving.labels == 0)))
        labels, sight = looked_again(seen, sight, labels, camera)
        moving, along = replace(moving, labels=labels), along_of(sight, camera)
    all_moving = filled(with_sunk(Still(cut, moving.labels, along), sight), sight.trusted)
    least = clear * sight.noise * camera.noise_factor
    floor = ground(sight.key, along.inverse_depth, _static(sight, all_moving, along, least))
    sight = replace(sight, down=None if floor is None else floor.normal)
    labels, found = things(all_moving, cut, sight, camera.pose, moving.strays)
    return _scaled_world(sight, _Stage(camera, along, floor, clear, seen.prior), labels, found)


def _likelier(camera: CameraMotion, every: Correspondences) -> CameraMotion:
    """Return the motion, before a plane, that explains more of what lies outside of the plane.

    What is near stands out of a plane; without it hardly anything says which way the camera went,
    so that all ways are tried. What a motion puts behind the camera it does not explain.
    """
    if camera.kind is not MotionKind.PLANE:
        return camera
    epipolar = Epipolar(*every.rays(), every.focal, every.noise * camera.noise_factor)
    begun = [camera.pose, *([] if camera.alternative is None else [camera.alternative])]
    begun += [Pose(camera.pose.rotation, way / np.linalg.norm(way)) for way in _WAYS]
    found = [forward(refined(epipolar, pose, _PULLS), epipolar) for pose in begun]
    return replace(camera, pose=min(found, key=lambda pose: _unexplained(pose, epipolar)))


def _unexplained(pose: Pose, epipolar: Epipolar) -> float:
    """Return the cost of a motion: a match behind the camera costs as much as any can."""
    along = seen_along(epipolar.key, epipolar.target, pose, epipolar.focal)
    behind = along.parallax < -_CLEAR * epipolar.noise
    return cost(np.where(behind, _FAR, squares(epipolar, pose)), _PULLS)


def _refined(camera: CameraMotion, still: Correspondences) -> CameraMotion:
    """Return the camera's motion at what is still: nothing that moves pulls at it any more."""
    if not camera.translates:
        return camera
    epipolar = Epipolar(*still.rays(), still.focal, still.noise * camera.noise_factor)
    return replace(camera, pose=refined(epipolar, camera.pose, _PULLS))


@dataclass(frozen=True, eq=False)
class _Stage:
    """The static world that things move in.

    Attributes:
        camera: The camera's motion.
        along: What the flow says of depth, were all still.
        floor: The ground, if one is seen.
        clear: Standard deviations of parallax that make a depth.
        prior: What the key frame alone tells, if that is known.
    """

    camera: CameraMotion
    along: Along
    floor: Ground | None
    clear: float
    prior: Prior | None


@dataclass(frozen=True, eq=False)
class _Beside:
    """What a thing is seen beside.

    Attributes:
        around: The static world.
        typical: ln of its typical inverse depth.
        picture: What a single picture says of depth, in the unit of the static world.
    """

    around: Surroundings
    typical: float
    picture: Pictured | None


@dataclass(frozen=True, eq=False)
class _SeenThing:
    """A thing, where it is seen, its inverse depth at scale 1, and what tells of its scale."""

    thing: Thing
    inside: Mask
    own: Array
    clues: Clues


def _scaled_world(sight: Sight, stage: _Stage, labels: Labels, found: list[Thing]) -> World:
    camera, along = stage.camera, stage.along
    noise = sight.noise * camera.noise_factor
    static = _static(sight, labels, along, stage.clear * noise)
    inverse = np.where(labels == 0, along.inverse_depth, np.nan)
    spread = np.where(static, along.spread * noise, np.inf)
    around = surroundings(np.where(static, inverse, 0.0), static, sight.flow, sight.trusted)
    typical = float(np.log(np.median(inverse[static]))) if static.any() else 0.0
    beside = _Beside(around, typical, _picture(stage.prior, inverse, spread, static))
    count = int(labels.max()) + 1
    rotation = np.broadcast_to(camera.pose.rotation, (count, 3, 3)).copy()
    translation = np.broadcast_to(camera.pose.translation, (count, 3)).copy()
    told = [Region(0, Kind.STATIC, Evidence.CAMERA, 1.0, 0.0, int((labels == 0).sum()))] * count
    seen = [_clues(sight, stage, labels, thing, beside) for thing in found]
    movers = np.full(labels.shape, np.nan)
    scales = {each: relative_scale(each.clues) for each in seen}
    while scales:
        each = min(scales, key=lambda one: scales[one].spread)
        scale = scales.pop(each)
        if scale.evidence in _TELLS:
            movers[each.inside] = scale.value * each.own[each.inside]
            for other in scales:
                joined = _joined(other, movers, around)
                scales[other] = relative_scale(replace(other.clues, beside=joined))
        for label, motion in zip(each.thing.labels, each.thing.motions, strict=True):
            at = (labels == label) & sight.trusted
            nearer = scaled(motion, scale.value)
            inverse[at] = nearer.inverse_depth
            spread[at] = motion.spread
            rotation[label] = nearer.pose.rotation
            translation[label] = nearer.pose.translation
            told[label] = _region(label, motion.kind, scale, int((labels == label).sum()))
    return World(
        sight, camera, labels, tuple(told), inverse, spread, rotation[labels], translation[labels]
    )


def _picture(prior: Prior | None, inverse: Array, spread: Array, static: Mask) -> Pictured | None:
    """Return what the prior says in the unit of the static world; None if nothing ties the two."""
    if prior is None:
        return None
    picture = pictured(prior)
    found = picture.unit(inverse, spread, static)
    if found is None:
        return None
    return replace(picture, inverse_depth=picture.inverse_depth * found[0])


def _joined(seen: _SeenThing, movers: Array, around: Surroundings) -> float | None:
    """Return ln s at which a thing is as near as the moving things that it is joined to."""
    if np.isfinite(movers).sum() < seen.inside.sum() * _BODY:
        return None
    ratio = nearness_beside(seen.inside, seen.own, movers, around)
    return float(np.log(ratio)) if ratio is not None and ratio > 0 else None


def _static(sight: Sight, labels: Labels, along: Along, least: Array) -> Mask:
    """Return where the static world has a depth.

    Args:
        sight: What is seen.
        labels: 0 is the static world.
        along: What the flow says of depth, were all still.
        least: Pixels of parallax that make a depth.
    """
    known = (along.parallax > least) & (along.inverse_depth > 0)
    return np.asarray(known & sight.trusted & (labels == 0))


def _clues(
    sight: Sight, stage: _Stage, labels: Labels, thing: Thing, beside: _Beside
) -> _SeenThing:
    """Return what is seen of one thing."""
    pose = stage.camera.pose
    own = _own_inverse_depth(labels, thing, sight.trusted)
    inside = np.isin(labels, thing.labels) & sight.trusted
    counts = np.array([(labels == each).sum() for each in thing.labels], np.float64)
    middles = np.array([sight.key[labels == each].mean(axis=0) for each in thing.labels])
    size = float(np.sqrt(inside.sum() / sight.focal.prod()))
    points = sight.key[inside] / own[inside][:, None]
    turn = own_turn(thing, pose)
    sphere = ball(points, size) if thing.kind is Kind.RIGID else None
    if sphere is None:
        moved = middle_motion(thing, counts, middles, pose)
        unsure = wobble(thing, sight, labels, turn)
    else:
        moved, unsure = sphere.moved(thing.motions[0].pose, pose), sphere.wobble(turn)
    clues = Clues(
        kind=thing.kind,
        border=border(inside, own, beside.around, (labels > 0) & ~np.isin(labels, thing.labels)),
        motion=moved,
        turn=turn,
        wobble=unsure,
        way=pose.rotation.T @ pose.translation,
        floor=stage.floor,
        typical=beside.typical,
        size=size,
        rest=None if sphere is None or stage.floor is None else sphere.at_rest(stage.floor),
        foot=None if stage.floor is None else _foot(inside, own, sight.key @ stage.floor.plane),
        tips=_tips(sight, stage, thing, inside),
        told=None if beside.picture is None else beside.picture.of_thing(inside, own),
    )
    return _SeenThing(thing, inside, own, clues)


def _tips(sight: Sight, stage: _Stage, thing: Thing, inside: Mask) -> tuple[float, float] | None:
    """Return how far a rigid thing tips over, and how uncertain its flow is, as `Clues` has it."""
    if thing.kind is not Kind.RIGID or stage.floor is None:
        return None
    noise = stage.camera.noise_factor * float(np.median(sight.noise[inside]))
    tips = tipping(thing.motions[0].pose, stage.camera.pose, stage.floor)
    return tips, noise / float(np.sqrt(inside.mean()) * sight.focal.mean())


def _foot(inside: Mask, own: Array, floor: Array) -> float | None:
    """Return ln s at which the lowest that is seen of a thing is on the ground.

    Args:
        inside: Where the thing is.
        own: Its inverse depth at scale 1.
        floor: The ground's inverse depth along each ray.
    """
    rows = np.flatnonzero(inside.any(axis=1))
    lowest = inside & (own > 0)
    lowest[: rows[-1] - round(_LOWEST * len(rows))] = False
    if not lowest.any():
        return None
    ratio = float(np.median(floor[lowest] / own[lowest]))
    return float(np.log(ratio)) if ratio > 0 else None


def _region(label: int, kind: Kind, scale: Scale, pixels: int) -> Region:
    return Region(label, kind, scale.evidence, scale.confidence, scale.spread, pixels)


def _own_inverse_depth(labels: Labels, thing: Thing, trusted: Mask) -> Array:
    own = np.zeros(labels.shape)
    for label, motion in zip(thing.labels, thing.motions, strict=True):
        own[labels == label] = 1.0
        own[(labels == label) & trusted] = motion.inverse_depth
    return own
