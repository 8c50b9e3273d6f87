"""Where the cameras of a sequence were, as `world_from_camera`: 4 x 4, metres.

The camera looks along z, its x points right and its y down; the world's axes are the set's own.
Sets write poses in several ways; each function reads one.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.text_files import numbers_of, parsed, text_of
from flexdepth.runtime.errors import InputError

Pose = NDArray[np.float64]
"""`world_from_camera`, 4 x 4."""

_DOWN = np.diag([1.0, -1.0, 1.0, 1.0])


def matrix(path: Path) -> Pose:
    """Return the pose in a file of 4 x 4 numbers."""
    return np.array(numbers_of(path, 16, "a pose of 4 x 4 numbers")).reshape(4, 4)


def rows(path: Path) -> tuple[Pose, ...]:
    """Return the poses of a file with 3 x 4 numbers a line, as KITTI writes them."""
    lines = [line for line in text_of(path, "poses").splitlines() if line.strip()]
    where = f"{path}, line {{}}: wanted a pose"
    found = [parsed(line.split(), 12, where.format(n)) for n, line in enumerate(lines, 1)]
    last = [0.0, 0.0, 0.0, 1.0]
    return tuple(np.array([*numbers, *last]).reshape(4, 4) for numbers in found)


def stamped(path: Path) -> tuple[tuple[float, Pose], ...]:
    """Return (time, pose) of each line `time tx ty tz qx qy qz qw`, as TUM writes them.

    Lines that begin with # are remarks.
    """
    wanted = "a trajectory, a line each: time tx ty tz qx qy qz qw"
    found = []
    for number, line in enumerate(text_of(path, wanted).splitlines(), 1):
        if line.strip() and not line.lstrip().startswith("#"):
            words = line.replace(",", " ").split()
            time, *rest = parsed(words, 8, f"{path}, line {number}: wanted {wanted}")
            found.append((time, from_quaternion(rest[:3], rest[3:], path)))
    return tuple(found)


def log(path: Path) -> tuple[Pose, ...]:
    """Return the poses of an Open3D log: for each frame a line of three numbers and 4 x 4 more."""
    numbers = text_of(path, "a trajectory log").split()
    if not numbers or len(numbers) % 19:
        raise InputError(
            f"{path}: wanted a trajectory log, 3 + 16 numbers a frame, got {len(numbers)} numbers"
        )
    every = np.array(parsed(numbers, len(numbers), f"{path}: wanted a trajectory log"))
    return tuple(every.reshape(-1, 19)[:, 3:].reshape(-1, 4, 4))


def from_quaternion(translation: list[float], quaternion: list[float], path: Path) -> Pose:
    """Return the pose of a translation and a quaternion x, y, z, w of any length but zero."""
    x, y, z, w = quaternion
    square = x * x + y * y + z * z + w * w
    if not square > 0:
        raise InputError(f"{path}: a rotation's quaternion is {quaternion}, which turns nothing")
    s = 2 / square
    pose = np.eye(4)
    pose[:3, :3] = [
        [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
        [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
        [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
    ]
    pose[:3, 3] = translation
    return pose


def inverse(pose: Pose) -> Pose:
    """Return the pose the other way round: rotation transposed, translation turned back."""
    back = np.eye(4)
    back[:3, :3] = pose[:3, :3].T
    back[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return back


def turned_down(pose: Pose) -> Pose:
    """Return the pose of a set whose y points up, with y down in camera and world.

    It is conjugated with diag(1, -1, 1), which leaves a rotation a rotation.
    """
    turned: Pose = _DOWN @ pose @ _DOWN
    return turned
