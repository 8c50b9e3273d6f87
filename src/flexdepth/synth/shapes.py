"""Triangle meshes from a few parameters: the vocabulary that furniture and streets are built of.

Lengths are metres, y is up. Texture coordinates are metres along the surface, so that a material
keeps its size on whatever it is put.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import cos, pi, sin

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles with texture coordinates.

    Attributes:
        corners: Triangles by three corners by (x, y, z), metres.
        uv: Triangles by three corners by two texture coordinates, metres.
    """

    corners: Array
    uv: Array

    def placed(self, at: ArrayLike, yaw: float = 0.0) -> "Mesh":
        """Return the mesh turned by `yaw` about the vertical axis, then moved to `at`."""
        return Mesh(self.corners @ turn(yaw).T + np.asarray(at, float), self.uv)

    def turned(self, rotation: Array) -> "Mesh":
        """Return the mesh rotated about the origin."""
        return Mesh(self.corners @ rotation.T, self.uv)

    def scaled(self, factors: ArrayLike) -> "Mesh":
        """Return the mesh stretched along x, y and z; the texture stretches with it."""
        return Mesh(self.corners * np.asarray(factors, float), self.uv)


def turn(yaw: float) -> Array:
    """Return the rotation about the vertical axis that takes z towards x."""
    return np.array([[cos(yaw), 0, sin(yaw)], [0, 1, 0], [-sin(yaw), 0, cos(yaw)]])


def tilt(pitch: float) -> Array:
    """Return the rotation about the x axis that takes y towards z."""
    return np.array([[1, 0, 0], [0, cos(pitch), -sin(pitch)], [0, sin(pitch), cos(pitch)]])


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Return all triangles as one mesh."""
    return Mesh(np.concatenate([m.corners for m in meshes]), np.concatenate([m.uv for m in meshes]))


def quad(origin: ArrayLike, along: ArrayLike, up: ArrayLike) -> Mesh:
    """Return the parallelogram with a corner at `origin` and the two given sides."""
    o, a, b = (np.asarray(v, float) for v in (origin, along, up))
    u, v = np.linalg.norm(a), np.linalg.norm(b)
    corners = np.array([[o, o + a, o + a + b], [o, o + a + b, o + b]])
    return Mesh(corners, np.array([[(0, 0), (u, 0), (u, v)], [(0, 0), (u, v), (0, v)]], float))


def box(centre: ArrayLike, size: ArrayLike) -> Mesh:
    """Return the axis-aligned box."""
    corners, axes, share = _cube()
    edges = np.asarray(size, float)
    return Mesh(corners * edges + np.asarray(centre, float), share * edges[axes][:, None])


@lru_cache(maxsize=1)
def _cube() -> tuple[Array, NDArray[np.intp], Array]:
    """Return the unit cube: triangles, the axes along which u and v run, and u and v there."""
    half = np.eye(3) / 2
    sides, axes = [], []
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        along, up = (second, first) if axis == 0 else (first, second)
        corner = -half[first] - half[second]
        for sign in (-1, 1):
            sides.append(quad(corner + sign * half[axis], 2 * half[along], 2 * half[up]))
            axes += [(along, up)] * 2
    cube = joined(sides)
    return cube.corners, np.array(axes), cube.uv


def cushion(centre: ArrayLike, size: ArrayLike, rounding: float = 0.35, segments: int = 10) -> Mesh:
    """Return a box with soft edges: a superellipsoid, the rounder the nearer `rounding` to 1."""
    latitude = np.linspace(-pi / 2, pi / 2, segments)
    longitude = np.linspace(-pi, pi, 2 * segments + 1)

    def power(x: Array) -> Array:
        return np.sign(x) * np.abs(x) ** rounding

    p, q = latitude[:, None], longitude[None]
    unit = (
        power(np.cos(p)) * power(np.cos(q)),
        power(np.sin(p) + 0 * q),
        power(np.cos(p)) * power(np.sin(q)),
    )
    grid = np.stack(unit, -1) * np.asarray(size, float) / 2 + np.asarray(centre, float)
    return surface(grid)


def surface(grid: Array) -> Mesh:
    """Return the mesh through a grid of points, rows by columns by (x, y, z)."""
    across = np.linalg.norm(np.diff(grid, axis=1), axis=-1).mean(0)
    down = np.linalg.norm(np.diff(grid, axis=0), axis=-1).mean(1)
    u, v = np.meshgrid(np.r_[0, across.cumsum()], np.r_[0, down.cumsum()])
    return Mesh(_split(grid), _split(np.stack([u, v], -1)))


def draped(grid: Array) -> Mesh:
    """Return the mesh through a grid of points, textured by its ground plan: land."""
    return Mesh(_split(grid), _split(grid[..., [0, 2]]))


def _split(grid: Array) -> Array:
    """Return the two triangles of every cell of a grid."""
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    triangles = np.stack([np.stack([a, b, c], 2), np.stack([a, c, d], 2)], 2)
    return triangles.reshape(-1, 3, grid.shape[-1])


def prism(profile: ArrayLike, width: float) -> Mesh:
    """Return a polygon in the (z, y) plane extruded by `width` along x, centred on x = 0.

    The polygon is star-shaped around its mean, as the outline of a car or a gable is.
    """
    outline = np.asarray(profile, float)
    closed = np.concatenate([outline, outline[:1]])
    z, y = closed.T
    left, right = (np.stack([np.full_like(y, s * width / 2), y, z], -1) for s in (-1, 1))
    skin = surface(np.stack([left, right]))
    caps = []
    for rim in (left, right):
        middle = np.broadcast_to(rim[:-1].mean(0), rim[:-1].shape)
        fan = np.stack([middle, rim[:-1], rim[1:]], 1)
        caps.append(Mesh(fan, fan[..., [2, 1]]))
    return joined([skin, *caps])


def revolved(profile: ArrayLike, segments: int = 20) -> Mesh:
    """Return the surface of revolution of (radius, height) pairs about the vertical axis."""
    radius, height = np.asarray(profile, float).T
    angle = np.linspace(0, 2 * pi, segments + 1)
    ring = np.stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)], -1)
    grid = radius[:, None, None] * ring + np.array([0, 1, 0]) * height[:, None, None]
    return surface(grid)


def tube(start: ArrayLike, end: ArrayLike, radii: tuple[float, float], segments: int = 8) -> Mesh:
    """Return a cone frustum with rounded ends between two points: a limb, a pole, a branch."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    axis = (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)
    side = np.cross(axis, [1.0, 0, 0] if abs(axis[0]) < 0.9 else [0, 0, 1.0])
    side /= np.linalg.norm(side)
    angle = np.linspace(0, 2 * pi, segments + 1)[:, None]
    ring = np.cos(angle) * side + np.sin(angle) * np.cross(axis, side)
    r, s = radii
    stations = [(a - r * axis, 0.0), (a - 0.5 * r * axis, 0.85 * r), (a, r), (b, s)]
    stations += [(b + 0.5 * s * axis, 0.85 * s), (b + s * axis, 0.0)]
    return surface(np.stack([centre + radius * ring for centre, radius in stations]))


def wire(line: ArrayLike, radius: float, segments: int = 5) -> Mesh:
    """Return a tube through a row of points: a stalk, a hoop, a rail, a cable."""
    points = np.asarray(line, float)
    along = np.gradient(points, axis=0)
    # Flat curves keep clear of their plane's normal, so that the tube does not twist.
    normal = np.linalg.svd(points - points.mean(0), full_matrices=True)[2][2]
    side = np.cross(along, normal)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    other = np.cross(along, side)
    other /= np.maximum(np.linalg.norm(other, axis=1, keepdims=True), 1e-12)
    angle = np.linspace(0, 2 * pi, segments + 1)[None, :, None]
    ring = np.cos(angle) * side[:, None] + np.sin(angle) * other[:, None]
    return surface(points[:, None] + radius * ring)


def rods(starts: Array, ends: Array, radius: float) -> Mesh:
    """Return a thin three-sided rod, half as thick at its end, for each pair of points."""
    along = ends - starts
    side = np.cross(along, (0.3, 0.2, 1.0))
    side *= radius / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-9)
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    other = np.cross(along / length, side)
    ring = [side, -0.5 * side + 0.87 * other, -0.5 * side - 0.87 * other]
    faces = []
    for k in range(3):
        a, b = starts + ring[k], starts + ring[(k + 1) % 3]
        c, d = ends + 0.5 * ring[k], ends + 0.5 * ring[(k + 1) % 3]
        faces += [np.stack([a, b, c], 1), np.stack([c, b, d], 1)]
    corners = np.concatenate(faces)
    return Mesh(corners, corners[..., :2].copy())


def blob(rng: Generator, size: ArrayLike, roughness: float, segments: int = 14) -> Mesh:
    """Return an ellipsoid with a lumpy surface: a tree's crown, a bush, a stone, a head of hair."""
    latitude = np.linspace(-pi / 2, pi / 2, segments)[:, None]
    longitude = np.linspace(0, 2 * pi, 2 * segments + 1)[None]
    unit = np.stack(
        [
            np.cos(latitude) * np.cos(longitude),
            np.sin(latitude) + 0 * longitude,
            np.cos(latitude) * np.sin(longitude),
        ],
        -1,
    )
    lumps = sum(
        np.cos(unit @ rng.normal(0, frequency, 3) + rng.uniform(0, 2 * pi)) / frequency
        for frequency in (2, 3, 5, 7, 11)
    )
    radius = 1 + roughness * np.asarray(lumps)
    return surface(unit * radius[..., None] * np.asarray(size, float) / 2)


def leaves(rng: Generator, size: ArrayLike, count: int, leaf: float) -> Mesh:
    """Return `count` small leaves of length `leaf` scattered through an ellipsoid."""
    direction = rng.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    centre = direction * rng.uniform(0.3, 1, (count, 1)) ** 0.5 * np.asarray(size, float) / 2
    return leaves_at(rng, centre, leaf)


def leaves_at(rng: Generator, spots: Array, leaf: float) -> Mesh:
    """Return a small leaf of length `leaf` at each spot, turned anyhow."""
    along, across = rng.normal(0, leaf / 2, (2, len(spots), 3))
    corners = np.stack([spots - along, spots + across, spots + along], 1)
    uv = np.array([(0, 0), (leaf, 0), (leaf, leaf)])
    return Mesh(corners, np.broadcast_to(uv, (len(spots), 3, 2)).copy())


def curtain(rng: Generator, width: float, height: float, fold: float) -> Mesh:
    """Return a hanging cloth in the xy plane with vertical folds of depth `fold`."""
    x = np.linspace(0, width, 40)
    y = np.linspace(0, height, 6)
    phase, waves = rng.uniform(0, 2 * pi), rng.uniform(4, 9)
    z = fold * np.sin(phase + 2 * pi * waves * x / max(width, 0.5))
    grid = np.stack(np.broadcast_arrays(x[None], y[:, None], z[None]), -1)
    return surface(grid)
