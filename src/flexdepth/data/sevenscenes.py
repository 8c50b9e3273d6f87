"""7-Scenes: RGB-D sequences of a hand-held Kinect with poses, as published.

    ROOT/TrainSplit.txt                             `sequence1`, one a line; TestSplit.txt likewise
    ROOT/seq-01/frame-000000.color.png              (or .jpg, as in copies of it)
    ROOT/seq-01/frame-000000.depth.png              16 bits, millimetres; 0 and 65535 are unknown
    ROOT/seq-01/frame-000000.pose.txt               world from camera, 4 x 4, metres

ROOT is one scene, such as `redkitchen`. Depth is not registered to colour: its edges are off by up
to about 10 pixels.

References:
    Shotton et al., Scene coordinate regression forests, CVPR 2013.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from flexdepth.data.read import Split, lines, opencv_camera
from flexdepth.data.stored import Codes, StoredPair, StoredPairs, named, partners
from flexdepth.data.trajectory import Pose, matrix
from flexdepth.runtime.errors import InputError

CAMERA = opencv_camera((585.0, 585.0), (320.0, 240.0))
"""The default camera of the set's own page, that of KinectFusion, which counts from 0.

It is the depth camera's; that of colour was never calibrated.
"""

_SIZE = (640, 480)
_LISTS = {Split.TRAIN: "TrainSplit.txt", Split.TEST: "TestSplit.txt"}
_FRAME = "frame-NNNNNN"


@dataclass(frozen=True)
class SevenScenes:
    """The frames of one scene's training or test sequences.

    Attributes:
        root: The scene's folder.
        split: Which sequences.
    """

    root: Path = Path()
    split: Split = Split.TRAIN

    def load(self) -> StoredPairs:
        """Return the pairs, by sequence and frame.

        Raises:
            InputError: A list or a sequence is missing, or a frame has no partner.
        """
        files = []
        for folder in self._sequences():
            images = named(folder, r"frame-(\d{6})\.color\.(?:png|jpg)", f"{_FRAME}.color.png")
            depths = named(folder, r"frame-(\d{6})\.depth\.png", f"{_FRAME}.depth.png")
            rule = f"{_FRAME}.color.png needs a {_FRAME}.depth.png"
            files += [
                StoredPair(
                    f"{folder.name}_{number}",
                    image,
                    Codes(depth, 1000.0, (0, 65535)),
                    CAMERA,
                    _SIZE,
                )
                for number, image, depth in partners(images, depths, rule)
            ]
        return StoredPairs(tuple(files))

    def poses(self) -> tuple[Pose, ...]:
        """Return `world_from_camera` of each pair."""
        found = []
        for folder in self._sequences():
            paths = named(folder, r"frame-(\d{6})\.pose\.txt", f"{_FRAME}.pose.txt")
            found += [matrix(paths[number]) for number in sorted(paths)]
        return tuple(found)

    def _sequences(self) -> list[Path]:
        folders = []
        for line in lines(self.root / _LISTS[self.split]):
            number = re.fullmatch(r"sequence(\d+)", " ".join(line.words))
            if number is None:
                raise InputError(f"{line.where}: wanted `sequence1`, got {' '.join(line.words)!r}")
            folders.append(self.root / f"seq-{int(number[1]):02d}")
        return folders
