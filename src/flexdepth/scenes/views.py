"""The pictures of one scene, as the solver needs them: of one size, with their camera."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import Photo, read_photo
from flexdepth.runtime.lens import Lens, Said, intrinsics
from flexdepth.runtime.sizes import resized
from flexdepth.scenes.camera import read_camera

Picture = NDArray[np.uint8]

SMALLEST_SIDE = 64
"""Pixels: frames are not made smaller than this."""


@dataclass(frozen=True)
class ViewFiles:
    """Which pictures there are of a scene.

    Attributes:
        key: The frame whose depth is sought.
        target: Another frame, before or after it.
        third: One more frame, for what the target does not show.
        right: The picture of the right camera of a rectified stereo pair, of the moment of key.
    """

    key: Path
    target: Path
    third: Path | None = None
    right: Path | None = None

    def named(self) -> Iterator[tuple[str, Path]]:
        """Give the pictures that there are, each with its name."""
        for name in ("key", "target", "third", "right"):
            path = getattr(self, name)
            if path is not None:
                yield name, path


@dataclass(frozen=True, eq=False)
class Views:
    """The pictures, all of one size.

    Attributes:
        pictures: RGB, by name: key, target, and third and right where there are such.
        camera: Of all of them, in their pixels.
        reduced: Their size over that of the files, across and down; 1 where they are as they were.
        warnings: What a user should know of how they were read, one line each.
    """

    pictures: dict[str, Picture]
    camera: Intrinsics
    reduced: tuple[float, float]
    warnings: tuple[str, ...]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        height, width = self.pictures["key"].shape[:2]
        return width, height


def read_views(files: ViewFiles, camera: Lens | Path | None, long_side: int) -> Views:
    """Read the pictures, and make them smaller where they are large.

    Args:
        files: Which they are.
        camera: What the user says of the camera, or a file that does; None takes the photos' own
            word, or else assumes a lens.
        long_side: Pixels; where the longer side is longer, all are made so small.

    Raises:
        InputError: One is missing, a video, no picture, or of another size than the key frame.
    """
    photos = {name: _photo(path) for name, path in files.named()}
    paths = dict(files.named())
    height, width = photos["key"].pixels.shape[:2]
    for name, photo in photos.items():
        if photo.pixels.shape != photos["key"].pixels.shape:
            raise InputError(
                f"{paths[name]}: is {photo.pixels.shape[1]}x{photo.pixels.shape[0]}, "
                f"{files.key} is {width}x{height}; frames of one camera and one size are wanted: "
                "crop or resize one of them"
            )
    seen = _camera(camera, photos, width, height)
    notes = [note for photo in photos.values() for note in photo.warnings]
    notes += _repeated(photos, paths)
    size = _size(width, height, long_side)
    factors = size[0] / width, size[1] / height
    if size != (width, height):
        notes.append(
            f"frames of {width}x{height} are solved at {size[0]}x{size[1]}, and so are the "
            f"outputs; --long-side {max(width, height)} keeps their size, and takes "
            f"{width * height / prod(size):.1f} times as long"
        )
    pictures = {name: resized(photo.pixels, size) for name, photo in photos.items()}
    return Views(pictures, seen.scaled(*factors), factors, tuple(notes))


def _photo(path: Path) -> Photo:
    # FFmpeg takes a tenth of a second to load, and is asked by a name that is no picture's only.
    from flexdepth.runtime.inputs import Input  # noqa: PLC0415

    if Input(path, path).is_video and path.exists():
        raise InputError(
            f"{path}: is a video; two frames are wanted: take them out first, for instance "
            f"`ffmpeg -i {path.name} frame%04d.png`"
        )
    if path.is_dir():
        raise InputError(f"{path}: is a folder; two frames are wanted: name them both")
    return read_photo(path)


def _camera(
    said: Lens | Path | None, photos: dict[str, Photo], width: int, height: int
) -> Intrinsics:
    if isinstance(said, Path):
        return read_camera(said, width, height)
    written = (photo.focal_in_diagonals for photo in photos.values())
    told = Said(next((focal for focal in written if focal is not None), None))
    return intrinsics(width, height, said, told)


def _repeated(photos: dict[str, Photo], paths: dict[str, Path]) -> Iterator[str]:
    """Say which pictures are the key frame once more."""
    for name, photo in photos.items():
        if name != "key" and np.array_equal(photo.pixels, photos["key"].pixels):
            yield (
                f"{paths[name]}: is the same picture as the key frame {paths['key']}, so it tells "
                "nothing of motion or depth"
            )


def _size(width: int, height: int, long_side: int) -> tuple[int, int]:
    if long_side < SMALLEST_SIDE:
        raise InputError(f"--long-side: wanted at least {SMALLEST_SIDE} pixels, got {long_side}")
    factor = min(1.0, long_side / max(width, height))
    return max(1, round(width * factor)), max(1, round(height * factor))
