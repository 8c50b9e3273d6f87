"""ETH3D: laser-scanned scenes of the high-resolution and of the two-view benchmark, as published.

    ROOT/courtyard/images/dslr_images/DSC_0286.JPG
    ROOT/courtyard/ground_truth_depth/dslr_images/DSC_0286.JPG      bare float32, no picture
    ROOT/courtyard/dslr_calibration_jpg/cameras.txt, images.txt     COLMAP's text files

    ROOT/delivery_area_1l/im0.png, disp0GT.pfm, calib.txt           two views, as Middlebury 2014

Depth is z in metres for the images as they were taken, with the distortion of their lens; inf is
unknown. COLMAP counts the image's corner as 0, as here: nothing is added to principal points. The
camera is a pinhole with the published focal length, which leaves the distortion out
(THIN_PRISM_FISHEYE): points made with it are bent towards the corners of the image.

References:
    Schoeps et al., CVPR 2017, and the set's documentation; COLMAP's, on cameras.txt and images.txt.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.middlebury import calibrated_scenes
from flexdepth.data.stored import StoredPair, StoredPairs, existing, known, named, partners
from flexdepth.data.text_files import parsed, text_of
from flexdepth.data.trajectory import Pose, from_quaternion, inverse
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats.reading import reading

Key = TypeVar("Key", str, int)
Value = TypeVar("Value")

_LENSES = frozenset({"PINHOLE", "OPENCV", "OPENCV_FISHEYE", "FULL_OPENCV", "THIN_PRISM_FISHEYE"})
"""COLMAP's models whose first four numbers are fx, fy, cx, cy."""


@dataclass(frozen=True)
class RawFloats:
    """Depth in bare float32.

    Attributes:
        path: The file.
        size: Width and height.
    """

    path: Path
    size: tuple[int, int]

    def values(self) -> NDArray[np.float32]:
        """Return metres."""
        width, height = self.size
        with reading(self.path, f"{width} x {height} depths in float32", (ValueError,)):
            numbers = np.fromfile(self.path, "<f4")
            if numbers.size != width * height or self.path.stat().st_size != numbers.nbytes:
                raise ValueError(
                    f"{4 * width * height} bytes are wanted, {self.path.stat().st_size} are there"
                )
        return known(numbers.reshape(height, width))


@dataclass(frozen=True)
class Eth3d:
    """The DSLR images of the high-resolution training scenes with rendered laser scans.

    Attributes:
        root: The folder that holds a folder for each scene.
        scene: Such as `courtyard`; None takes all.
    """

    root: Path = Path()
    scene: str | None = None

    def load(self) -> StoredPairs:
        """Return the pairs, by scene and name.

        Raises:
            InputError: A folder is missing, or an image lacks its depth or its camera.
        """
        files = []
        for scene in self._scenes():
            cameras, taken = read_cameras(_calibration(scene)), read_images(_calibration(scene))
            holds = "dslr_images/DSC_NNNN.JPG"
            images = named(scene / "images", r"dslr_images/(.+)\.JPG", holds)
            depths = named(scene / "ground_truth_depth", r"dslr_images/(.+)\.JPG", holds)
            rule = "images/dslr_images/NAME.JPG needs a ground_truth_depth/dslr_images/NAME.JPG"
            for key, image, depth in partners(images, depths, rule):
                number, _ = _of(taken, key, scene)
                camera, size = _of(cameras, number, scene)
                truth = RawFloats(depth, size)
                files.append(StoredPair(f"{scene.name}_{key}", image, truth, camera, size))
        return StoredPairs(tuple(files))

    def poses(self) -> tuple[Pose, ...]:
        """Return `world_from_camera` of each pair."""
        found = []
        for scene in self._scenes():
            images = named(scene / "images", r"dslr_images/(.+)\.JPG", "dslr_images/DSC_NNNN.JPG")
            taken = read_images(_calibration(scene))
            found += [_of(taken, key, scene)[1] for key in sorted(images)]
        return tuple(found)

    def _scenes(self) -> list[Path]:
        holds = "SCENE/images/dslr_images"
        existing(self.root, holds)
        if self.scene is not None:
            return [
                existing(self.root / self.scene, "images, ground_truth_depth, dslr_calibration_jpg")
            ]
        scenes = sorted(path.parents[1] for path in self.root.glob("*/images/dslr_images"))
        if not scenes:
            raise InputError(f"{self.root}: looked for {holds}; there are none")
        return scenes


@dataclass(frozen=True)
class Eth3dStereo:
    """The gray two-view training scenes, in Middlebury's form.

    Their calibration is taken to be in Middlebury's units (`baseline` in millimetres), whose
    development kit the benchmark shares.

    Attributes:
        root: The folder that holds a folder for each scene.
    """

    root: Path = Path()

    def load(self) -> StoredPairs:
        """Return the left images, by scene.

        Raises:
            InputError: A folder is missing, or a scene lacks its image or its calibration.
        """
        return calibrated_scenes(self.root)


def read_cameras(folder: Path) -> dict[int, tuple[Intrinsics, tuple[int, int]]]:
    """Return camera and image size by number, from COLMAP's `cameras.txt`.

    Raises:
        InputError: The file is missing, or has a model without fx, fy, cx, cy.
    """
    path, found = folder / "cameras.txt", {}
    for where, words in _rows(path, "cameras of COLMAP"):
        if len(words) < 8 or words[1] not in _LENSES:
            raise InputError(
                f"{where}: wanted NUMBER MODEL WIDTH HEIGHT fx fy cx cy ..., MODEL being one of "
                f"{', '.join(sorted(_LENSES))}, got {' '.join(words)!r}"
            )
        number, width, height, focal_x, focal_y, centre_x, centre_y = parsed(
            (words[0], *words[2:8]), 7, f"{where}: wanted a camera"
        )
        found[round(number)] = (
            Intrinsics(focal_x, focal_y, centre_x, centre_y, FocalSource.GIVEN),
            (round(width), round(height)),
        )
    return found


def read_images(folder: Path) -> dict[str, tuple[int, Pose]]:
    """Return camera number and `world_from_camera` by name, from COLMAP's `images.txt`.

    The second line of each image, its points, is not read.

    Raises:
        InputError: The file is missing or damaged.
    """
    path, found = folder / "images.txt", {}
    for where, words in _rows(path, "images of COLMAP")[::2]:
        if len(words) != 10:
            raise InputError(
                f"{where}: wanted NUMBER qw qx qy qz tx ty tz CAMERA NAME, got {words[:12]}"
            )
        w, x, y, z, *translation, camera = parsed(words[1:9], 8, f"{where}: wanted a pose")
        name = Path(words[9]).stem
        camera_from_world = from_quaternion(list(translation), [x, y, z, w], path)
        found[name] = (round(camera), inverse(camera_from_world))
    return found


def _rows(path: Path, what: str) -> list[tuple[str, list[str]]]:
    """Return where each line is and its words; remarks are left out, empty lines are not."""
    lines = enumerate(text_of(path, what).splitlines(), 1)
    return [(f"{path}, line {n}", line.split()) for n, line in lines if not line.startswith("#")]


def _of(said: Mapping[Key, Value], key: Key, scene: Path) -> Value:
    if key not in said:
        raise InputError(f"{_calibration(scene)}: says nothing of the image or camera {key}")
    return said[key]


def _calibration(scene: Path) -> Path:
    return scene / "dslr_calibration_jpg"
