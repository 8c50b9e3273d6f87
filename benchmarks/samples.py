"""The real pictures with measured depth that the benchmark scores; see docs/samples.md."""

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flexdepth.data.folder import Folder, FolderPairs, Pair
from flexdepth.data.kitti_velodyne import KittiObject
from flexdepth.data.middlebury import calibrated_scenes
from flexdepth.data.read import opencv_camera
from flexdepth.data.stored import Codes, StoredDepth, StoredPair
from flexdepth.data.sunrgbd import TurnedCodes
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError

NEAREST = 1e-3
"""Metres: truth at or below it is missing."""

INDOORS, ROAD = 10.0, 80.0
"""Caps, in metres."""


@dataclass(frozen=True)
class Score:
    """AbsRel (smaller is better) and delta1 (larger is better)."""

    abs_rel: float
    delta1: float

    def __str__(self) -> str:
        """Return the way papers write it: .123/.456."""
        return "/".join(f"{x:.3f}".removeprefix("0") for x in (self.abs_rel, self.delta1))


@dataclass(frozen=True)
class Pgm:
    """Millimetres in a 16-bit PGM, 0 where nothing was measured."""

    path: Path

    def values(self) -> NDArray[np.float32]:
        """Return metres."""
        with Image.open(self.path) as picture:
            metres = np.asarray(picture).astype(np.float32) / np.float32(1000)
        return np.where(metres > 0, metres, np.float32(np.nan))


Read = Callable[[Path], StoredDepth]


@dataclass(frozen=True)
class Numbered:
    """Pictures and their depth, which belong together by the last number in their names.

    Attributes:
        images: Below the folder of all samples, with a `*`.
        truths: Likewise; the stars may stand for different words.
        frames: How many are scored, the first by number.
        read: What a file of depth holds.
        camera: Of all pictures; None where nobody says it.
    """

    images: str
    truths: str
    frames: int
    read: Read
    camera: Intrinsics | None

    def load(self, samples: Path) -> tuple[StoredPair, ...]:
        """Return the pairs.

        Raises:
            InputError: The folder holds fewer, or a picture has no truth of its number.
        """
        images, truths = (
            {_number(path): path for path in samples.glob(pattern)}
            for pattern in (self.images, self.truths)
        )
        numbers = sorted(images.keys() & truths.keys())[: self.frames]
        if len(numbers) < self.frames:
            raise InputError(
                f"{samples / self.images}: wanted {self.frames} pictures with a truth, "
                f"found {len(numbers)}; docs/samples.md says where to take them from"
            )
        return tuple(
            StoredPair(images[n].stem, images[n], self.read(truths[n]), self.camera)
            for n in numbers
        )


class Readable(Protocol):
    """A picture with its truth on disk."""

    def read(self) -> Pair:
        """Return both."""
        ...


@dataclass(frozen=True)
class SampleSet:
    """One set of pictures with measured depth.

    Attributes:
        name: As the tables have it.
        cap: The farthest truth that is scored, in metres.
        load: Its pictures in the folder of all samples, or in its own.
        dense: Its truth is known nearly everywhere and lies where the picture's edges lie.
    """

    name: str
    cap: float
    load: Callable[[Path], Sequence[Readable]]
    dense: bool = False


@dataclass(frozen=True)
class _OfFolder:
    """One of the pairs of a folder."""

    pairs: FolderPairs
    number: int

    def read(self) -> Pair:
        return self.pairs[self.number]


def _folder(root: Path) -> Sequence[Readable]:
    pairs = Folder(root).load()
    return [_OfFolder(pairs, number) for number in range(len(pairs))]


RENDERED = SampleSet("rendered", ROAD, _folder, dense=True)
"""What `flexdepth synth` wrote into a folder of its own."""


def _number(path: Path) -> int:
    """Return the last number in a name; 0 where there is none."""
    return int((re.findall(r"\d+", path.name) or ["0"])[-1])


def _several(parts: Sequence[Numbered], samples: Path) -> tuple[StoredPair, ...]:
    """Return the pictures of one set that lie in several places."""
    return tuple(pair for part in parts for pair in part.load(samples))


def _laser(samples: Path) -> Sequence[StoredPair]:
    return KittiObject(samples / "driving_kitti_object").load().files


def _motorcycle(samples: Path) -> Sequence[StoredPair]:
    """Return Middlebury's scene: z = baseline · f / (disparity + doffs)."""
    root = samples / "stereo_motorcycle_sceneflow_kitti15" / "MIDDLEBURY_2014" / "trainingQ"
    return calibrated_scenes(root).files


_MILLIMETRES: Read = partial(Codes, steps_per_metre=1000.0)
_FIVE_THOUSANDTHS: Read = partial(Codes, steps_per_metre=5000.0)
_KITTI: Read = partial(Codes, steps_per_metre=256.0)

SETS = (
    SampleSet(
        "7-Scenes",
        INDOORS,
        Numbered(
            "indoor_7scenes_redkitchen/frames/*.color.jpg",
            "indoor_7scenes_redkitchen/frames/*.depth.png",
            180,
            partial(Codes, steps_per_metre=1000.0, unknown=(0, 65535)),
            opencv_camera((585.0, 585.0), (320.0, 240.0)),
        ).load,
    ),
    SampleSet(
        "NYU",
        INDOORS,
        Numbered(
            "mixed_metric3d_kitti_nyu_wild/nyu_demo/rgb/*.jpg",
            "mixed_metric3d_kitti_nyu_wild/nyu_demo/depth/*.png",
            3,
            _MILLIMETRES,
            opencv_camera((518.8579, 519.46961), (325.58245, 253.73617)),
        ).load,
    ),
    SampleSet(
        "ICL-NUIM",
        INDOORS,
        Numbered(
            "indoor_iclnuim_livingroom1/image/*.jpg",
            "indoor_iclnuim_livingroom1/depth/*.png",
            120,
            _MILLIMETRES,
            opencv_camera((525.0, 525.0), (319.5, 239.5)),
        ).load,
        dense=True,
    ),
    SampleSet(
        "KITTI",
        ROAD,
        Numbered(
            "mixed_metric3d_kitti_nyu_wild/kitti_demo/rgb/*.png",
            "mixed_metric3d_kitti_nyu_wild/kitti_demo/depth/*.png",
            3,
            _KITTI,
            opencv_camera((707.0493, 707.0493), (604.0814, 180.5066)),
        ).load,
    ),
    SampleSet("KITTI laser", ROAD, _laser),
    SampleSet(
        "TUM",
        INDOORS,
        partial(
            _several,
            (
                Numbered(
                    "indoor_slambook2/ch7_tum_fr2_desk/[12].png",
                    "indoor_slambook2/ch7_tum_fr2_desk/[12]_depth.png",
                    2,
                    _FIVE_THOUSANDTHS,
                    opencv_camera((520.9, 521.0), (325.1, 249.7)),
                ),
                Numbered(
                    "indoor_open3d_samples/other_formats/TUM_color.png",
                    "indoor_open3d_samples/other_formats/TUM_depth.png",
                    1,
                    _FIVE_THOUSANDTHS,
                    opencv_camera((525.0, 525.0), (319.5, 239.5)),
                ),
            ),
        ),
    ),
    SampleSet(
        "SUN RGB-D",
        INDOORS,
        Numbered(
            "indoor_open3d_samples/other_formats/SUN_color.jpg",
            "indoor_open3d_samples/other_formats/SUN_depth.png",
            1,
            TurnedCodes,
            None,
        ).load,
    ),
    SampleSet(
        "NYU dining",
        INDOORS,
        Numbered(
            "indoor_slambook2/ch5_nyu_diningroom/color/*.png",
            "indoor_slambook2/ch5_nyu_diningroom/depth/*.pgm",
            5,
            Pgm,
            opencv_camera((518.0, 519.0), (325.5, 253.5)),
        ).load,
    ),
    SampleSet(
        "ICL living",
        INDOORS,
        Numbered(
            "indoor_slambook2/ch12_iclnuim/color/*.png",
            "indoor_slambook2/ch12_iclnuim/depth/*.png",
            5,
            _FIVE_THOUSANDTHS,
            opencv_camera((481.2, 480.0), (319.5, 239.5)),
        ).load,
        dense=True,
    ),
    SampleSet("Motorcycle", INDOORS, _motorcycle),
)


def usual_folder() -> Path:
    """Return where samples lie unless told: $FLEXDEPTH_SAMPLES, else beside the repository."""
    beside = Path(__file__).parents[2] / "shared" / "data"
    return Path(os.environ.get("FLEXDEPTH_SAMPLES") or beside)


def present(path: Path) -> Path:
    """Return the path of a file of the samples.

    Raises:
        FileNotFoundError: There is none.
    """
    if not path.is_file():
        raise FileNotFoundError(
            f"{path} is missing; docs/samples.md says where to take it from, and --samples DIR or "
            "FLEXDEPTH_SAMPLES=DIR where it lies"
        )
    return path


def scored_pixels(truth: NDArray[np.float64], cap: float) -> NDArray[np.bool_]:
    """Return where the truth lies between `NEAREST` and the cap, both excluded."""
    return (truth > NEAREST) & (truth < cap)
