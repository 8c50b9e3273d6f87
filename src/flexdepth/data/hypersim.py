"""Hypersim: photorealistic rooms, as published.

    ROOT/ai_001_001/images/scene_cam_00_final_preview/frame.0000.tonemap.jpg        1024 x 768
    ROOT/ai_001_001/images/scene_cam_00_geometry_hdf5/frame.0000.depth_meters.hdf5  `dataset`
    SPLIT   metadata_images_split_scene_v1.csv of `ml-hypersim`: scene_name, camera_name, frame_id,
            included_in_public_release, split_partition_name

`depth_meters` is the Euclidean distance to the camera, which is divided out here; NaN is unknown.
The camera sees 60 degrees across with its principal point in the middle: f = 886.81. Some scenes
were rendered with shifted lenses, of which the published images say nothing.

References:
    Roberts et al., ICCV 2021, and the README of `ml-hypersim`.
"""

from collections.abc import Set
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.hdf5_files import array_of
from flexdepth.data.stored import StoredPair, StoredPairs, known, named, partners, planar
from flexdepth.data.text_files import rows_of
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.errors import InputError

CAMERA = Intrinsics.from_field_of_view(1024, 768, 60.0, FocalSource.GIVEN)

_SIZE = (1024, 768)
_COLUMNS = (
    "scene_name",
    "camera_name",
    "frame_id",
    "included_in_public_release",
    "split_partition_name",
)


class HypersimSplit(StrEnum):
    """A part of the published split v1."""

    TRAIN = "train"
    VAL = "val"
    TEST = "test"


@dataclass(frozen=True)
class HypersimDistance:
    """The distance along each ray in an HDF5 file.

    Attributes:
        path: The file.
    """

    path: Path

    def values(self) -> NDArray[np.float32]:
        """Return z in metres."""
        distance = array_of(self.path, "dataset", "a depth map of Hypersim (HDF5)")
        return known(planar(distance, CAMERA))


@dataclass(frozen=True)
class Hypersim:
    """The tone-mapped images with their depth.

    Attributes:
        root: The folder that holds a folder for each scene.
        frames: The split's table, in `root` unless its path is absolute; None takes every image
            that there is.
        split: Which part, where `frames` is given.
    """

    root: Path = Path()
    frames: Path | None = None
    split: HypersimSplit = HypersimSplit.TRAIN

    def load(self) -> StoredPairs:
        """Return the pairs, by scene, camera and frame.

        Raises:
            InputError: A folder is missing, a frame has no partner, or one of the split is missing.
        """
        scene, frame = r"(ai_\d{3}_\d{3})/images/scene_(cam_\d\d)", r"frame\.(\d{4})"
        images = named(
            self.root,
            rf"{scene}_final_preview/{frame}\.tonemap\.jpg",
            "ai_NNN_NNN/images/scene_cam_NN_final_preview/frame.NNNN.tonemap.jpg",
        )
        depths = named(
            self.root,
            rf"{scene}_geometry_hdf5/{frame}\.depth_meters\.hdf5",
            "ai_NNN_NNN/images/scene_cam_NN_geometry_hdf5/frame.NNNN.depth_meters.hdf5",
        )
        pairs = partners(
            images, depths, "frame.NNNN.tonemap.jpg needs a frame.NNNN.depth_meters.hdf5"
        )
        chosen = self._chosen(images.keys())
        return StoredPairs(
            tuple(
                StoredPair(key.replace("/", "_"), image, HypersimDistance(depth), CAMERA, _SIZE)
                for key, image, depth in pairs
                if key in chosen
            )
        )

    def _chosen(self, present: Set[str]) -> Set[str]:
        if self.frames is None:
            return present
        path = self.root / self.frames
        chosen = {
            f"{row['scene_name']}/{row['camera_name']}/{int(row['frame_id']):04d}"
            for row in rows_of(path, "a split of Hypersim", _COLUMNS)
            if row["split_partition_name"] == self.split
            and row["included_in_public_release"] == "True"
        }
        missing = sorted(chosen - present)
        if missing or not chosen:
            raise InputError(
                f"{path}: {self.split} holds {len(chosen)} images, of which {len(missing)} are not "
                f"in {self.root}: {missing[:1]}"
            )
        return chosen
