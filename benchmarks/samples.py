"""The real pictures with measured depth that the benchmark scores; see docs/samples.md."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.errors import InputError

NEAREST = 1e-3
"""Metres: truth at or below it is missing."""


@dataclass(frozen=True)
class Score:
    """AbsRel (smaller is better) and delta1 (larger is better)."""

    abs_rel: float
    delta1: float

    def reaches(self, bar: "Score") -> bool:
        """Return whether both numbers are at least as good as the bar's."""
        return self.abs_rel <= bar.abs_rel and self.delta1 >= bar.delta1

    def __str__(self) -> str:
        """Return the way papers write it: .123/.456."""
        return "/".join(f"{x:.3f}".removeprefix("0") for x in (self.abs_rel, self.delta1))


@dataclass(frozen=True)
class SampleSet:
    """One set of pictures with measured depth; the n-th picture goes with the n-th truth."""

    name: str
    images: str
    truths: str
    frames: int
    steps_per_metre: float
    cap: float
    camera: Intrinsics
    bar: Score


@dataclass(frozen=True)
class Frame:
    """One picture and its measured depth, by path."""

    image: Path
    truth: Path


def opencv_camera(focal: float, centre_x: float, centre_y: float) -> Intrinsics:
    """Return the camera of a file that counts the first pixel's centre as 0."""
    return Intrinsics(focal, focal, centre_x + 0.5, centre_y + 0.5, FocalSource.GIVEN)


SETS = (
    SampleSet(
        "7-Scenes",
        "indoor_7scenes_redkitchen/frames/*.color.jpg",
        "indoor_7scenes_redkitchen/frames/*.depth.png",
        frames=180,
        steps_per_metre=1000.0,
        cap=10.0,
        camera=opencv_camera(585.0, 320.0, 240.0),
        bar=Score(0.19, 0.64),
    ),
    SampleSet(
        "NYU",
        "mixed_metric3d_kitti_nyu_wild/nyu_demo/rgb/*.jpg",
        "mixed_metric3d_kitti_nyu_wild/nyu_demo/depth/*.png",
        frames=3,
        steps_per_metre=1000.0,
        cap=10.0,
        camera=opencv_camera(519.16, 325.5825, 253.7362),
        bar=Score(0.18, 0.75),
    ),
    SampleSet(
        "ICL-NUIM",
        "indoor_iclnuim_livingroom1/image/*.jpg",
        "indoor_iclnuim_livingroom1/depth/*.png",
        frames=120,
        steps_per_metre=1000.0,
        cap=10.0,
        camera=opencv_camera(525.0, 319.5, 239.5),
        bar=Score(0.10, 0.90),
    ),
    SampleSet(
        "KITTI",
        "mixed_metric3d_kitti_nyu_wild/kitti_demo/rgb/*.png",
        "mixed_metric3d_kitti_nyu_wild/kitti_demo/depth/*.png",
        frames=3,
        steps_per_metre=256.0,
        cap=80.0,
        camera=opencv_camera(707.0493, 604.0814, 180.5066),
        bar=Score(0.17, 0.78),
    ),
)


def frames(samples: Path, sample_set: SampleSet) -> list[Frame]:
    """Return the set's first frames by number, as many as the benchmark scores.

    Raises:
        InputError: The folder holds fewer, or a picture has no truth of its number.
    """
    images, truths = (
        {int(re.findall(r"\d+", path.name)[-1]): path for path in samples.glob(pattern)}
        for pattern in (sample_set.images, sample_set.truths)
    )
    numbers = sorted(images.keys() & truths.keys())[: sample_set.frames]
    if len(numbers) < sample_set.frames:
        raise InputError(
            f"{samples / sample_set.images}: wanted {sample_set.frames} pictures with a truth, "
            f"found {len(numbers)}; docs/samples.md says where to take them from"
        )
    return [Frame(images[number], truths[number]) for number in numbers]


def read_truth(path: Path, steps_per_metre: float) -> NDArray[np.float64]:
    """Return the measured depth in metres, 0 where there is none."""
    with Image.open(path) as picture:
        return np.asarray(picture).astype(np.float64) / steps_per_metre


def scored_pixels(truth: NDArray[np.float64], cap: float) -> NDArray[np.bool_]:
    """Return where the truth lies between `NEAREST` and the cap, both excluded."""
    return (truth > NEAREST) & (truth < cap)
