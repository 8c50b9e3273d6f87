import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from flexdepth.flow.field import given
from flexdepth.flow.matches import Agreement
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.scenes.pair import Solution
from flexdepth.scenes.views import Views
from flexdepth.solvers.criterion import MotionKind
from flexdepth.solvers.ego_motion import CameraMotion
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.two_frame import Evidence, Kind, Region, TwoFrame, Unknown

SIZE = 48, 36
CAMERA = Intrinsics(40.0, 40.0, 24.0, 18.0, FocalSource.GIVEN)


@pytest.fixture
def found():
    """Return what a solver might say: a square goes up before a wall, sky on the right."""
    width, height = SIZE
    labels = np.zeros((height, width), np.int32)
    labels[10:20, 8:20] = 1
    depth = np.where(labels == 1, 3.0, 6.0)
    unknown = np.zeros((height, width), np.uint8)
    depth[:, 40:], unknown[:, 40:] = np.inf, Unknown.SKY
    depth[:, :4], unknown[:, :4] = np.nan, Unknown.OCCLUDED
    translation = np.zeros((height, width, 3))
    translation[..., 0] = -1.0
    translation[labels == 1] = (-1.0, -0.5, 0.0)
    shape = height, width
    motion = CameraMotion(
        MotionKind.GENERAL,
        Pose(np.eye(3), np.array([-1.0, 0.0, 0.0])),
        None,
        None,
        dict.fromkeys(MotionKind, 1.0),
        0.9,
        1.0,
    )
    return TwoFrame(
        depth=depth,
        rotation=np.zeros((*shape, 3)),
        translation=translation,
        labels=labels,
        regions=(
            Region(0, Kind.STATIC, Evidence.CAMERA, 1.0, 0.0, int((labels == 0).sum())),
            Region(1, Kind.RIGID, Evidence.CONTACT, 0.75, 0.1, 120),
        ),
        moving=labels == 1,
        parallax=np.full(shape, 7.0),
        residual=np.full(shape, 0.1),
        flow=np.zeros((*shape, 2)),
        noise=np.full(shape, 0.1),
        spread=np.full(shape, 0.05),
        unknown=unknown,
        inferred=np.zeros(shape, bool),
        camera_motion=motion,
        prior_share=None,
        metric=False,
    )


@pytest.fixture
def solution(found):
    """Return the solution around what was found."""
    width, height = SIZE
    picture = np.random.default_rng(0).integers(0, 255, (height, width, 3)).astype(np.uint8)
    views = Views({"key": picture, "target": picture}, CAMERA, (1.0, 1.0), ())
    flow = given(np.zeros((height, width, 2), np.float32), SIZE, 0.1)
    return Solution(views, flow, Agreement(40, 0.9), None, found, "flexdepth solve (dense)", ())


@pytest.fixture
def hills():
    """Return depth of a rolling wall, its flow as the camera goes 5 cm right, and what moves."""
    width, height, focal = 160, 120, 140.0
    row, column = np.mgrid[:height, :width].astype(np.float64)
    depth = 2.0 + 0.5 * np.sin(column / 17) * np.cos(row / 13)
    flow = np.zeros((height, width, 2))
    flow[..., 0] = -focal * 0.05 / depth
    square = (slice(50, 80), slice(60, 95))
    flow[square] = (2.0, -6.0)
    moving = np.zeros((height, width), bool)
    moving[square] = True
    return depth, flow.astype(np.float32), moving


@pytest.fixture
def write_flo():
    """Return what writes a Middlebury flow file; NaN becomes the format's unknown."""

    def write(path, flow):
        height, width = flow.shape[:2]
        head = np.array([202021.25], "<f4").tobytes() + np.array([width, height], "<i4").tobytes()
        path.write_bytes(head + np.where(np.isnan(flow), 1e10, flow).astype("<f4").tobytes())
        return path

    return write


@pytest.fixture
def pair(tmp_path, hills, write_flo):
    """Write two frames of the rolling wall with their flow and camera; return their folder."""
    depth, flow, moving = hills
    height, width = depth.shape
    noise = np.random.default_rng(1).uniform(0, 255, (height, width, 3)).astype(np.float32)
    key = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 1.5), None, 0, 255, cv2.NORM_MINMAX)
    still = np.where(moving[..., None], np.float32([-3.5, 0]), flow)
    column, row = np.meshgrid(
        np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32)
    )
    target = cv2.remap(
        key, column - still[..., 0], row - still[..., 1], cv2.INTER_LINEAR, None, cv2.BORDER_REFLECT
    )
    target[50 - 6 : 80 - 6, 62:97] = key[50:80, 60:95]
    for name, picture in (("key", key), ("target", target)):
        Image.fromarray(picture.astype(np.uint8)).save(tmp_path / f"{name}.png")
    write_flo(tmp_path / "flow.flo", flow)
    camera = {"width": width, "height": height, "focal": 140.0, "centre": [79.5, 59.5]}
    Path(tmp_path / "camera.json").write_text(json.dumps(camera), "ascii")
    return tmp_path
