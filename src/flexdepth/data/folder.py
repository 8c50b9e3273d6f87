"""A folder of images and depth files: what `flexdepth synth` writes and a user's own data.

    ROOT/image/NAME.jpg (or .png, any picture)
    ROOT/depth/NAME.npz (or .png, .exr, .npy, .pfm: files that state their meaning)

Every depth file says its unit and its camera; pairs share their NAME.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import SUFFIXES, read_depth
from flexdepth.runtime.images import is_picture_name, read_photo

Key = TypeVar("Key", str, tuple[Path, str])


@dataclass(frozen=True, eq=False)
class Pair:
    """An image with its measured depth.

    Attributes:
        name: The file's name without its suffix.
        image: RGB, 0 to 255.
        truth: Metric depth at the image's size, with its camera.
    """

    name: str
    image: NDArray[np.uint8]
    truth: DepthMap


@dataclass(frozen=True)
class Folder:
    """Images and depth files in one folder.

    Attributes:
        root: The folder that holds `image` and `depth`.
        part: `last` is the last tenth of the pairs by name, at least one, `first` the others: what
            is held out, and what is learnt from. Neighbours in a sequence stay together.
    """

    root: Path = Path()
    part: Literal["all", "first", "last"] = "all"

    def load(self) -> "FolderPairs":
        """Return the pairs, sorted by name.

        Raises:
            InputError: The folder or a part of it is missing or empty, an image or a depth file
                has no partner, or a single pair was to be divided.
        """
        images = _by_stem(self.root / "image", is_picture_name)
        depths = _by_stem(self.root / "depth", lambda p: p.suffix.lower() in SUFFIXES.values())
        check_partners(images, depths, "image/NAME needs a depth/NAME and the other way round")
        pairs = tuple((images[stem], depths[stem]) for stem in sorted(images))
        last = max(1, len(pairs) // 10)
        if self.part != "all" and last == len(pairs):
            raise InputError(
                f"{self.root}: holds a single pair, which cannot be both learnt from and held out"
            )
        parts = {"all": pairs, "first": pairs[:-last], "last": pairs[-last:]}
        return FolderPairs(parts[self.part])


@dataclass(frozen=True)
class FolderPairs:
    """The pairs of a folder by number; files are read when asked for."""

    paths: tuple[tuple[Path, Path], ...]

    def __len__(self) -> int:
        """Return how many pairs there are."""
        return len(self.paths)

    def __getitem__(self, index: int) -> Pair:
        """Return one pair.

        Raises:
            InputError: A file is broken, the depth is not metric, its camera is unknown, or its
                size is not the image's.
        """
        image_path, depth_path = self.paths[index]
        image, truth = read_photo(image_path).pixels, read_depth(depth_path)
        if truth.space is not Space.METRIC or truth.intrinsics is None:
            raise InputError(
                f"{depth_path}: training needs metric depth with a camera, "
                f"got {truth.space} {'with' if truth.intrinsics else 'without'} a camera"
            )
        if truth.values.shape != image.shape[:2]:
            raise InputError(
                f"{depth_path}: depth is {truth.values.shape[1]}x{truth.values.shape[0]}, "
                f"its image {image.shape[1]}x{image.shape[0]}; they must have one size"
            )
        return Pair(image_path.stem, image, truth)


def check_partners(images: Mapping[Key, Path], depths: Mapping[Key, Path], rule: str) -> None:
    """Refuse images without depth and depth without an image.

    Args:
        images: By what a pair has in common.
        depths: Likewise.
        rule: What every file needs, for the message: "image/NAME needs a depth/NAME".

    Raises:
        InputError: A file stands alone; the first is named.
    """
    alone = sorted(images.keys() ^ depths.keys())
    if alone:
        where = images.get(alone[0]) or depths[alone[0]]
        raise InputError(f"{where}: has no partner; every {rule} ({len(alone)} files have none)")


def _by_stem(folder: Path, wanted: Callable[[Path], bool]) -> dict[str, Path]:
    if not folder.is_dir():
        raise InputError(
            f"{folder}: no such folder; a data folder holds image/NAME.jpg and depth/NAME.npz"
        )
    found = {path.stem: path for path in folder.iterdir() if wanted(path)}
    if not found:
        raise InputError(f"{folder}: holds no file that can be read")
    return found
