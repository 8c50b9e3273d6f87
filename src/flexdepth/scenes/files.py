"""The files that a solution becomes, and what may lie in their place already."""

import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.atomic import check_writable, replacing
from flexdepth.runtime.files import read_origin, write_depth
from flexdepth.runtime.interrupts import interrupts_held
from flexdepth.runtime.opening import open_input
from flexdepth.runtime.origin import Origin, glb_origin, picture_origin, ply_origin, write_picture
from flexdepth.runtime.outputs import is_made
from flexdepth.scenes.pair import Solution
from flexdepth.scenes.picture import (
    border_picture,
    borders,
    motion_picture,
    moving_picture,
    solution_picture,
)
from flexdepth.scenes.record import record

_ORIGIN = "origin"
_BROKEN = (OSError, ValueError, KeyError, EOFError, BadZipFile, RecursionError)


@dataclass(frozen=True)
class Product:
    """One file that is made of a solution.

    Attributes:
        name: Of the file.
        write: Makes it; it appears whole or not at all.
        origin: Says what such a file was made from; None where it does not say.
    """

    name: str
    write: Callable[[Path, Solution, Origin], None]
    origin: Callable[[Path], Origin | None]


def products(clouds: Sequence[str]) -> tuple[Product, ...]:
    """Return what is made of a solution; the last of them says that all are there.

    Args:
        clouds: Of `CLOUDS`.
    """
    return (
        Product("depth.npz", _write_depth, _read_depth_origin),
        Product("motion.npz", _write_motion, _npz_origin),
        Product("solution.npz", _write_maps, _npz_origin),
        _picture("moving.png", lambda solution: moving_picture(solution.found)),
        _picture("borders.png", lambda solution: border_picture(solution.found)),
        _picture("motion.png", motion_picture),
        _picture("solution.png", solution_picture),
        *(CLOUDS[name] for name in dict.fromkeys(clouds)),
        Product("solution.json", _write_record, _json_origin),
    )


def all_made(wanted: Sequence[Product], folder: Path, origin: Origin, overwrite: bool) -> bool:
    """Return whether every file is there, made from the same frames with the same settings.

    Args:
        wanted: The files.
        folder: Where they go.
        origin: What they are to be made from.
        overwrite: Whatever is there is to be replaced.

    Raises:
        InputError: Something else lies in the place of one, or none can be written there.
    """
    there = [not overwrite and is_made(folder / each.name, origin, each.origin) for each in wanted]
    made = all(there)
    if not made:
        check_writable(folder)
    return made


def write_solution(
    solution: Solution, wanted: Sequence[Product], folder: Path, origin: Origin
) -> tuple[Path, ...]:
    """Write the files of a solution, one after another, and return them.

    A cloud is left out where no pixel has depth.

    Raises:
        InputError: One cannot be written; those before it are there.
    """
    written = []
    for product in wanted:
        if product in CLOUDS.values() and not solution.depth.valid.any():
            continue
        product.write(folder / product.name, solution, origin)
        written.append(folder / product.name)
    return tuple(written)


def _write_depth(path: Path, solution: Solution, origin: Origin) -> None:
    write_depth(path, solution.depth, origin)


def _read_depth_origin(path: Path) -> Origin | None:
    return read_origin(path)


def _write_motion(path: Path, solution: Solution, origin: Origin) -> None:
    found = solution.found
    _write_npz(path, {"rotation": found.rotation, "translation": found.translation}, origin)


def _write_maps(path: Path, solution: Solution, origin: Origin) -> None:
    found = solution.found
    maps: dict[str, NDArray[np.generic]] = {
        "label": found.labels,
        "moving": found.moving,
        "border": borders(found.labels),
        "unknown": found.unknown,
        "valid": found.valid,
        "inferred": found.inferred,
        "spread": found.spread,
        "confidence": solution.confidence,
        "parallax": found.parallax,
        "residual": found.residual,
        "flow": solution.flow.flow,
        "flow_noise": solution.flow.noise,
    }
    if found.prior_share is not None:
        maps["prior_share"] = found.prior_share
    _write_npz(path, maps, origin)


def _write_npz(path: Path, maps: Mapping[str, NDArray[np.generic]], origin: Origin) -> None:
    small = {
        name: values.astype(np.float32) if values.dtype == np.float64 else values
        for name, values in maps.items()
    }
    with replacing(path) as temporary:
        np.savez(temporary, allow_pickle=False, **small, origin=np.array(json.dumps(dict(origin))))


def _npz_origin(path: Path) -> Origin | None:
    open_input(path).close()
    with suppress(*_BROKEN), np.load(path, allow_pickle=False) as stored:
        return _mapping(json.loads(str(stored[_ORIGIN])))
    return None


def _picture(name: str, draw: Callable[[Solution], NDArray[np.uint8]]) -> Product:
    def write(path: Path, solution: Solution, origin: Origin) -> None:
        write_picture(path, draw(solution), origin)

    return Product(name, write, picture_origin)


def _write_ply(path: Path, solution: Solution, origin: Origin) -> None:
    # trimesh takes long to import, and swallows a Ctrl-C that meets it there.
    with interrupts_held():
        from flexdepth.runtime.cloud import write_ply  # noqa: PLC0415
        from flexdepth.scenes.space import cloud  # noqa: PLC0415

    write_ply(path, cloud(solution), origin)


def _write_glb(path: Path, solution: Solution, origin: Origin) -> None:
    with interrupts_held():
        from flexdepth.runtime.cloud import write_glb  # noqa: PLC0415 - as above
        from flexdepth.scenes.space import cloud  # noqa: PLC0415

    write_glb(path, cloud(solution), origin)


CLOUDS: Mapping[str, Product] = MappingProxyType(
    {
        "glb": Product("cloud.glb", _write_glb, glb_origin),
        "ply": Product("cloud.ply", _write_ply, ply_origin),
    }
)
"""Clouds of points with arrows, by the name of their format."""


def _write_record(path: Path, solution: Solution, origin: Origin) -> None:
    text = json.dumps(record(solution, origin), indent=1, allow_nan=False) + "\n"
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="ascii")


def _json_origin(path: Path) -> Origin | None:
    open_input(path).close()
    with suppress(*_BROKEN):
        said = json.loads(path.read_text("utf-8"))
        return _mapping(said[_ORIGIN])
    return None


def _mapping(found: object) -> Origin | None:
    return found if isinstance(found, Mapping) else None
