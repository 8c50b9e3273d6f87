"""A folder whose depth files do not say what they mean: the settings say it.

    ROOT/image/NAME.png         any pictures
    ROOT/depth/NAME.png         16-bit PNG, npy, npz, EXR or PFM
    ROOT/poses.txt              if given: world from camera, 3 x 4 numbers for each image in order
    ROOT/flow/NAME.flo          if given: from an image to the next by name

This is the way to read a set that has no loader of its own, one sequence or camera at a time; files
that state their own meaning are read with `Folder`.
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.folder import check_partners
from flexdepth.data.read import opencv_camera
from flexdepth.data.stored import StoredPair, StoredPairs, known, named, planar
from flexdepth.data.tagged_floats import read_flow
from flexdepth.data.trajectory import Pose, rows
from flexdepth.data.views import FlowPair, Listed
from flexdepth.runtime.depthmap import Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_stated
from flexdepth.runtime.images import read_photo


class Measure(StrEnum):
    """What a number in a depth file measures."""

    DEPTH = "depth"
    """z."""
    DISTANCE = "distance"
    """Along the ray of its pixel; needs the camera."""


@dataclass(frozen=True)
class StatedDepth:
    """Numbers with a stated meaning.

    Attributes:
        path: The file.
        metres: Value of the stored number 1.
        unknown: Stored numbers that mean unknown, besides 0.
        sky: The stored number of sky, if there is one.
        along: The camera, where the numbers are distances along its rays.
    """

    path: Path
    metres: float
    unknown: tuple[float, ...]
    sky: float | None
    along: Intrinsics | None

    def values(self) -> NDArray[np.float32]:
        """Return z in metres."""
        stored = read_stated(self.path, Space.METRIC, self.metres).values
        hidden = np.isin(stored, [np.float32(each * self.metres) for each in self.unknown])
        values = np.where(hidden, np.float32(np.nan), known(stored))
        if self.along is not None:
            values = planar(values, self.along)
        if self.sky is not None:
            values[stored == np.float32(self.sky * self.metres)] = np.inf
        return values


@dataclass(frozen=True)
class StatedFolder:
    """Images and depth files of one camera, with what their numbers mean.

    Attributes:
        root: Where the other paths start, unless they are absolute.
        images: The folder of the pictures.
        depths: The folder of the depth files.
        image_name: A regular expression for a picture's path below its folder; its groups are
            what it has in common with its depth file.
        depth_name: Likewise for a depth file.
        metres: Value of the stored number 1: 0.001 for millimetres.
        unknown: Stored numbers that mean unknown, besides 0.
        sky: The stored number of sky, if there is one.
        measure: What a number measures.
        camera: fx, fy, cx, cy in pixels, the first pixel's centre being 0; None if not known.
        trajectory: A file with 3 x 4 numbers a line: world from camera, for each image in order.
        flow: A folder with a .flo file for each image but the last, by `image_name` without its
            suffix.
    """

    root: Path = Path()
    images: Path = Path("image")
    depths: Path = Path("depth")
    image_name: str = r"(.+)\.\w+"
    depth_name: str = r"(.+)\.(?:png|npy|npz|exr|pfm)"
    metres: float = 0.001
    unknown: tuple[float, ...] = ()
    sky: float | None = None
    measure: Measure = Measure.DEPTH
    camera: tuple[float, float, float, float] | None = None
    trajectory: Path | None = None
    flow: Path | None = None

    def load(self) -> StoredPairs:
        """Return the pairs, by what their names have in common.

        Raises:
            InputError: A folder is missing or holds nothing of that name, a file has no partner, or
                distances have no camera.
        """
        if self.measure is Measure.DISTANCE and self.camera is None:
            raise InputError("distances along rays need the camera: give fx, fy, cx, cy")
        if not self.metres > 0:
            raise InputError(f"metres, the value of the stored number 1, is > 0, got {self.metres}")
        pictures = self._pictures()
        depths = named(self.root / self.depths, self.depth_name, f"files like {self.depth_name}")
        check_partners(pictures, depths, f"{self.images}/NAME needs a {self.depths}/NAME")
        camera = self._intrinsics()
        along = camera if self.measure is Measure.DISTANCE else None
        return StoredPairs(
            tuple(
                StoredPair(
                    key.replace("/", "_"),
                    pictures[key],
                    StatedDepth(depths[key], self.metres, self.unknown, self.sky, along),
                    camera,
                )
                for key in sorted(pictures)
            )
        )

    def poses(self) -> tuple[Pose, ...]:
        """Return `world_from_camera` of each image.

        Raises:
            InputError: No poses are given, or there are more or fewer than images.
        """
        if self.trajectory is None:
            raise InputError(f"{self.root}: wanted poses, a file with 3 x 4 numbers a line")
        path, count = self.root / self.trajectory, len(self._pictures())
        found = rows(path)
        if len(found) != count:
            raise InputError(f"{path}: holds {len(found)} poses for {count} images")
        return found

    def flows(self) -> Listed[FlowPair]:
        """Return each image with the next one and the flow between them.

        Raises:
            InputError: No flow is given, or a file of it is missing.
        """
        if self.flow is None:
            raise InputError(f"{self.root}: wanted flow, a folder with a .flo file for each image")
        pictures, folder = self._pictures(), self.root / self.flow
        keys = sorted(pictures)
        for key in keys[:-1]:
            if not (folder / f"{key}.flo").is_file():
                raise InputError(f"{pictures[key]}: looked for {folder / key}.flo; there is none")
        return Listed(
            tuple(
                partial(_flow_pair, pictures[key], pictures[following], folder / f"{key}.flo")
                for key, following in pairwise(keys)
            )
        )

    def _pictures(self) -> dict[str, Path]:
        return named(self.root / self.images, self.image_name, f"pictures like {self.image_name}")

    def _intrinsics(self) -> Intrinsics | None:
        if self.camera is None:
            return None
        focal_x, focal_y, centre_x, centre_y = self.camera
        return opencv_camera((focal_x, focal_y), (centre_x, centre_y))


def _flow_pair(key: Path, target: Path, flow: Path) -> FlowPair:
    images = read_photo(key).pixels, read_photo(target).pixels
    field = read_flow(flow)
    if field.shape[:2] != images[0].shape[:2] or images[1].shape != images[0].shape:
        raise InputError(f"{flow}: wanted one size for it and its images {key} and {target}")
    return FlowPair(key.stem, *images, field, None)
