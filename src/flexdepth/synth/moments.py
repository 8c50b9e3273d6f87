"""A stage at a time: what is still is built once, and what moves is put beside it for each frame.

Embree finds in single precision which triangle a ray meets. Where on it is then computed again in
double precision, so that depth, flow and poses agree to far below a thousandth of a pixel.
"""

from dataclasses import dataclass, replace

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.materials import Part
from flexdepth.synth.movers import Mover
from flexdepth.synth.shapes import Array
from flexdepth.synth.stage import Stage, smooth_normals
from flexdepth.synth.viewpoints import Viewpoint

Single = NDArray[np.float32]

_SLACK = 0.01
"""How far outside its triangle, in barycentric weight, a point in double precision may lie."""


@dataclass(frozen=True, eq=False)
class TwoTracers:
    """What is still and what moves, traced as if they were one mesh.

    Attributes:
        still: What never moves.
        moving: What moves, where it is now.
        count: Triangles of what is still; those of what moves are numbered from there.
    """

    still: EmbreeScene
    moving: EmbreeScene
    count: int

    def run(
        self, origins: Single, directions: Single, query: str = "INTERSECT", output: int = 0
    ) -> object:
        """Return what `EmbreeScene.run` would for both meshes as one."""
        results = [
            tracer.run(origins, directions, query=query, output=output)
            for tracer in (self.still, self.moving)
        ]
        first, second = results
        if query == "DISTANCE":
            return np.minimum(first, second)
        if query == "OCCLUDED":
            return np.maximum(first, second)
        nearer = second["tfar"] < first["tfar"]
        second["primID"] = second["primID"] + self.count
        return {
            name: np.where(nearer[:, None] if of.ndim == 2 else nearer, second[name], of)
            for name, of in first.items()
        }


@dataclass(frozen=True, eq=False)
class Sight:
    """What rays of a camera meet.

    Attributes:
        rays: Rays by (x, y, 1), in the camera.
        triangle: Which one each meets; -1 is the sky.
        depth: z of the point, metres; +inf is the sky.
        weights: Of the triangle's three corners in the point.
    """

    rays: Array
    triangle: NDArray[np.intp]
    depth: Array
    weights: Array


@dataclass(frozen=True, eq=False)
class Moment:
    """A stage with its movers at one time.

    Attributes:
        stage: Ready for rays.
        still: Corners of the triangles that never move, metres.
        moving: Corners of the others now.
    """

    stage: Stage
    still: Array
    moving: Array

    def corners(self, triangle: NDArray[np.intp]) -> Array:
        """Return the corners of the numbered triangles."""
        out = np.empty((len(triangle), 3, 3))
        moves = triangle >= len(self.still)
        out[~moves] = self.still[triangle[~moves]]
        out[moves] = self.moving[triangle[moves] - len(self.still)]
        return out

    def sight(self, view: Viewpoint, rays: Array) -> Sight:
        """Return what rays of a camera meet; the third coordinate of each is 1 in the camera."""
        directions = rays @ view.world_from_camera.T
        origins = np.broadcast_to(view.eye.astype(np.float32), rays.shape).copy()
        found = self.stage.tracer.run(origins, directions.astype(np.float32), output=1)
        triangle = found["primID"].astype(np.intp)
        depth, weights = np.full(len(rays), np.inf), np.zeros((len(rays), 3))
        hit = triangle >= 0
        u, v = found["u"][hit].astype(float), found["v"][hit].astype(float)
        rough = found["tfar"][hit].astype(float), np.stack([1 - u - v, u, v], 1)
        corners = self.corners(triangle[hit])
        depth[hit], weights[hit] = _exact(corners, view.eye, directions[hit], rough)
        return Sight(rays, triangle, depth, weights)


def _exact(
    corners: Array, eye: Array, direction: Array, rough: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return the ray parameter and the weights of the corners, in double precision.

    A triangle seen edge on has no such point that is certain; there the rough answer stays.
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    square = (normal**2).sum(1)
    slant = (normal * direction).sum(1)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (normal * (a - eye)).sum(1) / slant
        point = eye + depth[:, None] * direction - a
        second = (np.cross(point, c - a) * normal).sum(1) / square
        third = (np.cross(b - a, point) * normal).sum(1) / square
    weights = np.stack([1 - second - third, second, third], 1)
    sure = (np.abs(weights - 0.5) <= 0.5 + _SLACK).all(1) & (depth > 0)
    return np.where(sure, depth, rough[0]), np.where(sure[:, None], weights, rough[1])


@dataclass(frozen=True, eq=False)
class Play:
    """A scene with what moves in it.

    Attributes:
        stage: The scene at rest, with the movers' materials.
        still: Corners of the triangles that never move, metres.
        movers: What moves.
        owner: Of each moving triangle, the number of its mover.
    """

    stage: Stage
    still: Array
    movers: tuple[Mover, ...]
    owner: NDArray[np.intp]

    @classmethod
    def of(cls, rng: Generator, stage: Stage, still: Array, movers: tuple[Mover, ...]) -> "Play":
        """Return movers in a scene that is ready for rays; `still` are its corners."""
        meshes = [mover.body.meshes(0.0) for mover in movers]
        parts = [
            Part(mesh, look)
            for mover, own in zip(movers, meshes, strict=True)
            for mesh, look in zip(own, mover.body.looks, strict=True)
        ]
        counts = [sum(len(mesh.corners) for mesh in own) for own in meshes]
        owner = np.repeat(np.arange(len(movers)), counts)
        return cls(_with_parts(rng, stage, parts), still, movers, owner)

    def at(self, time: float) -> Moment:
        """Return the scene after `time` seconds."""
        meshes = [mesh for mover in self.movers for mesh in mover.body.meshes(time)]
        moving = np.concatenate([np.empty((0, 3, 3)), *(mesh.corners for mesh in meshes)])
        tracer = EmbreeScene()
        TriangleMesh(tracer, moving.astype(np.float32))
        both = TwoTracers(self.stage.tracer, tracer, len(self.still))
        normals = np.concatenate([self.stage.normals[: len(self.still)], smooth_normals(meshes)])
        return Moment(replace(self.stage, tracer=both, normals=normals), self.still, moving)


def _with_parts(rng: Generator, stage: Stage, parts: list[Part]) -> Stage:
    """Return a stage that knows the looks of more parts; they are not in its mesh."""
    if not parts:
        return stage
    more = Stage.built(rng, replace(stage.scene, parts=parts), stage.library)
    return replace(
        stage,
        uv=np.concatenate([stage.uv, more.uv]),
        normals=np.concatenate([stage.normals, more.normals]),
        material=np.concatenate([stage.material, more.material + len(stage.colours)]),
        colours=np.concatenate([stage.colours, more.colours]),
        size=np.concatenate([stage.size, more.size]),
        glow=np.concatenate([stage.glow, more.glow]),
        gloss=np.concatenate([stage.gloss, more.gloss]),
        rough=np.concatenate([stage.rough, more.rough]),
        ripple=np.concatenate([stage.ripple, more.ripple]),
        layer=np.concatenate([stage.layer, more.layer]),
    )
