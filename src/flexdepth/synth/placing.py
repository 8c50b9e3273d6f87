"""Where movers are put so that they are seen, stand on the ground and run into nothing."""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.random import Generator

from flexdepth.synth.correspondence import Camera
from flexdepth.synth.courses import Course
from flexdepth.synth.motion import Footing
from flexdepth.synth.movers import Ground, Kind, Mover, kinds
from flexdepth.synth.shapes import Array
from flexdepth.synth.solids import Solid, unlit
from flexdepth.synth.stage import Stage

_SPOTS = 64
"""Spots that are looked at for one mover."""

_PLACES = 12
"""Level spots of them that are tried."""

_CLEAR = 0.03
"""Metres above the ground below which nothing is in a mover's way."""

_PROBE = 1.9
"""Height from which the ground is looked for: below ceilings, above what nobody walks through."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """A scene that movers are put into.

    Attributes:
        stage: The scene, ready for rays.
        still: Corners of its triangles.
        low: The least coordinates: x, y, z by triangles.
        high: The greatest.
    """

    stage: Stage
    still: Array
    low: Array
    high: Array

    @classmethod
    def of(cls, stage: Stage) -> "Surroundings":
        """Return a stage with its triangles in double precision."""
        still = np.concatenate([part.mesh.corners for part in stage.scene.parts])
        return cls(stage, still, still.min(1).T.copy(), still.max(1).T.copy())

    @property
    def grounds(self) -> tuple[Ground, ...]:
        """What movers may move on here."""
        scene = self.stage.scene
        if not scene.outdoors:
            return (Ground.FLOOR,)
        return (Ground.OPEN, Ground.ROAD) if scene.road > 0 else (Ground.OPEN,)

    def level(self, spots: Array) -> Array:
        """Return the height of what is below each (x, z), looked at from above head height."""
        above = np.insert(spots, 1, _PROBE, axis=1).astype(np.float32)
        down = np.broadcast_to(np.array([0, -1, 0], np.float32), above.shape).copy()
        return _PROBE - np.asarray(self.stage.tracer.run(above, down, query="DISTANCE"), float)

    def free(self, box: Array) -> bool:
        """Return whether no triangle's box meets a box, given by its low and its high corner."""
        near = np.flatnonzero(self.low[0] < box[1, 0])
        for axis in (0, 2, 1):
            near = near[
                (self.low[axis, near] < box[1, axis]) & (self.high[axis, near] > box[0, axis])
            ]
        return not near.size


@dataclass(frozen=True, eq=False)
class Placed:
    """A mover that has its place.

    Attributes:
        mover: It.
        footing: What is to be seen of its feet.
        boxes: Its boxes at some times: times by low and high by 3.
    """

    mover: Mover
    footing: Footing
    boxes: Array


def placed(
    rng: Generator,
    around: Surroundings,
    camera: Camera,
    role: tuple[bool, Footing, float],
    times: Array,
) -> Placed | None:
    """Return a mover that has room in front of a camera; None where none is found.

    Args:
        rng: Draws it.
        around: The scene.
        camera: The first frame's.
        role: Whether it bends, its footing, and the share of the picture that it is to fill.
        times: When it must have room.
    """
    bends, footing, share = role
    choice = kinds(bends, footing is not Footing.NONE, around.grounds)
    kind, ground = choice[int(rng.integers(len(choice)))]
    filled = max(share, 1e-3) * camera.width * camera.height
    ahead = camera.focal * float(np.sqrt(kind.area / filled)) * rng.uniform(0.7, 1.4, _SPOTS)
    spots = _spots(rng, camera, ahead)
    if ground is Ground.ROAD:
        lane = np.sign(spots[:, 0]) * around.stage.scene.road
        spots[:, 0] = lane * rng.uniform(0.22, 0.5, _SPOTS)
    for attempt, spot in enumerate(_level_ones(around, spots, kind.stands)[:_PLACES]):
        course = _course(rng, (kind, ground), spot, 1 - attempt / _PLACES)
        body = kind.make(rng, course)
        if isinstance(body, Solid) and not around.stage.scene.dark:
            body = unlit(body)
        mover = Mover(kind, body)
        boxes = _free_boxes(around, mover, times)
        if boxes is not None and not _holds(boxes, camera.view.eye):
            return Placed(mover, footing, boxes)
    return None


def _spots(rng: Generator, camera: Camera, ahead: Array) -> Array:
    """Return a point so far ahead of the camera for each distance, somewhere across the picture."""
    across = rng.uniform(-0.4, 0.4, len(ahead)) * camera.width / camera.focal
    rays = np.stack([across, 0 * across, 1 + 0 * across], 1)
    sight = rays @ camera.view.world_from_camera.T
    flat = np.linalg.norm(sight[:, [0, 2]], axis=1)
    return np.asarray(camera.view.eye + (np.clip(ahead, 0.6, 45.0) / flat)[:, None] * sight)


def _level_ones(around: Surroundings, spots: Array, stands: bool) -> Array:
    """Return the spots that have the floor or the ground below them, put onto it."""
    reach = 0.25 if stands else 0.0
    corners = reach * np.array([(0, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)])
    level = around.level((spots[:, None, [0, 2]] + corners).reshape(-1, 2)).reshape(-1, 5)
    highest = 0.2 if around.stage.scene.outdoors else 0.05
    good = (np.ptp(level, axis=1) < 0.004) & (level[:, 0] >= -0.05) & (level[:, 0] <= highest)
    on_it = np.stack([spots[:, 0], level[:, 0], spots[:, 2]], 1)
    return np.asarray(on_it[good])


def _course(rng: Generator, role: tuple[Kind, Ground], spot: Array, haste: float) -> Course:
    """Return a course that begins at a spot; on a road it keeps to the right-hand lane."""
    kind, ground = role
    heading, turning = rng.uniform(0, 2 * pi), rng.normal(0, 0.25)
    if ground is Ground.ROAD:
        heading = (pi if spot[0] > 0 else 0.0) + rng.normal(0, 0.03)
        turning = rng.normal(0, 0.02)
    return Course(spot, float(heading), float(haste * rng.uniform(*kind.speed)), float(turning))


def _free_boxes(around: Surroundings, mover: Mover, times: Array) -> Array | None:
    """Return the boxes of a mover at some times; None where one is not free."""
    boxes = []
    for time in times:
        boxes.append(_box(mover, time))
        if not around.free(boxes[-1]):
            return None
    return np.array(boxes)


def _box(mover: Mover, time: float) -> Array:
    """Return the low and the high corner of what must be free for a mover."""
    corners = np.concatenate([mesh.corners.reshape(-1, 3) for mesh in mover.body.meshes(time)])
    low, high = corners.min(0), corners.max(0)
    return np.stack([low + np.array([0, _CLEAR, 0]), high])


def apart(placed_ones: list[Placed]) -> bool:
    """Return whether movers never meet."""
    for k, one in enumerate(placed_ones):
        for other in placed_ones[:k]:
            meets = (one.boxes[:, 0] < other.boxes[:, 1]) & (one.boxes[:, 1] > other.boxes[:, 0])
            if meets.all(1).any():
                return False
    return True


def _holds(boxes: Array, eye: Array) -> bool:
    return bool(((boxes[:, 0] < eye) & (boxes[:, 1] > eye)).all(1).any())
