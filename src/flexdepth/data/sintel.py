"""MPI-Sintel: depth, cameras and optical flow of the animated film, as published.

    ROOT/training/clean/alley_1/frame_0001.png          or final
    ROOT/training/depth/alley_1/frame_0001.dpt          z in metres
    ROOT/training/camdata_left/alley_1/frame_0001.cam   intrinsics and world to camera
    ROOT/training/flow/alley_1/frame_0001.flo           from frame 1 to frame 2
    ROOT/training/occlusions/alley_1/frame_0001.png     white where the flow is hidden
    ROOT/training/invalid/alley_1/frame_0001.png        white where it leaves the image

The published depth of the sky and of far backgrounds is a large finite number, which stays one:
the protocols of the literature leave it out by their cap (70 m).

References:
    Butler, Wulff, Stanley and Black, ECCV 2012; the depth and camera data of 2015.
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.read import opencv_camera
from flexdepth.data.stored import StoredPair, StoredPairs, gray, known, named, partners
from flexdepth.data.tagged_floats import read_cam, read_dpt, read_flow
from flexdepth.data.trajectory import Pose, inverse
from flexdepth.data.views import FlowPair, Listed
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import read_photo

_FRAME = r"([a-z]+_\d/frame_\d{4})\.%s"
_SIZE = (1024, 436)


class SintelPass(StrEnum):
    """How the film is rendered."""

    CLEAN = "clean"
    """With shading and reflections."""
    FINAL = "final"
    """With fog, motion blur and depth of field as well."""


@dataclass(frozen=True)
class SintelDepth:
    """The depth in a .dpt file."""

    path: Path

    def values(self) -> NDArray[np.float32]:
        """Return metres."""
        return known(read_dpt(self.path))


@dataclass(frozen=True)
class Sintel:
    """Images with rendered depth.

    Attributes:
        root: The folder that holds `training`.
        rendering: Clean or final.
        scene: Such as `alley_1`; None takes all 23.
    """

    root: Path = Path()
    rendering: SintelPass = SintelPass.CLEAN
    scene: str | None = None

    def load(self) -> StoredPairs:
        """Return the pairs, by scene and frame.

        Raises:
            InputError: A folder is missing, or a frame lacks its image, its depth or its camera.
        """
        cameras = _files(self.root, "camdata_left", "cam", self.scene)
        frames = _frames(
            self, _files(self.root, "depth", "dpt", self.scene), "depth/SCENE/FRAME.dpt"
        )
        partners(
            {key: image for key, image, _ in frames},
            cameras,
            "frame needs a camdata_left/SCENE/FRAME.cam",
        )
        return StoredPairs(
            tuple(
                StoredPair(
                    key.replace("/", "_"), image, SintelDepth(depth), camera(cameras[key]), _SIZE
                )
                for key, image, depth in frames
            )
        )

    def poses(self) -> tuple[Pose, ...]:
        """Return `world_from_camera` of each pair."""
        cameras = _files(self.root, "camdata_left", "cam", self.scene)
        return tuple(_world_from_camera(cameras[key]) for key in sorted(cameras))


@dataclass(frozen=True)
class SintelFlow:
    """Pairs of successive images with rendered optical flow.

    Attributes:
        root: The folder that holds `training`.
        rendering: Clean or final.
        scene: Such as `alley_1`; None takes all 23.
    """

    root: Path = Path()
    rendering: SintelPass = SintelPass.CLEAN
    scene: str | None = None

    def load(self) -> Listed[FlowPair]:
        """Return the pairs, by scene and frame; the last frame of a scene has no flow.

        Flow that ends outside the next image is known here, for it is rendered; `invalid` is the
        set's mark of it, and is not read.

        Raises:
            InputError: A folder is missing, or a flow lacks one of its images or its occlusions.
        """
        images = _images(self)
        flows = _files(self.root, "flow", "flo", self.scene)
        hidden = _files(self.root, "occlusions", "png", self.scene)
        partners(flows, hidden, "flow/SCENE/FRAME.flo needs an occlusions/SCENE/FRAME.png")
        readers = []
        for key in sorted(flows):
            following = f"{key[:-4]}{int(key[-4:]) + 1:04d}"
            for wanted in (key, following):
                if wanted not in images:
                    raise InputError(
                        f"{flows[key]}: looked for {self.rendering}/{wanted}.png; there is none"
                    )
            paths = (images[key], images[following], flows[key], hidden[key])
            readers.append(partial(flow_pair, key.replace("/", "_"), *paths))
        return Listed(tuple(readers))


def camera(path: Path) -> Intrinsics:
    """Return the camera of a .cam file.

    Its principal point is that of OpenCV's convention (511.5, 217.5 in the middle of an image of
    1024 x 436), so half a pixel is added.
    """
    intrinsic, _ = read_cam(path)
    return opencv_camera(
        (float(intrinsic[0, 0]), float(intrinsic[1, 1])),
        (float(intrinsic[0, 2]), float(intrinsic[1, 2])),
    )


def flow_pair(name: str, key: Path, target: Path, flow: Path, occluded: Path) -> FlowPair:
    """Return what the four files hold.

    Raises:
        InputError: One is damaged, or of another size than the first image.
    """
    images = read_photo(key).pixels, read_photo(target).pixels
    field, mask = read_flow(flow), gray(occluded) > 127
    for path, shape in (
        (target, images[1].shape[:2]),
        (flow, field.shape[:2]),
        (occluded, mask.shape),
    ):
        if shape != images[0].shape[:2]:
            raise InputError(
                f"{path}: is {shape[1]}x{shape[0]}, its image {key} "
                f"{images[0].shape[1]}x{images[0].shape[0]}; take the files as they are published"
            )
    return FlowPair(name, *images, field, mask)


def _world_from_camera(path: Path) -> Pose:
    _, extrinsic = read_cam(path)
    return inverse(np.vstack([extrinsic, [0.0, 0.0, 0.0, 1.0]]))


def _files(root: Path, kind: str, suffix: str, scene: str | None) -> dict[str, Path]:
    holds = f"{scene or 'SCENE'}/frame_NNNN.{suffix}"
    found = named(root / "training" / kind, _FRAME % suffix, holds)
    chosen = {key: path for key, path in found.items() if scene in (None, key.split("/")[0])}
    if not chosen:
        raise InputError(f"{root / 'training' / kind}: looked for {holds}; there are none")
    return chosen


def _images(setting: Sintel | SintelFlow) -> dict[str, Path]:
    return _files(setting.root, setting.rendering, "png", setting.scene)


def _frames(
    setting: Sintel, others: dict[str, Path], rule: str
) -> tuple[tuple[str, Path, Path], ...]:
    return partners(_images(setting), others, f"{setting.rendering}/SCENE/FRAME.png needs a {rule}")
