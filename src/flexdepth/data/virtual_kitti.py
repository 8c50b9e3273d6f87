"""Virtual KITTI 1.3.1 and 2: rendered streets in several weathers, as published.

    ROOT/vkitti_1.3.1_rgb/0001/clone/00000.png                                      version 1
    ROOT/vkitti_1.3.1_depthgt/0001/clone/00000.png
    ROOT/vkitti_1.3.1_extrinsicsgt/0001_clone.txt       frame, then 4 x 4: camera from world

    ROOT/Scene01/clone/frames/rgb/Camera_0/rgb_00000.jpg                            version 2
    ROOT/Scene01/clone/frames/depth/Camera_0/depth_00000.png
    ROOT/Scene01/clone/intrinsic.txt                    frame cameraID fx fy cx cy
    ROOT/Scene01/clone/extrinsic.txt                    frame cameraID, then 4 x 4: likewise

Depth has 16 bits, z in centimetres; 65535 is sky, which is not 655 m away. The archives of version
2 may be unpacked into one folder or kept in `vkitti_2.0.3_rgb`, `_depth` and `_textgt`. Principal
points count the first pixel's centre as 0: 620.5, 187 is the middle of 1242 x 375.

References:
    Gaidon et al., CVPR 2016; Cabon, Murray and Humenberger, Virtual KITTI 2, 2020.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexdepth.data.read import opencv_camera
from flexdepth.data.stored import Codes, StoredPair, StoredPairs, existing, named, partners
from flexdepth.data.text_files import parsed, text_of
from flexdepth.data.trajectory import Pose, inverse
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError

CAMERA_1 = opencv_camera((725.0, 725.0), (620.5, 187.0))
"""Of version 1, in every frame."""

_SIZE = (1242, 375)
_SKY = 65535
_ARCHIVES = ("", "vkitti_2.0.3_rgb", "vkitti_2.0.3_depth", "vkitti_2.0.3_textgt")


@dataclass(frozen=True)
class VirtualKitti1:
    """One variation of one world of version 1.

    Attributes:
        root: The folder that holds the unpacked archives.
        world: 0001, 0002, 0006, 0018 or 0020.
        variation: Such as `clone`, `fog` or `15-deg-left`.
    """

    root: Path = Path()
    world: str = "0001"
    variation: str = "clone"

    def load(self) -> StoredPairs:
        """Return the pairs, by frame.

        Raises:
            InputError: A folder is missing, or a frame has no partner.
        """
        place = f"{self.world}/{self.variation}"
        images = named(self.root / "vkitti_1.3.1_rgb" / place, r"(\d{5})\.png", "NNNNN.png")
        depths = named(self.root / "vkitti_1.3.1_depthgt" / place, r"(\d{5})\.png", "NNNNN.png")
        rule = "vkitti_1.3.1_rgb/.../NNNNN.png needs a vkitti_1.3.1_depthgt/.../NNNNN.png"
        return StoredPairs(
            tuple(
                StoredPair(
                    f"{self.world}_{self.variation}_{key}", image, _codes(depth), CAMERA_1, _SIZE
                )
                for key, image, depth in partners(images, depths, rule)
            )
        )

    def poses(self) -> tuple[Pose, ...]:
        """Return `world_from_camera` of each pair."""
        name = f"{self.world}_{self.variation}.txt"
        table = _table(self.root / "vkitti_1.3.1_extrinsicsgt" / name, 1, 16)
        return tuple(inverse(np.array(table[key]).reshape(4, 4)) for key in sorted(table))


@dataclass(frozen=True)
class VirtualKitti2:
    """One variation of one scene of version 2, seen by one camera.

    Attributes:
        root: The folder that holds `Scene01` and so on, or the three unpacked archives.
        scene: Scene01, Scene02, Scene06, Scene18 or Scene20.
        variation: Such as `clone`, `fog` or `15-deg-left`.
        camera: 0 on the left, 1 on the right.
    """

    root: Path = Path()
    scene: str = "Scene01"
    variation: str = "clone"
    camera: int = 0

    def load(self) -> StoredPairs:
        """Return the pairs, by frame.

        Raises:
            InputError: A folder or the intrinsics are missing, or a frame has no partner.
        """
        eye = f"Camera_{self.camera}"
        images = named(self._below(f"frames/rgb/{eye}"), r"rgb_(\d{5})\.jpg", "rgb_NNNNN.jpg")
        depths = named(self._below(f"frames/depth/{eye}"), r"depth_(\d{5})\.png", "depth_NNNNN.png")
        table = _table(self._below("intrinsic.txt"), 2, 4)
        stem = f"{self.scene}_{self.variation}_{eye}"
        return StoredPairs(
            tuple(
                StoredPair(
                    f"{stem}_{key}", image, _codes(depth), self._intrinsics(table, key), _SIZE
                )
                for key, image, depth in partners(
                    images, depths, "rgb_NNNNN.jpg needs a depth_NNNNN.png"
                )
            )
        )

    def poses(self) -> tuple[Pose, ...]:
        """Return `world_from_camera` of each pair."""
        table = _table(self._below("extrinsic.txt"), 2, 16)
        own = (key for key in sorted(table) if key[1] == self.camera)
        return tuple(inverse(np.array(table[key]).reshape(4, 4)) for key in own)

    def _below(self, rest: str) -> Path:
        existing(self.root, "Scene01/VARIATION/frames, or vkitti_2.0.3_rgb and the like")
        place = Path(self.scene, self.variation, rest)
        paths = [self.root / archive / place for archive in _ARCHIVES]
        return next((path for path in paths if path.exists()), paths[0])

    def _intrinsics(self, table: dict[tuple[int, ...], Sequence[float]], key: str) -> Intrinsics:
        if (int(key), self.camera) not in table:
            path = self._below("intrinsic.txt")
            raise InputError(f"{path}: says nothing of frame {int(key)}, camera {self.camera}")
        focal_x, focal_y, centre_x, centre_y = table[int(key), self.camera]
        return opencv_camera((focal_x, focal_y), (centre_x, centre_y))


def _codes(path: Path) -> Codes:
    return Codes(path, 100.0, sky=_SKY)


def _table(path: Path, keys: int, count: int) -> dict[tuple[int, ...], Sequence[float]]:
    """Return the numbers of each line by its first `keys` numbers; the first line is a header."""
    found: dict[tuple[int, ...], Sequence[float]] = {}
    for number, line in enumerate(text_of(path, "a table of Virtual KITTI").splitlines()[1:], 2):
        if line.strip():
            wanted = f"{path}, line {number}: wanted"
            numbers = parsed(line.split(), keys + count, wanted)
            found[tuple(round(each) for each in numbers[:keys])] = numbers[keys:]
    if not found:
        raise InputError(f"{path}: wanted a header and a line for each frame; it is empty")
    return found
