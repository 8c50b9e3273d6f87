"""What is written for a picture, and what may lie in its place already.

Every output says what it was made from: its origin. An output of the same origin need not be
made again; any other file in its place is somebody's work and is not replaced unasked.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.atomic import check_writable
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import SUFFIXES, read_meaning, write_depth
from flexdepth.runtime.formats.sidecar import SPEAKS_FOR
from flexdepth.runtime.interrupts import interrupts_held
from flexdepth.runtime.origin import Origin, glb_origin, picture_origin, ply_origin, write_picture
from flexdepth.runtime.picture import preview
from flexdepth.runtime.surface import normals, normals_picture

# Point clouds are imported where they are made: trimesh alone takes longer than a prediction. It
# also swallows a Ctrl-C that meets it while it is imported.


@dataclass(frozen=True, eq=False)
class Scene:
    """A picture and its depth: what outputs are made from."""

    pixels: NDArray[np.uint8]
    depth_map: DepthMap


@dataclass(frozen=True)
class Output:
    """One kind of file that is made of a scene.

    Attributes:
        suffix: What follows the picture's name.
        write: Makes the file; it appears whole or not at all.
        origin: Says what such a file was made from; None where it does not say.
        beside: The suffix of a second file that belongs to it.
        mark: Goes into the origin, to tell it from another kind of the same suffix.
    """

    suffix: str
    write: Callable[[Path, Scene, Origin], None]
    origin: Callable[[Path], Origin | None]
    beside: str = ""
    mark: Origin = field(default_factory=dict)

    def path(self, base: Path) -> Path:
        """Return the file for a picture; `base` is the output folder and the picture's name."""
        return base.with_name(base.name + self.suffix)


def _write_depth(path: Path, scene: Scene, origin: Origin) -> None:
    write_depth(path, scene.depth_map, origin)


def _depth_origin(path: Path) -> Origin | None:
    origin = read_meaning(path)["origin"]
    return origin if isinstance(origin, Mapping) else None


def _write_preview(path: Path, scene: Scene, origin: Origin) -> None:
    write_picture(path, preview(scene.depth_map), origin)


def _write_normals(path: Path, scene: Scene, origin: Origin) -> None:
    write_picture(path, normals_picture(normals(scene.depth_map)), origin)


def _write_ply(path: Path, scene: Scene, origin: Origin) -> None:
    with interrupts_held():
        from flexdepth.runtime.cloud import points, write_ply  # noqa: PLC0415 - see above

    write_ply(path, points(scene.depth_map, scene.pixels), origin)


def _write_glb(path: Path, scene: Scene, origin: Origin) -> None:
    with interrupts_held():
        from flexdepth.runtime.cloud import points, write_glb  # noqa: PLC0415 - see above

    write_glb(path, points(scene.depth_map, scene.pixels), origin)


def _write_ply_mesh(path: Path, scene: Scene, origin: Origin) -> None:
    with interrupts_held():
        from flexdepth.runtime.cloud import mesh, write_ply  # noqa: PLC0415 - see above

    write_ply(path, mesh(scene.depth_map, scene.pixels), origin)


def _write_glb_mesh(path: Path, scene: Scene, origin: Origin) -> None:
    with interrupts_held():
        from flexdepth.runtime.cloud import mesh, write_glb  # noqa: PLC0415 - see above

    write_glb(path, mesh(scene.depth_map, scene.pixels), origin)


DEPTH: Mapping[str, Output] = MappingProxyType(
    {
        name: Output(suffix, _write_depth, _depth_origin, ".json" if name in SPEAKS_FOR else "")
        for name, suffix in SUFFIXES.items()
    }
)
"""Depth files by the name of their format."""

POINTS: Mapping[str, Output] = MappingProxyType(
    {
        "ply": Output(".ply", _write_ply, ply_origin),
        "glb": Output(".glb", _write_glb, glb_origin),
    }
)
"""Point clouds by the name of their format."""

MESH: Mapping[str, Output] = MappingProxyType(
    {
        "ply": Output(".ply", _write_ply_mesh, ply_origin, mark={"shape": "mesh"}),
        "glb": Output(".glb", _write_glb_mesh, glb_origin, mark={"shape": "mesh"}),
    }
)
"""The same points joined to a surface, by the name of the format."""

PREVIEW = Output(".preview.png", _write_preview, picture_origin)
"""The depth in colours, with a legend."""

NORMALS = Output(".normals.png", _write_normals, picture_origin)
"""The directions that surfaces face, as colours."""


def unmade(
    outputs: Sequence[Output], base: Path, origin: Origin, overwrite: bool
) -> tuple[Output, ...]:
    """Return the outputs that are still to be made.

    Args:
        outputs: What is wanted.
        base: The output folder and the picture's name.
        origin: What they are to be made from.
        overwrite: Make all of them, whatever is there.

    Raises:
        InputError: Something else lies in the place of an output, or none can be written there.
    """
    missing = tuple(
        output
        for output in outputs
        if overwrite or not is_made(output.path(base), {**origin, **output.mark}, output.origin)
    )
    if missing:
        check_writable(base.parent)
    return missing


def is_made(path: Path, origin: Origin, said: Callable[[Path], Origin | None]) -> bool:
    """Return whether `path` is there, made from `origin`; False where nothing is there.

    Args:
        path: The file.
        origin: What it is to be made from.
        said: Returns what it says it was made from.

    Raises:
        InputError: Something else lies there.
    """
    if not os.path.exists(path):  # Path.exists raises where the folder may not be searched
        return False
    with suppress(InputError):
        if said(path) == origin:
            return True
    raise InputError(
        f"{path}: is there already and was not made from this input with this model and these "
        f"settings; add --overwrite or choose another --output-dir"
    )


def write_all(outputs: Sequence[Output], base: Path, scene: Scene, origin: Origin) -> None:
    """Write outputs of one scene, one after another.

    Raises:
        InputError: One cannot be written; those before it are there.
    """
    for output in outputs:
        output.write(output.path(base), scene, {**origin, **output.mark})


def discard(output: Output, base: Path) -> None:
    """Remove an output, and the second file that belongs to it unless another output's does.

    Raises:
        InputError: It cannot be removed.
    """
    path = output.path(base)
    try:
        path.unlink(missing_ok=True)
        if output.beside and not any(DEPTH[name].path(base).exists() for name in SPEAKS_FOR):
            base.with_name(base.name + output.beside).unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be removed: {error.strerror}; do so by hand") from error
