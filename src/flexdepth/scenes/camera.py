"""Which camera took the frames: from a file, from what the user says, or from the photo itself.

Files follow OpenCV: the first pixel's centre is 0, so half a pixel is added to what they say.
They may be

    .json   focal_x, focal_y, centre_x, centre_y, or `focal` and `centre` (one number or two),
            bare or below `intrinsics`; with width and height, these are compared
    .txt    fx fy cx cy, or the 3 x 3 camera matrix row by row
    .cam    of MPI-Sintel
    .npz .npy .png .exr .pfm    a depth file of flexdepth, which knows its camera
"""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import SUFFIXES, read_meaning
from flexdepth.runtime.formats.reading import reading
from flexdepth.runtime.opening import open_input

_HALF_PIXEL = 0.5
_ERRORS = (ValueError, TypeError, KeyError, RecursionError)
_WANTED = "focal_x, focal_y, centre_x and centre_y in pixels"
_LEAST_FOCAL = 10.0
"""Pixels: a smaller focal length is no camera's but a matrix divided by the picture's size."""


def read_camera(path: Path, width: int, height: int) -> Intrinsics:
    """Return the camera that a file describes, for frames of this size.

    Args:
        path: See the top of the module.
        width: Of the frames, pixels.
        height: Likewise.

    Raises:
        InputError: The file is missing, says no camera, or one of pictures of another size.
    """
    open_input(path).close()
    stated = _stated(path)
    size = stated.get("width", width), stated.get("height", height)
    if size != (width, height):
        raise InputError(
            f"{path}: is the camera of pictures of {size[0]}x{size[1]}, the frames are "
            f"{width}x{height}; resizing by r multiplies all its numbers by r"
        )
    with reading(path, "a camera", _ERRORS):
        focal_x, focal_y, centre_x, centre_y = _numbers(stated)
    if min(focal_x, focal_y) < _LEAST_FOCAL:
        raise InputError(
            f"{path}: a focal length in pixels is wanted, got {min(focal_x, focal_y):g}; numbers "
            f"in units of the picture's size are to be multiplied by it, here {width} and {height}"
        )
    if not (0 <= centre_x <= width and 0 <= centre_y <= height):
        raise InputError(
            f"{path}: its principal point {centre_x:g}, {centre_y:g} lies outside the frames of "
            f"{width}x{height}; is it the camera of another size?"
        )
    return Intrinsics(
        focal_x, focal_y, centre_x + _HALF_PIXEL, centre_y + _HALF_PIXEL, FocalSource.GIVEN
    )


def _stated(path: Path) -> Mapping[str, object]:
    """Return what the file says, by name."""
    suffix = path.suffix.lower()
    if suffix == ".json":
        return _json(path)
    if suffix == ".cam":
        # Only here, for the reader's room needs packages that the light install lacks.
        from flexdepth.data.tagged_floats import read_cam  # noqa: PLC0415

        return _matrix(read_cam(path)[0].ravel().tolist(), path)
    if suffix in SUFFIXES.values():
        meaning = read_meaning(path)
        camera = meaning["intrinsics"]
        if not isinstance(camera, Mapping):
            raise InputError(f"{path}: nothing is known of its camera; name a file that says it")
        return {**camera, "width": meaning["width"], "height": meaning["height"]}
    with reading(path, "a camera", _ERRORS):
        numbers = [float(word) for word in path.read_text("utf-8").replace(",", " ").split()]
    return _matrix(numbers, path)


def _json(path: Path) -> Mapping[str, object]:
    with reading(path, "a camera in JSON", _ERRORS):
        found: object = json.loads(path.read_text("utf-8"))
    if isinstance(found, list):
        with reading(path, "a camera matrix", _ERRORS):
            return _matrix(np.asarray(found, np.float64).ravel().tolist(), path)
    if not isinstance(found, Mapping):
        raise InputError(f"{path}: wanted {_WANTED}, got {type(found).__name__}")
    inner = found.get("intrinsics", found)
    return {**found, **inner} if isinstance(inner, Mapping) else found


def _matrix(numbers: list[float], path: Path) -> Mapping[str, object]:
    """Return the camera of four numbers, or of the nine of a matrix."""
    if len(numbers) == 9:
        numbers = [numbers[at] for at in (0, 4, 2, 5)]
    if len(numbers) != 4:
        raise InputError(
            f"{path}: wanted fx fy cx cy, or a 3 x 3 camera matrix; got {len(numbers)} numbers"
        )
    return dict(zip(("focal_x", "focal_y", "centre_x", "centre_y"), numbers, strict=True))


def _numbers(stated: Mapping[str, object]) -> tuple[float, float, float, float]:
    """Return fx, fy, cx, cy as they are written."""
    if "focal" in stated and "focal_x" not in stated:
        focal = np.broadcast_to(np.asarray(stated["focal"], np.float64), 2)
        centre = np.asarray(stated["centre"], np.float64)
        return float(focal[0]), float(focal[1]), float(centre[0]), float(centre[1])
    names = ("focal_x", "focal_y", "centre_x", "centre_y")
    missing = [name for name in names if name not in stated]
    if missing:
        raise ValueError(f"{_WANTED} are wanted, {', '.join(missing)} is missing")
    found = np.asarray([stated[name] for name in names], np.float64)
    return float(found[0]), float(found[1]), float(found[2]), float(found[3])
