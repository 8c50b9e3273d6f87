"""ICL-NUIM: ray-traced rooms with exact depth, in the three forms in which they are published.

    ROOT/associations.txt           `0 depth/0.png 0 rgb/0.png`, a line each     "TUM compatible"
    ROOT/depth/0.png                16 bits, z in 1/5000 m, 0 is unknown
    ROOT/livingRoom0.gt.freiburg    number tx ty tz qx qy qz qw

    ROOT/scene_00_0000.png                                                       "POV-Ray"
    ROOT/scene_00_0000.depth        text, the distance along each ray: metres in the living room,
                                    centimetres in the office

    ROOT/image/00000.jpg            (or color)                          the augmented scenes of 2015
    ROOT/depth/00000.png            16 bits, z in millimetres
    ROOT/NAME.log                   world from camera

The first two have fx = 481.2, fy = -480, cx = 319.5, cy = 239.5, counted from 0: their y points up.
Here fy is 480, y points down and poses are conjugated with diag(1, -1, 1).

References:
    Handa et al., ICRA 2014, with `VaFRIC.cpp` (`getEuclidean2PlanarDepth`); Choi, Zhou and Koltun,
    CVPR 2015.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.read import Line, lines, opencv_camera
from flexdepth.data.stored import Codes, StoredPair, StoredPairs, known, named, partners, planar
from flexdepth.data.text_files import parsed, text_of
from flexdepth.data.trajectory import Pose, log, stamped, turned_down
from flexdepth.runtime.errors import InputError

CAMERA = opencv_camera((481.2, 480.0), (319.5, 239.5))
"""Of the rooms of 2014, with y down."""
AUGMENTED_CAMERA = opencv_camera((525.0, 525.0), (319.5, 239.5))

_SIZE = (640, 480)


@dataclass(frozen=True)
class IclNuim:
    """One sequence in the form that is compatible with TUM RGB-D.

    Attributes:
        root: Its folder.
    """

    root: Path = Path()

    def load(self) -> StoredPairs:
        """Return the pairs, in the order of `associations.txt`.

        Raises:
            InputError: The list or a file that it names is missing.
        """
        found = (_associated(self.root, line) for line in lines(self.root / "associations.txt"))
        return StoredPairs(
            tuple(
                StoredPair(image.stem, image, Codes(depth, 5000.0), CAMERA, _SIZE)
                for _, image, depth in found
            )
        )

    def poses(self) -> tuple[Pose | None, ...]:
        """Return `world_from_camera` of each pair, None where the file skips its number."""
        path = _only(self.root, "*.gt.freiburg")
        recorded = {round(number): turned_down(pose) for number, pose in stamped(path)}
        every = lines(self.root / "associations.txt")
        return tuple(recorded.get(_associated(self.root, line)[0]) for line in every)


@dataclass(frozen=True)
class PovRayDistance:
    """The distance along each ray in a text file.

    Attributes:
        path: The file.
        steps_per_metre: What one metre is in it.
    """

    path: Path
    steps_per_metre: float

    def values(self) -> NDArray[np.float32]:
        """Return z in metres."""
        width, height = _SIZE
        what = f"the distances of {width} x {height} pixels"
        numbers = parsed(
            text_of(self.path, what).split(), width * height, f"{self.path}: wanted {what}"
        )
        metres = np.array(numbers).reshape(height, width) / self.steps_per_metre
        return known(planar(metres.astype(np.float32), CAMERA))


@dataclass(frozen=True)
class IclNuimPovRay:
    """One sequence in POV-Ray's own form.

    Attributes:
        root: Its folder.
        steps_per_metre: What one metre is in the files: 1 in the living room, 100 in the office.
    """

    root: Path = Path()
    steps_per_metre: float = 1.0

    def load(self) -> StoredPairs:
        """Return the pairs, by number.

        Raises:
            InputError: The folder holds no frames, or a frame has no partner.
        """
        stem = r"(scene_(?:\d\d_)?\d{3,4})"
        images = named(self.root, rf"{stem}\.png", "scene_NN_NNNN.png")
        depths = named(self.root, rf"{stem}\.depth", "scene_NN_NNNN.depth")
        rule = "scene_NN_NNNN.png needs a scene_NN_NNNN.depth"
        return StoredPairs(
            tuple(
                StoredPair(key, image, PovRayDistance(depth, self.steps_per_metre), CAMERA, _SIZE)
                for key, image, depth in partners(images, depths, rule)
            )
        )


@dataclass(frozen=True)
class IclNuimAugmented:
    """One of the augmented scenes, its clean or its simulated depth.

    Attributes:
        root: Its folder, with `image` (or `color`) and `depth`.
    """

    root: Path = Path()

    def load(self) -> StoredPairs:
        """Return the pairs, by number.

        Raises:
            InputError: The folder holds no frames, or a frame has no partner.
        """
        images = named(self.root, r"(?:image|color)/(\d+)\.(?:jpg|png)", "image/NNNNN.jpg")
        depths = named(self.root, r"depth/(\d+)\.png", "depth/NNNNN.png")
        return StoredPairs(
            tuple(
                StoredPair(key, image, Codes(depth, 1000.0), AUGMENTED_CAMERA, _SIZE)
                for key, image, depth in partners(
                    images, depths, "image/NNNNN needs a depth/NNNNN.png"
                )
            )
        )

    def poses(self) -> tuple[Pose, ...]:
        """Return `world_from_camera` of each pair, in the order of their numbers."""
        recorded, count = log(_only(self.root, "*.log")), len(self.load())
        if len(recorded) < count:
            raise InputError(
                f"{_only(self.root, '*.log')}: holds {len(recorded)} poses for {count} frames"
            )
        return recorded[:count]


def _associated(root: Path, line: Line) -> tuple[int, Path, Path]:
    """Return number, image and depth of a line of `associations.txt`."""
    match = re.fullmatch(r"(\d+) (depth/\S+\.png) \d+ (rgb/\S+\.png)", " ".join(line.words))
    if match is None:
        raise InputError(
            f"{line.where}: wanted '0 depth/0.png 0 rgb/0.png', got {' '.join(line.words)!r}"
        )
    image, depth = root / match[3], root / match[2]
    for path in (image, depth):
        if not path.is_file():
            raise InputError(f"{line.where}: looked for {path}; there is no such file")
    return int(match[1]), image, depth


def _only(folder: Path, pattern: str) -> Path:
    found = sorted(folder.glob(pattern))
    if len(found) != 1:
        raise InputError(f"{folder}: wanted one file {pattern} with the poses, found {len(found)}")
    return found[0]
