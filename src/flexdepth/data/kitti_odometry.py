"""KITTI's odometry sequences: images with the pose of each, as published.

    ROOT/sequences/06/image_0/000000.png        0, 1 gray, left and right; 2, 3 in colour
    ROOT/sequences/06/calib.txt                 P0 to P3, 3 x 4
    ROOT/poses/06.txt                           3 x 4 a line: world from camera 0, metres

There are poses of the sequences 00 to 10.

References:
    Geiger, Lenz and Urtasun, CVPR 2012.
"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from flexdepth.data.kitti_velodyne import field_matrix
from flexdepth.data.read import opencv_camera
from flexdepth.data.stored import named
from flexdepth.data.trajectory import Pose, rows
from flexdepth.data.views import Listed, PosedImage
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import read_photo


@dataclass(frozen=True)
class KittiOdometry:
    """The images of one camera of one sequence.

    Attributes:
        root: The folder that holds `sequences` and `poses`.
        sequence: Its number, from 0 to 10.
        camera: 0 and 1 are gray, 2 and 3 in colour; 0 and 2 are on the left.
    """

    root: Path = Path()
    sequence: int = 0
    camera: int = 2

    def load(self) -> Listed[PosedImage]:
        """Return the images, by number.

        Raises:
            InputError: A folder or a file is missing, or there are fewer poses than images.
        """
        name = f"{self.sequence:02d}"
        folder = self.root / "sequences" / name
        images = named(folder / f"image_{self.camera}", r"(\d{6})\.png", "NNNNNN.png")
        where = self.root / "poses" / f"{name}.txt"
        poses = rows(where)
        beyond = [key for key in sorted(images) if int(key) >= len(poses)]
        if beyond:
            raise InputError(
                f"{where}: holds {len(poses)} poses, but {images[beyond[0]]} needs more"
            )
        projection = field_matrix(folder / "calib.txt", f"P{self.camera}", (3, 4))
        camera = opencv_camera(
            (projection[0, 0], projection[1, 1]), (projection[0, 2], projection[1, 2])
        )
        first_from_camera = np.eye(4)
        first_from_camera[:3, 3] = -np.linalg.solve(projection[:, :3], projection[:, 3])
        return Listed(
            tuple(
                partial(
                    _posed,
                    f"{name}_{key}",
                    images[key],
                    camera,
                    poses[int(key)] @ first_from_camera,
                )
                for key in sorted(images)
            )
        )


def _posed(name: str, path: Path, camera: Intrinsics, pose: Pose) -> PosedImage:
    return PosedImage(name, read_photo(path).pixels, camera, pose)
