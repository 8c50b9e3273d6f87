"""A scene made ready for rays, and what rays meet in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.library import Library
from flexdepth.synth.materials import Material
from flexdepth.synth.scene import Scene
from flexdepth.synth.shapes import Mesh

Array = NDArray[np.float32]

OFFSET = 2e-3
"""Metres by which a secondary ray starts off its surface, so that it does not hit it."""

_CREASE = 0.85
"""Faces whose normals have at least this cosine with their corner's mean are shaded as one."""


@dataclass(frozen=True, eq=False)
class Hits:
    """The first surface along each ray that meets one.

    Attributes:
        ray: Index of the ray.
        point: Position, moved off the surface towards the viewer.
        normal: Unit normal of the triangle, towards the viewer.
        shading: Unit normal of the smooth surface that the triangles stand for.
        towards: Unit vector to the viewer.
        triangle: Index of the triangle.
        uv: Texture coordinates, metres.
        footprint: Metres of surface that one pixel covers.
    """

    ray: NDArray[np.intp]
    point: Array
    normal: Array
    shading: Array
    towards: Array
    triangle: NDArray[np.intp]
    uv: Array
    footprint: Array


@dataclass(frozen=True, eq=False)
class Stage:
    """A scene made ready for rays: one mesh, one table of materials.

    Attributes:
        scene: What it shows.
        tracer: Finds what rays meet.
        uv: Texture coordinates of each triangle's corners.
        normals: Shading normals there.
        material: The material of each triangle, a row of the tables that follow.
        colours: Four colours of each material: the three that it scatters back or emits, then the
            share of light from behind that passes it.
        size: Metres after which its texture repeats.
        glow: Light it emits.
        gloss: Share of the light that it mirrors.
        rough: How uneven a glossy surface is.
        ripple: How steep its waves are.
        layer: Its texture in the library.
        library: The textures.
    """

    scene: Scene
    tracer: EmbreeScene
    uv: Array
    normals: Array
    material: NDArray[np.intp]
    colours: Array
    size: Array
    glow: Array
    gloss: Array
    rough: Array
    ripple: Array
    layer: NDArray[np.intp]
    library: Library

    @classmethod
    def built(cls, rng: Generator, scene: Scene, library: Library) -> "Stage":
        """Return the scene with its acceleration structure built."""
        meshes = [part.mesh for part in scene.parts]
        tracer = EmbreeScene()
        TriangleMesh(tracer, np.concatenate([m.corners for m in meshes]).astype(np.float32))
        materials = [part.material for part in scene.parts]
        counts = [len(mesh.corners) for mesh in meshes]
        return cls(
            scene=scene,
            tracer=tracer,
            uv=np.concatenate([mesh.uv for mesh in meshes]).astype(np.float32),
            normals=smooth_normals(meshes),
            material=np.repeat(np.arange(len(counts)), counts),
            colours=np.array([_four_colours(m) for m in materials], np.float32),
            size=np.array([m.size for m in materials], np.float32),
            glow=np.array([m.glow for m in materials], np.float32),
            gloss=np.array([m.gloss for m in materials], np.float32),
            rough=np.array([m.rough for m in materials], np.float32),
            ripple=np.array([m.ripple for m in materials], np.float32),
            layer=np.array([library.layer(rng, m.pattern) for m in materials]),
            library=library,
        )

    def passing(self, triangle: NDArray[np.intp]) -> Array:
        """Return the share of light that passes each of the triangles: red, green, blue."""
        return np.asarray(self.colours[self.material[triangle], 3])

    def clear(self, triangle: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return whether light passes each of the triangles."""
        passes = np.asarray(self.colours[:, 3] > 0).any(axis=1)
        return np.asarray(passes)[self.material[triangle]]

    @property
    def glazed(self) -> bool:
        """Whether light passes anything in it."""
        return bool(self.colours[:, 3].any())

    def hits(
        self, origins: Array, directions: Array, focal: float, gone: Array | float = 0.0
    ) -> tuple[Hits, Array]:
        """Return what rays meet first, and the ray parameter of each; +inf where nothing is.

        A pixel covers ray parameter / focal metres of a surface that faces the ray; a ray that
        has come a part of its way before its origin has `gone` more.
        """
        found = self.tracer.run(origins, directions, output=1)
        ray = np.flatnonzero(found["primID"] >= 0)
        far = np.full(len(directions), np.inf, np.float32)
        far[ray] = found["tfar"][ray]
        away = directions[ray]
        towards = -unit(away)
        triangle = found["primID"][ray].astype(np.intp)
        weights = np.stack(
            [1 - found["u"][ray] - found["v"][ray], found["u"][ray], found["v"][ray]], 1
        )
        normal = _facing(unit(found["Ng"][ray]), towards)
        shading = _facing(unit(_mixed(weights, self.normals[triangle])), towards)
        slant = dot(normal, towards)
        hits = Hits(
            ray=ray,
            point=origins[ray] + far[ray, None] * away + OFFSET * normal,
            normal=normal,
            shading=shading,
            towards=towards,
            triangle=triangle,
            uv=_mixed(weights, self.uv[triangle]),
            footprint=((far + gone)[ray] / focal / np.sqrt(np.maximum(slant, 0.02))).astype(
                np.float32
            ),
        )
        return hits, far


def _four_colours(look: Material) -> NDArray[np.float64]:
    """Return what a material scatters back or emits, three colours, and what passes it."""
    through = look.clear * look.colours.mean(0)
    return np.concatenate([(1 - look.clear) * look.colours, through[None]])


def smooth_normals(meshes: Sequence[Mesh]) -> Array:
    """Return shading normals, triangles by three corners by (x, y, z).

    Faces of one mesh that meet at a corner share its normal, unless they meet at a crease.
    """
    if not meshes:
        return np.empty((0, 3, 3), np.float32)
    corners = np.concatenate([mesh.corners for mesh in meshes])
    owner = np.repeat(np.arange(len(meshes)), [3 * len(mesh.corners) for mesh in meshes])
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    place = np.round(corners.reshape(-1, 3) * 5e4).astype(np.int64)
    key = place @ np.array([73856093, 19349663, 83492791]) + owner * 2654435761
    _, vertex = np.unique(key, return_inverse=True)
    own = np.repeat(unit(flat.astype(np.float32)), 3, axis=0)
    sums = np.stack([np.bincount(vertex, weights=axis) for axis in own.T], 1)
    mean = unit(sums[vertex].astype(np.float32))
    same = dot(mean, own)[:, None] > _CREASE
    return np.where(same, mean, own).reshape(-1, 3, 3).astype(np.float32)


def dot(first: Array, second: Array) -> Array:
    """Return the scalar product of each pair of rows."""
    return np.asarray(np.einsum("ij,ij->i", first, second), np.float32)


def unit(vectors: Array) -> Array:
    """Return the rows scaled to length 1."""
    length = np.sqrt(np.maximum(dot(vectors, vectors), 1e-30))
    return np.asarray(vectors / length[:, None], np.float32)


def _mixed(weights: Array, corners: Array) -> Array:
    return np.asarray(np.einsum("nk,nkc->nc", weights, corners), np.float32)


def _facing(normal: Array, towards: Array) -> Array:
    """Return the normals turned to the viewer's side."""
    return np.where(dot(normal, towards)[:, None] < 0, -normal, normal).astype(np.float32)
