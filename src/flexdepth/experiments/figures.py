"""Figures of chapter 3 of any photos: where the decoder looks (3.12), edges (1.7 and 3.2)."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from flexdepth.geometry.camera import Camera
from flexdepth.networks import Built
from flexdepth.runtime.colour import Pixels, limits, palette
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import SUFFIXES, read_depth
from flexdepth.runtime.images import Photo, read_photo
from flexdepth.runtime.lens import Said, intrinsics
from flexdepth.runtime.picture import panels, preview
from flexdepth.runtime.sizes import resized
from flexdepth.sample import Frame, Prediction, Sample, in_metres

AREA = 384 * 288
"""Pixels at which the network looks at a photo."""

MULTIPLE = 32
"""Of which the sides of what the network sees are multiples."""

_RARE = (1, 99)
"""Percentiles between which a map's shades lie."""

_LONG_SIDE = (384, 1024)
"""Least and most pixels of the longer side of a photo in a figure."""


@dataclass(frozen=True, eq=False)
class Look:
    """A photo, and what a network makes of it.

    Attributes:
        photo: RGB, at the size of the figure.
        depth: Predicted, at the same size.
        attention: The maps of the merges, coarsest first, at their own sizes; in [0, 1] as a rule.
        truth: Measured depth where it is known.
    """

    photo: Pixels
    depth: DepthMap
    attention: tuple[NDArray[np.float32], ...]
    truth: DepthMap | None


@torch.no_grad()
def look(network: Built, path: Path, truth: Path | None) -> Look:
    """Return what a network sees in a photo.

    Depth is in metres where the network's does not depend on the camera, or the camera is known:
    from the truth or from the photo itself.

    Args:
        network: Ready to predict.
        path: Of the photo.
        truth: A depth file of the photo; None where there is none.

    Raises:
        InputError: A file cannot be read.
    """
    photo = read_photo(path)
    known = None if truth is None else read_depth(truth)
    pixels = _for_figure(photo.pixels)
    height, width = pixels.shape[:2]
    seen = _network_size(width, height)
    image = torch.from_numpy(resized(pixels, seen)).permute(2, 0, 1)[None].float() / 255
    prediction = network(image)
    camera, certain = _camera(photo, known, prediction.focal)
    metric = prediction.canonical_focal is None or certain
    values = _metres(prediction, image, camera, (width, height))
    return Look(
        pixels,
        DepthMap(values, Space.METRIC if metric else Space.SCALE),
        tuple(each[0, 0].numpy() for each in prediction.attention),
        known,
    )


def truth_beside(path: Path, folder: Path | None) -> Path | None:
    """Return the depth file of a photo: of its name in a folder, or where data folders have it.

    A photo ROOT/image/NAME.jpg has its depth in ROOT/depth/NAME.npz, or another format's file.

    Args:
        path: Of the photo.
        folder: Where to look; None looks beside a folder that is called `image`.
    """
    if folder is None:
        if path.parent.name != "image":
            return None
        folder = path.parent.parent / "depth"
    found = (folder / f"{path.stem}{suffix}" for suffix in SUFFIXES.values())
    return next((each for each in found if each.is_file()), None)


def strongest(attention: Sequence[NDArray[np.float32]]) -> int:
    """Return which map is the strongest: that with the largest mean, the finer of two equals.

    Raises:
        InputError: There is no map.
    """
    if not attention:
        raise InputError(
            "the network has no map of spatial attention: its merges are by channels alone (S1)"
        )
    means = [float(each.mean()) for each in attention]
    return max(range(len(means)), key=lambda number: (means[number], number))


def attention_figure(seen: Look, which: int) -> Pixels:
    """Return photo, one map of attention, predicted depth and, where it is known, true depth.

    The map's shades go from its 1st to its 99th percentile, which its title gives. Depth has the
    colours of the truth where both are in metres.

    Args:
        seen: What the network sees.
        which: Of the attention maps, coarsest first.

    References:
        Fig. 3.12 of the dissertation, whose "largest attention map" is here the finest or the
        strongest, as chosen.
    """
    chosen = seen.attention[which]
    low, high = np.percentile(chosen, _RARE)
    rows, columns = chosen.shape
    pictures = [seen.photo, _shades(chosen, seen.photo)]
    titles = ["photo", f"attention {columns}x{rows}: {low:.2f} to {high:.2f}"]
    shown = None
    if seen.truth is not None and seen.truth.space is Space.METRIC is seen.depth.space:
        ends = limits(seen.truth)
        shown = None if ends.empty else ends
    pictures.append(preview(seen.depth, shown))
    titles.append("prediction")
    if seen.truth is not None:
        pictures.append(preview(_resized_map(seen.truth, seen.photo)))
        titles.append("truth")
    return panels(pictures, titles)


def edges_figure(photo: Pixels, depth: DepthMap, title: str) -> Pixels:
    """Return photo and depth, and below them the size of the Laplacian of each.

    Most of a photo's edges are texture and colour, and most of depth's are edges of things. The
    Laplacian is that of the logarithm of depth: of depth itself, where it goes far, only the
    farthest edges would be seen.

    Args:
        photo: RGB.
        depth: Of the photo; sky is as far as its farthest known pixel.
        title: Whose depth it is.

    References:
        Figs 1.7 and 3.2 of the dissertation.
    """
    same = _resized_map(depth, photo)
    grey = cv2.cvtColor(photo, cv2.COLOR_RGB2GRAY).astype(np.float32)
    known = same.valid & (same.values > 0)
    far = same.values[known].max(initial=0) or 1.0
    values = np.log(np.where(known, same.values, far)).astype(np.float32)
    upper = panels([photo, _without_legend(preview(same), photo)], ["photo", title])
    lower = panels([_laplacian(grey), _laplacian(values)], ["edges of the photo", "edges of depth"])
    return np.concatenate([upper, lower])


def _laplacian(values: NDArray[np.float32]) -> Pixels:
    """Return the absolute Laplacian in grey, white at its 99th percentile."""
    edges = np.abs(cv2.Laplacian(values, cv2.CV_32F, ksize=3))
    white = float(np.percentile(edges, _RARE[1])) or 1.0
    grey = np.clip(255 * edges / white, 0, 255).astype(np.uint8)
    return np.repeat(grey[..., None], 3, 2)


def _shades(values: NDArray[np.float32], photo: Pixels) -> Pixels:
    height, width = photo.shape[:2]
    low, high = np.percentile(values, _RARE)
    scaled = np.clip((values - low) / max(high - low, 1e-6), 0, 1).astype(np.float32)
    return palette()[np.round(255 * resized(scaled, (width, height))).astype(np.uint8)]


def _without_legend(picture: Pixels, photo: Pixels) -> Pixels:
    return picture[: photo.shape[0]]


def _resized_map(depth: DepthMap, photo: Pixels) -> DepthMap:
    """Return a map at the photo's size by the nearest pixel, for depth is not interpolated."""
    height, width = photo.shape[:2]
    values = cv2.resize(depth.values, (width, height), interpolation=cv2.INTER_NEAREST_EXACT)
    return DepthMap(np.asarray(values, np.float32), depth.space)


def _for_figure(pixels: Pixels) -> Pixels:
    height, width = pixels.shape[:2]
    longer = max(height, width)
    ratio = min(max(longer, _LONG_SIDE[0]), _LONG_SIDE[1]) / longer
    return resized(pixels, (max(1, round(ratio * width)), max(1, round(ratio * height))))


def _network_size(width: int, height: int) -> tuple[int, int]:
    scale = sqrt(AREA / (width * height)) / MULTIPLE
    return MULTIPLE * max(1, round(scale * width)), MULTIPLE * max(1, round(scale * height))


def _camera(photo: Photo, truth: DepthMap | None, seen: Tensor | None) -> tuple[Camera, bool]:
    """Return the camera in parts of the photo's sides, and whether it is known."""
    height, width = photo.pixels.shape[:2]
    said = Said(photo.focal_in_diagonals, None if seen is None else float(seen[0]))
    own = intrinsics(width, height, None, said)
    if truth is not None and truth.intrinsics is not None:
        (height, width), own = truth.values.shape, truth.intrinsics
    focal = torch.tensor([[own.focal_x / width, own.focal_y / height]])
    centre = torch.tensor([[own.centre_x / width, own.centre_y / height]])
    return Camera(focal, centre), own.source.is_known


def _metres(
    prediction: Prediction, image: Tensor, camera: Camera, size: tuple[int, int]
) -> NDArray[np.float32]:
    """Return the depth in metres for a camera, at a size, +inf in the sky."""
    height, width = image.shape[-2:]
    sample = Sample(("photo",), Frame(image, camera.resized(float(width), float(height))), None)
    depth = in_metres(prediction.depth, prediction, sample)[0]
    values = resized(np.ascontiguousarray(depth.numpy()), size)
    if prediction.sky_logit is not None:
        sky = resized(np.ascontiguousarray(prediction.sky_logit[0].numpy()), size)
        values[sky > 0] = np.inf
    return values
