from pathlib import Path

import cv2
import numpy as np
import pytest

from flexdepth.data.folder import Pair
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space


@pytest.fixture
def picture():
    """Return a function that writes a plain picture of a size, whatever suffix it is to have."""

    def write(path, width=640, height=480, shade=90):
        path.parent.mkdir(parents=True, exist_ok=True)
        kind = ".jpg" if path.suffix.lower() in (".jpg", ".jpeg", ".thumb") else ".png"
        _, content = cv2.imencode(kind, np.full((height, width, 3), shade, np.uint8))
        Path(path).write_bytes(content.tobytes())
        return path

    return write


@pytest.fixture
def codes():
    """Return a function that writes an array as 16-bit PNG; 640 x 480 of one code by default."""

    def write(path, stored=None, fill=1000, width=640, height=480):
        path.parent.mkdir(parents=True, exist_ok=True)
        array = np.full((height, width), fill) if stored is None else np.asarray(stored)
        path.write_bytes(cv2.imencode(".png", array.astype(np.uint16))[1].tobytes())
        return path

    return write


@pytest.fixture
def reprojection_error():
    """Return a function: how far the depth of one frame, moved to another, is from that one's."""

    def error(key, target, world_from_key, world_from_target):
        depth, camera = key.truth.values.astype(float), key.truth.intrinsics
        height, width = depth.shape
        across = (np.arange(width) + 0.5 - camera.centre_x) / camera.focal_x
        down = (np.arange(height) + 0.5 - camera.centre_y) / camera.focal_y
        points = np.stack([across[None] * depth, down[:, None] * depth, depth, np.ones_like(depth)])
        target_from_key = np.linalg.inv(world_from_target) @ world_from_key
        x, y, z, _ = target_from_key @ points.reshape(4, -1)
        known = np.isfinite(z) & (z > 0)
        column = np.floor(x[known] / z[known] * camera.focal_x + camera.centre_x)
        row = np.floor(y[known] / z[known] * camera.focal_y + camera.centre_y)
        inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        seen = target.truth.values[row[inside].astype(int), column[inside].astype(int)]
        return float(np.nanmedian(np.abs(z[known][inside] - seen) / seen))

    return error


WIDTH, HEIGHT = 320, 240
HALF_ROOM = np.array([2.2, 1.2, 2.6])


def room(seed):
    """Return a picture of a room with two boxes on its floor, with exact depth."""
    rng = np.random.default_rng(seed)
    camera = Intrinsics.centred(WIDTH, HEIGHT, rng.uniform(230, 260), FocalSource.GIVEN)
    column, row = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    rays = np.stack(
        [
            (column - camera.centre_x) / camera.focal_x,
            (row - camera.centre_y) / camera.focal_y,
            np.ones_like(row),
        ],
        axis=-1,
    )
    yaw, pitch = rng.uniform(-0.6, 0.6), rng.uniform(0.2, 0.45)
    turn = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    nod = np.array(
        [[1, 0, 0], [0, np.cos(pitch), np.sin(pitch)], [0, -np.sin(pitch), np.cos(pitch)]]
    )
    world = rays @ (turn @ nod).T
    at = np.array([rng.uniform(-0.5, 0.5), -0.3, -2.2])
    _, depth, face = slabs(at, world, -HALF_ROOM, HALF_ROOM)
    for number in (1, 2):
        half = rng.uniform(0.2, 0.5, 3)
        middle = np.array([rng.uniform(-1, 1), HALF_ROOM[1] - half[1], rng.uniform(-0.4, 1.5)])
        into, out, side = slabs(at, world, middle - half, middle + half)
        hit = (into > 0) & (into < out) & (into < depth)
        depth, face = np.where(hit, into, depth), np.where(hit, 10 * number + side, face)
    colours = rng.integers(30, 225, (30, 3))
    image = colours[face] + rng.normal(0, 4, (HEIGHT, WIDTH, 3))
    truth = DepthMap(depth.astype(np.float32), Space.METRIC, camera)
    return Pair(f"room_{seed}", image.clip(0, 255).astype(np.uint8), truth)


def slabs(at, rays, low, high):
    """Return where rays enter and leave a box, and through which face they are seen."""
    with np.errstate(divide="ignore"):
        ends = (np.stack([low, high]) - at)[:, None, None] / rays
    near, far = ends.min(axis=0), ends.max(axis=0)
    into, out = near.max(axis=-1), far.min(axis=-1)
    inside = bool(((at > low) & (at < high)).all())
    axis = far.argmin(axis=-1) if inside else near.argmax(axis=-1)
    beyond = np.take_along_axis(rays, axis[..., None], -1)[..., 0] > 0
    return into, out, 2 * axis + beyond


@pytest.fixture(scope="session")
def rooms():
    """Ten pictures of rooms with exact depth."""
    return tuple(room(seed) for seed in range(10))


@pytest.fixture(scope="session")
def model(rooms):
    """What a model would see in the pictures of the rooms: their depth, a third too large."""
    seen = {
        pair.image.tobytes(): DepthMap(pair.truth.values * np.float32(1.3), Space.METRIC)
        for pair in rooms
    }
    return lambda pair: seen[pair.image.tobytes()]
