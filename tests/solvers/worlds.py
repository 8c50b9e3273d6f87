"""A world by formulas: a floor, a wall and a box that moves, seen by a camera that moves."""

from dataclasses import dataclass

import numpy as np

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.solvers.two_frame import Seen

WIDTH, HEIGHT, FOCAL = 120, 90, 105.0
CAMERA = Intrinsics.centred(WIDTH, HEIGHT, FOCAL, FocalSource.GIVEN)
EYE = 1.4
"""The camera's height over the floor."""
WALL = 12.0


@dataclass(frozen=True)
class Box:
    """The front of a box: middle of its lower edge and its size; it stands if its foot is EYE."""

    x: float = 0.3
    foot: float = EYE
    z: float = 4.0
    width: float = 1.6
    height: float = 1.4

    def covers(self, rays):
        """Return where rays from (0, 0, 0) hit it, at z."""
        x, y = rays[..., 0] * self.z, rays[..., 1] * self.z
        return (
            (np.abs(x - self.x) < self.width / 2) & (y < self.foot) & (y > self.foot - self.height)
        )

    def moved(self, way):
        return Box(self.x + way[0], self.foot + way[1], self.z + way[2], self.width, self.height)


def rays():
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    x, y = (column - WIDTH / 2) / FOCAL, (row - HEIGHT / 2) / FOCAL
    return np.stack([x, y, np.ones_like(x)], -1)


@dataclass(frozen=True, eq=False)
class View:
    """What the key frame shows, and what another frame makes of it."""

    depth: np.ndarray
    mover: np.ndarray
    flow: np.ndarray
    hidden: np.ndarray

    def seen(self, noise=0.01, seed=0, **more):
        off = np.random.default_rng(seed).normal(0, noise, self.flow.shape) if noise > 0.01 else 0
        deviation = np.where(self.hidden, np.nan, noise).astype(np.float32)
        return Seen((self.flow + off).astype(np.float32), deviation, CAMERA, **more)


def view(rotation, translation, box=None, way=(0.0, 0.0, 0.0)):
    """Return the view: the camera moves by R X + t, the box by its own way before that."""
    key = rays()
    with np.errstate(divide="ignore"):
        floor = np.where(key[..., 1] > 0, EYE / key[..., 1], np.inf)
    depth = np.minimum(floor, WALL)
    mover = np.zeros(depth.shape, bool)
    if box is not None:
        mover = box.covers(key) & (box.z < depth)
        depth = np.where(mover, box.z, depth)
    points = key * depth[..., None] + mover[..., None] * np.asarray(way)
    there = points @ rotation.T + translation
    shift = (there[..., :2] / there[..., 2:] - key[..., :2]) * FOCAL
    place = shift + key[..., :2] * FOCAL
    outside = (np.abs(place[..., 0]) > WIDTH / 2) | (np.abs(place[..., 1]) > HEIGHT / 2)
    hidden = outside
    if box is not None:
        eye = -rotation.T @ translation
        front = box.moved(way)
        sight = points - eye
        share = (front.z - eye[2]) / sight[..., 2]
        at = eye + sight * share[..., None]
        hit = (np.abs(at[..., 0] - front.x) < front.width / 2) & (at[..., 1] < front.foot)
        hit &= at[..., 1] > front.foot - front.height
        hidden = hidden | (hit & (share < 0.999) & ~mover)
    return View(depth, mover, shift, hidden)


def abs_rel(found, truth, where):
    """Return the error after one factor for all; what is not known counts as the median depth."""
    known = np.isfinite(found)
    scaled = found * np.median(truth[known] / found[known])
    filled = np.where(known, scaled, np.median(scaled[known]))
    return float((np.abs(filled - truth) / truth)[where].mean())
