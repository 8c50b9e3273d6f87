"""Moving regions as things: which belong together, how each moves, and its shape."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Kind
from flexdepth.solvers.borders import goes_on, grown
from flexdepth.solvers.pieces import Labels
from flexdepth.solvers.pose import Pose, angle, own_motion
from flexdepth.solvers.region_motion import (
    RegionMotion,
    explained,
    flexible_motion,
    region_motion,
)
from flexdepth.solvers.rigid_parts import split
from flexdepth.solvers.sight import Sight

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_PART = 0.5
"""A rigid region smaller than this share of a bending one that it touches is a part of it."""


_UNSEEN = 0.12
"""How far the middle of a thing is from where it is taken to be, in widths."""


@dataclass(frozen=True, eq=False)
class Thing:
    """Regions that have one scale, as the limbs of a body have.

    Attributes:
        labels: Numbers of the regions.
        motions: Of each.
    """

    labels: tuple[int, ...]
    motions: tuple[RegionMotion, ...]

    @property
    def kind(self) -> Kind:
        """Rigid where one rigid motion is all there is."""
        single = len(self.motions) == 1 and self.motions[0].kind is Kind.RIGID
        return Kind.RIGID if single else Kind.FLEXIBLE


def things(
    labels: Labels, cut: Labels, sight: Sight, camera: Pose, floor: float
) -> tuple[Labels, list[Thing]]:
    """Return regions, some of them parted or put together, and the things that they make up.

    Rigid parts of what bends become regions of their own. Regions that one rigid motion explains
    become one, wherever they are: something may stand between them. Bending regions that touch
    have one scale.

    Args:
        labels: Of the moving regions, 0 is still.
        cut: Pieces of the frame.
        sight: What is seen.
        camera: Its motion.
        floor: Pixels that what is still is off its epipolar lines.
    """
    motions = {
        label: region_motion(sight.pixels(labels == label), camera, floor)
        for label in range(1, int(labels.max()) + 1)
        if (sight.trusted & (labels == label)).sum() >= 12
    }
    labels = np.where(np.isin(labels, list(motions)), labels, 0).astype(np.int32)
    labels, motions = split(labels, motions, cut, sight, (camera, floor))
    labels, motions = _renumbered(*_same_motion(labels, motions, sight, (camera, floor)))
    groups = _touching(labels, motions, sight.flow)
    found = []
    for group in groups:
        members = [(each, motions[each]) for each in group]
        if len(group) > 1:
            members = [
                (
                    each,
                    motion
                    if motion.kind is Kind.FLEXIBLE
                    else _bending(sight, labels, each, camera),
                )
                for each, motion in members
            ]
        found.append(Thing(tuple(each for each, _ in members), tuple(m for _, m in members)))
    return labels, found


def _bending(sight: Sight, labels: Labels, label: int, camera: Pose) -> RegionMotion:
    return flexible_motion(sight.pixels(labels == label), camera)


def _same_motion(
    labels: Labels,
    motions: dict[int, RegionMotion],
    sight: Sight,
    context: tuple[Pose, float],
) -> tuple[Labels, dict[int, RegionMotion]]:
    """Return the regions with those joined to a larger rigid one whose motion explains them."""
    camera, floor = context
    labels, motions = labels.copy(), dict(motions)
    for label in sorted(motions):
        if label not in motions or motions[label].kind is not Kind.RIGID:
            continue
        joined = False
        for other in [each for each in motions if _may_join(motions, each, label)]:
            if explained(sight.pixels(labels == other), motions[label].pose, floor):
                labels[labels == other] = label
                del motions[other]
                joined = True
        if joined:
            motions[label] = region_motion(sight.pixels(labels == label), camera, floor)
    return labels, motions


def _may_join(motions: dict[int, RegionMotion], other: int, label: int) -> bool:
    """Return whether a region may join a rigid one: smaller ones, and what no motion explained."""
    return other > label or (other != label and motions[other].kind is Kind.FLEXIBLE)


def _renumbered(
    labels: Labels, motions: dict[int, RegionMotion]
) -> tuple[Labels, dict[int, RegionMotion]]:
    """Return the same with numbers that leave none out."""
    number = np.zeros(int(labels.max()) + 1, np.int32)
    number[sorted(motions)] = np.arange(1, len(motions) + 1)
    return number[labels], {int(number[each]): motions[each] for each in sorted(motions)}


def _touching(labels: Labels, motions: dict[int, RegionMotion], flow: Array) -> list[list[int]]:
    """Return groups of labels: bending regions that touch, and small rigid parts of them.

    A car that passes behind a person touches the person in the picture, but no motion goes on.
    """
    size = np.bincount(labels.ravel(), minlength=max(motions, default=0) + 1)
    group = {label: {label} for label in motions}
    for label in sorted(motions, key=lambda each: -size[each]):
        if motions[label].kind is not Kind.FLEXIBLE:
            continue
        touched = np.bincount(labels[grown(labels == label)], minlength=len(size))
        for other in np.flatnonzero(touched >= 6).tolist():
            if other in (0, label) or other not in motions:
                continue
            small = size[other] < _PART * size[label]
            if motions[other].kind is Kind.FLEXIBLE or (
                small and goes_on(labels == label, labels == other, flow)
            ):
                both = group[label] | group[other]
                for each in both:
                    group[each] = both
    unique = {min(members): sorted(members) for members in group.values()}
    return list(unique.values())


def middle_motion(thing: Thing, counts: Array, rays: Array, camera: Pose) -> Array:
    """Return a: how the thing's middle moves, the camera's turning undone, at scale 1.

    The middle of what turns lies at the depth of its rim, not of the front that is seen.

    Args:
        thing: With its motions.
        counts: Pixels of each region.
        rays: The mean ray of each.
        camera: The camera's own motion.
    """
    moved = []
    for motion, ray in zip(thing.motions, rays, strict=True):
        rim = np.quantile(motion.inverse_depth, 0.1) if motion.kind is Kind.RIGID else 1.0
        moved.append(own_motion(ray / rim, motion.pose, camera))
    return np.asarray(np.average(moved, axis=0, weights=counts))


def own_turn(thing: Thing, camera: Pose) -> float:
    """Return how far a rigid thing turns by itself, radians; 0 for what bends."""
    if thing.kind is not Kind.RIGID:
        return 0.0
    return angle(thing.motions[0].pose.rotation @ camera.rotation.T)


def wobble(thing: Thing, sight: Sight, labels: Labels, turn: float) -> float:
    """Return how far `middle_motion` is uncertain: what turns does so about an unseen middle."""
    if turn == 0:
        return 0.0
    return _UNSEEN * turn * sight.pixels(labels == thing.labels[0]).width()


def scaled(motion: RegionMotion, scale: float) -> RegionMotion:
    """Return the same flow, nearer by a factor: ρ times it, t over it."""
    pose = Pose(motion.pose.rotation, motion.pose.translation / scale)
    return replace(motion, pose=pose, inverse_depth=motion.inverse_depth * scale)
