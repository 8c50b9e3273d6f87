"""From a stored pair to a training sample: crop, size, mirror. Colour is `data/colour.py`.

Whatever moves the pixels moves image, depth and camera together. Depth stays in metres: a crop
does not bring the world nearer, it makes the focal length longer in image diagonals. Only `shrunk`
changes depth, and says so.
"""

from dataclasses import dataclass, replace
from math import exp, log

import cv2
import numpy as np
import torch
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.data.folder import Pair
from flexdepth.geometry.camera import Camera
from flexdepth.runtime.depthmap import DepthMap, Intrinsics
from flexdepth.sample import Frame, Sample, Truth

_GREY = 128


@dataclass(frozen=True)
class Crop:
    """A random part of the image, brought to the wanted size, mirrored half of the time.

    Attributes:
        smallest: The least share of the largest possible crop's side that is kept.
        stretch: Pixels are stretched sideways by at most this factor, or its inverse.
    """

    smallest: float = 0.55
    stretch: float = 1.12

    def __call__(self, rng: Generator, pair: Pair, width: int, height: int) -> Pair:
        """Return the pair at `width` by `height`."""
        rows, columns = pair.truth.values.shape
        share = exp(rng.uniform(log(self.smallest), 0)) if rng.random() < 0.8 else 1.0
        stretch = exp(rng.uniform(-1, 1) * log(self.stretch))
        aspect = width / height * stretch
        wide = share * min(columns, rows * aspect)
        tall = wide / aspect
        across, down = max(1, int(wide)), max(1, int(tall))
        left, top = rng.integers(0, columns - across + 1), rng.integers(0, rows - down + 1)
        box = (int(left), int(top), across, down)
        cut = resized(cropped(pair, box), width, height)
        return mirrored(cut) if rng.random() < 0.5 else cut


def cropped(pair: Pair, box: tuple[int, int, int, int]) -> Pair:
    """Return the part of the pair in (left, top, width, height), in whole pixels."""
    left, top, width, height = box
    rows, columns = slice(top, top + height), slice(left, left + width)
    camera = _camera(pair)
    shifted = replace(camera, centre_x=camera.centre_x - left, centre_y=camera.centre_y - top)
    return _remade(pair, pair.image[rows, columns], pair.truth.values[rows, columns], shifted)


def resized(pair: Pair, width: int, height: int) -> Pair:
    """Return the pair at another size: the image averaged, the depth of the nearest pixel.

    Depth is never interpolated, for between two things there is nothing.
    """
    rows, columns = pair.truth.values.shape
    shrinks = width * height < rows * columns
    image = cv2.resize(
        pair.image, (width, height), interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    )
    depth = cv2.resize(pair.truth.values, (width, height), interpolation=cv2.INTER_NEAREST_EXACT)
    camera = _camera(pair).scaled(width / columns, height / rows)
    return _remade(pair, np.asarray(image, np.uint8), np.asarray(depth, np.float32), camera)


def mirrored(pair: Pair) -> Pair:
    """Return the pair with left and right exchanged."""
    camera = _camera(pair)
    width = pair.truth.values.shape[1]
    turned = replace(camera, centre_x=width - camera.centre_x)
    return _remade(pair, pair.image[:, ::-1], pair.truth.values[:, ::-1], turned)


def padded(pair: Pair, left: int, top: int) -> Pair:
    """Return the pair with grey columns on its left and grey rows on top, of unknown depth."""
    grown = ((top, 0), (left, 0))
    image = np.pad(pair.image, (*grown, (0, 0)), constant_values=_GREY)
    depth = np.pad(pair.truth.values, grown, constant_values=np.nan)
    camera = _camera(pair)
    shifted = replace(camera, centre_x=camera.centre_x + left, centre_y=camera.centre_y + top)
    return _remade(pair, image, depth, shifted)


def shrunk(pair: Pair, ratio: float) -> Pair:
    """Return the same picture of a world `ratio` times smaller: normals stay, depth is divided."""
    return _remade(pair, pair.image, pair.truth.values / np.float32(ratio), _camera(pair))


def as_sample(pair: Pair) -> Sample:
    """Return the pair as tensors."""
    camera, depth = _camera(pair), np.ascontiguousarray(pair.truth.values)
    image = np.ascontiguousarray(pair.image.transpose(2, 0, 1))
    valid = pair.truth.valid & (depth > 0)
    return Sample(
        name=pair.name,
        key=Frame(
            torch.from_numpy(image).float() / 255,
            Camera.of(camera),
        ),
        truth=Truth(
            torch.from_numpy(np.where(valid, depth, 1)),
            torch.from_numpy(valid),
            torch.from_numpy(np.ascontiguousarray(pair.truth.sky)),
        ),
    )


def _camera(pair: Pair) -> Intrinsics:
    if pair.truth.intrinsics is None:
        raise ValueError(f"{pair.name} has no camera")
    return pair.truth.intrinsics


def _remade(
    pair: Pair, image: NDArray[np.uint8], depth: NDArray[np.float32], camera: Intrinsics
) -> Pair:
    return Pair(pair.name, image, DepthMap(depth, pair.truth.space, camera, pair.truth.model))
