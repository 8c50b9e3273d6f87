"""TUM RGB-D: Kinect sequences with motion capture, as published.

    ROOT/rgb.txt            `1305031102.175304 rgb/1305031102.175304.png`, a line each
    ROOT/depth.txt          likewise; 16-bit PNG, 1/5000 m, 0 is unknown
    ROOT/groundtruth.txt    time tx ty tz qx qy qz qw, world from camera

ROOT is one sequence, such as `rgbd_dataset_freiburg1_desk`. Colour and depth have clocks of their
own: frames belong together that are at most 20 ms apart, the nearest first, as in the set's
`associate.py`; others are left out. Depth is registered to colour. Images of freiburg1 and
freiburg2 are published with the distortion of their lens, which is not undone here.

References:
    Sturm et al., A benchmark for the evaluation of RGB-D SLAM systems, IROS 2012; its pages on
    file formats and intrinsic calibration.
"""

import re
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType

from flexdepth.data.read import lines, opencv_camera
from flexdepth.data.stored import Codes, StoredPair, StoredPairs
from flexdepth.data.trajectory import Pose, stamped
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError

_SIZE = (640, 480)
_SECONDS = 0.02


class TumCamera(StrEnum):
    """Which Kinect, as calibrated on the set's page; the first pixel's centre is 0 there."""

    FREIBURG1 = "freiburg1"
    FREIBURG2 = "freiburg2"
    FREIBURG3 = "freiburg3"
    ROS = "ros"
    """The driver's default, with which the registration of depth was done."""


CAMERAS = MappingProxyType(
    {
        TumCamera.FREIBURG1: opencv_camera((517.3, 516.5), (318.6, 255.3)),
        TumCamera.FREIBURG2: opencv_camera((520.9, 521.0), (325.1, 249.7)),
        TumCamera.FREIBURG3: opencv_camera((535.4, 539.2), (320.1, 247.6)),
        TumCamera.ROS: opencv_camera((525.0, 525.0), (319.5, 239.5)),
    }
)


@dataclass(frozen=True)
class Tum:
    """One sequence.

    Attributes:
        root: Its folder.
        camera: Which Kinect; None takes the one that the folder's name says.
    """

    root: Path = Path()
    camera: TumCamera | None = None

    def load(self) -> StoredPairs:
        """Return the pairs, by the time of their image.

        Raises:
            InputError: A list or a file that it names is missing, no image has a depth map of its
                time, or the camera is not known.
        """
        camera = self._intrinsics()
        images, depths = (listed(self.root / name) for name in ("rgb.txt", "depth.txt"))
        pairs = associated([time for time, _ in images], [time for time, _ in depths])
        if not pairs:
            raise InputError(
                f"{self.root / 'depth.txt'}: no time in it is within {_SECONDS} s of one in rgb.txt"
            )
        files = ((images[first][1], depths[second][1]) for first, second in pairs)
        return StoredPairs(
            tuple(
                StoredPair(image.stem, image, Codes(depth, 5000.0), camera, _SIZE)
                for image, depth in files
            )
        )

    def poses(self) -> tuple[Pose | None, ...]:
        """Return `world_from_camera` of each pair: the nearest in time, None beyond 20 ms."""
        images, depths = (listed(self.root / name) for name in ("rgb.txt", "depth.txt"))
        times = [time for time, _ in images]
        paired = [times[first] for first, _ in associated(times, [time for time, _ in depths])]
        recorded = stamped(self.root / "groundtruth.txt")
        when = dict(associated(paired, [time for time, _ in recorded]))
        return tuple(
            recorded[when[number]][1] if number in when else None for number in range(len(paired))
        )

    def _intrinsics(self) -> Intrinsics:
        if self.camera is not None:
            return CAMERAS[self.camera]
        said = re.search(r"freiburg[123]", self.root.resolve().name)
        if said is None:
            raise InputError(
                f"{self.root}: its name does not say which camera, such as freiburg1; give camera, "
                f"one of {', '.join(TumCamera)}"
            )
        return CAMERAS[TumCamera(said[0])]


def listed(path: Path) -> tuple[tuple[float, Path], ...]:
    """Return (time, file) of each line of `rgb.txt` or `depth.txt`, by time.

    Raises:
        InputError: The list or a file in it is missing, or a line is no time and file.
    """
    found = []
    for line in lines(path):
        if line.words[0].startswith("#"):
            continue
        try:
            time, name = line.words
            found.append((float(time), path.parent / name))
        except ValueError as error:
            raise InputError(
                f"{line.where}: wanted a time and a file, got {' '.join(line.words)!r}"
            ) from error
        if not found[-1][1].is_file():
            raise InputError(f"{line.where}: looked for {found[-1][1]}; there is no such file")
    return tuple(sorted(found))


def associated(
    first: Sequence[float], second: Sequence[float], seconds: float = _SECONDS
) -> list[tuple[int, int]]:
    """Return which of two sorted lists of times belong together, by number, in their order.

    Of all pairs less than `seconds` apart, the nearest are taken first, and no time twice.
    """
    near = [
        (abs(time - second[j]), i, j)
        for i, time in enumerate(first)
        for j in range(bisect_left(second, time - seconds), bisect_left(second, time + seconds))
    ]
    taken: tuple[set[int], set[int]] = (set(), set())
    pairs = []
    for _, i, j in sorted(near):
        if i not in taken[0] and j not in taken[1]:
            taken[0].add(i)
            taken[1].add(j)
            pairs.append((i, j))
    return sorted(pairs)
