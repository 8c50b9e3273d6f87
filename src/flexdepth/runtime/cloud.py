"""From a depth map to things in space: points, a mesh, and the files that hold them.

Coordinates are the camera's: x right, y down, z forward, in metres for metric depth, else in
the map's own unit. PLY keeps them; GLB turns them to y up and −z forward, as glTF has it.
"""

from dataclasses import dataclass
from math import ceil, sqrt
from pathlib import Path
from typing import Any, cast

import numpy as np
import trimesh
from numpy.typing import NDArray

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.origin import KEY, Origin, ply_comment
from flexdepth.runtime.surface import (
    Floats,
    Mask,
    camera_of,
    flying,
    inverse_depth,
    normals,
    normals_picture,
    rays,
    steps,
)

__all__ = [
    "MAX_POINTS",
    "UNSURE",
    "Cloud",
    "Mesh",
    "Shown",
    "mesh",
    "normals",
    "normals_picture",
    "points",
    "write_glb",
    "write_ply",
]

UNSURE = 0.5
"""A pixel whose depth has a larger relative standard deviation is no point: its place in space is
not known, and the few that are so stand out as clutter."""

MAX_POINTS = 2_000_000
"""A larger map is thinned evenly below so many points: enough to look at, small enough to open."""


@dataclass(frozen=True, eq=False)
class Cloud:
    """Coloured points.

    Attributes:
        positions: Points by 3, float32: x right, y down, z forward.
        colours: Points by 3, uint8 RGB (sRGB, as in the picture).
    """

    positions: Floats
    colours: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Coloured points joined by triangles.

    Attributes:
        positions: As in `Cloud`.
        colours: As in `Cloud`.
        triangles: Triangles by 3, int32: which points, anticlockwise as seen from the camera.
    """

    positions: Floats
    colours: NDArray[np.uint8]
    triangles: NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Shown:
    """Points with something drawn among them, such as arrows.

    Attributes:
        cloud: The points.
        drawn: Surfaces in the same coordinates; may be empty.
    """

    cloud: Cloud
    drawn: Mesh


@dataclass(frozen=True, eq=False)
class _Grid:
    """Every n-th pixel of a map, as points, and which of them are to be shown."""

    inverse: Floats
    positions: Floats
    colours: NDArray[np.uint8]
    shown: Mask


def points(depth_map: DepthMap, colours: NDArray[np.uint8], max_points: int = MAX_POINTS) -> Cloud:
    """Return the points that the pixels see, row by row.

    Left out are sky, unknown and non-positive depth, flying pixels (`surface.flying`), and pixels
    whose spread is more than `UNSURE`. A map of more than `max_points` pixels gives every n-th
    pixel of every n-th row.

    Args:
        depth_map: Metric or known up to scale, with a camera.
        colours: The picture, height x width x 3, of the map's size.
        max_points: At most so many points.

    Raises:
        InputError: The map has no points (affine, or without a camera), the picture has another
            size, or `max_points` is not positive.
    """
    grid = _grid(depth_map, colours, max_points)
    return Cloud(grid.positions[grid.shown], grid.colours[grid.shown])


def mesh(depth_map: DepthMap, colours: NDArray[np.uint8], max_points: int = MAX_POINTS) -> Mesh:
    """Return the surface through the points: triangles between neighbours, but across no step.

    What counts as a step is said in `surface.steps`; a grazing wall or floor is none. Points
    that no triangle uses are left out.

    Args:
        depth_map: As for `points`.
        colours: As for `points`.
        max_points: As for `points`.

    Raises:
        InputError: As for `points`.
    """
    grid = _grid(depth_map, colours, max_points)
    across = ~steps(grid.inverse)
    down = ~steps(grid.inverse.T).T
    shown = grid.shown
    diagonal = shown[:-1, 1:] & shown[1:, :-1]
    first = shown[:-1, :-1] & diagonal & across[:-1] & down[:, :-1]
    second = shown[1:, 1:] & diagonal & across[1:] & down[:, 1:]
    number = np.arange(shown.size, dtype=np.int32).reshape(shown.shape)
    corners, below = number[:-1, :-1], number[1:, :-1]
    beside, opposite = number[:-1, 1:], number[1:, 1:]
    triangles = np.concatenate(
        [
            np.stack([corners[first], below[first], beside[first]], -1),
            np.stack([opposite[second], beside[second], below[second]], -1),
        ]
    )
    used = np.zeros(shown.size, bool)
    used[triangles] = True
    renumbered = np.cumsum(used, dtype=np.int32) - 1
    positions, colour = grid.positions.reshape(-1, 3), grid.colours.reshape(-1, 3)
    return Mesh(positions[used], colour[used], renumbered[triangles])


def _grid(depth_map: DepthMap, colours: NDArray[np.uint8], max_points: int) -> _Grid:
    """Return the pixels of a map, thinned to at most `max_points`, as points."""
    camera = camera_of(depth_map)
    height, width = depth_map.values.shape
    if colours.shape != (height, width, 3) or colours.dtype != np.uint8:
        raise InputError(
            f"the points need a uint8 RGB picture of the map's size {height} x {width}, "
            f"got shape {colours.shape} of {colours.dtype}"
        )
    if max_points < 1:
        raise InputError(f"max_points must be at least 1, got {max_points}")
    every = max(1, ceil(sqrt(height * width / max_points)))
    while ceil(height / every) * ceil(width / every) > max_points:
        every += 1
    rows, columns = np.arange(0, height, every), np.arange(0, width, every)
    at = np.ix_(rows, columns)
    depth = depth_map.depth[at]
    positions = rays(rows[:, None], columns[None, :], camera)
    visible = np.isfinite(depth) & (depth > 0)
    positions *= np.where(visible, depth, np.nan)[..., None]
    shown = visible & ~flying(depth)
    if depth_map.spread is not None:
        shown &= ~(depth_map.spread[at] > UNSURE)
    return _Grid(inverse_depth(depth), positions, colours[at], shown)


def write_ply(path: Path, shape: Cloud | Mesh | Shown, origin: Origin | None = None) -> None:
    """Write a binary little-endian PLY: x right, y down, z forward, colours as in the picture.

    What is drawn among points follows them in the one list of vertices that a PLY has.

    Args:
        path: The file to make or to replace; it appears whole or not at all.
        shape: What to write.
        origin: What the shape was made from, to recognise the file by later.

    Raises:
        InputError: There is not a single point, or the file cannot be written.
    """
    one = _joined(shape) if isinstance(shape, Shown) else shape
    whole = _trimesh(path, one, one.positions, one.colours)
    content = cast(bytes, whole.export(file_type="ply"))
    header, end, numbers = content.partition(b"end_header\n")
    with replacing(path) as temporary, temporary.open("wb") as file:
        file.writelines((header, ply_comment(origin) if origin else b"", end, numbers))


def write_glb(path: Path, shape: Cloud | Mesh | Shown, origin: Origin | None = None) -> None:
    """Write a binary glTF: y up, −z forward, which turns a point into (x, −y, −z).

    The colours are stored linear, as glTF wants them at vertices, and unlit: the photo already
    has its light.

    Args:
        path: The file to make or to replace; it appears whole or not at all.
        shape: What to write.
        origin: What the shape was made from, to recognise the file by later.

    Raises:
        InputError: There is not a single point, or the file cannot be written.
    """
    parts = (shape.cloud, shape.drawn) if isinstance(shape, Shown) else (shape,)
    scene = trimesh.Scene()
    for name, part in zip(("scene", "drawn"), parts, strict=False):
        if name == "scene" or len(part.positions):
            positions = part.positions * np.array([1, -1, -1], np.float32)
            scene.add_geometry(
                _trimesh(path, part, positions, _linear()[part.colours]), geom_name=name
            )

    def finish(tree: dict[str, Any]) -> None:
        _unlit(tree)
        if origin:
            tree["asset"]["extras"] = {KEY: dict(origin)}

    with replacing(path) as temporary:
        scene.export(  # type: ignore[no-untyped-call]
            str(temporary), file_type="glb", tree_postprocessor=finish
        )


def _joined(shown: Shown) -> Cloud | Mesh:
    """Return points and what is drawn among them as one list of vertices, some in triangles."""
    cloud, drawn = shown.cloud, shown.drawn
    if not len(cloud.positions) or not len(drawn.triangles):
        return cloud
    return Mesh(
        np.concatenate([cloud.positions, drawn.positions]),
        np.concatenate([cloud.colours, drawn.colours]),
        drawn.triangles + np.int32(len(cloud.positions)),
    )


def _trimesh(
    path: Path, shape: Cloud | Mesh, positions: Floats, colours: NDArray[np.uint8]
) -> trimesh.PointCloud | trimesh.Trimesh:
    """Return the shape as trimesh has it, with other positions and colours."""
    if not len(positions):
        raise InputError(
            f"{path}: there is nothing to write: no pixel of the map is a known point "
            f"(is it all sky?)"
        )
    if isinstance(shape, Mesh):
        return trimesh.Trimesh(positions, shape.triangles, vertex_colors=colours, process=False)
    return trimesh.PointCloud(positions, colors=colours)  # type: ignore[no-untyped-call]


def _linear() -> NDArray[np.uint8]:
    """Return for each sRGB byte the nearest byte of linear light (IEC 61966-2-1)."""
    value = np.arange(256) / 255
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    stored: NDArray[np.uint8] = np.rint(255 * linear).astype(np.uint8)
    return stored


def _unlit(tree: dict[str, Any]) -> None:
    """Give everything in a glTF tree one material that shows colours as they are."""
    tree["extensionsUsed"] = ["KHR_materials_unlit"]
    tree["materials"] = [{"extensions": {"KHR_materials_unlit": {}}, "doubleSided": True}]
    for each in tree["meshes"]:
        for primitive in each["primitives"]:
            primitive["material"] = 0
