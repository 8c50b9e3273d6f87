"""Contact sheets: a world at a glance, written beside it."""

import json
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.colour import coloured, limits
from flexdepth.runtime.files import read_depth
from flexdepth.runtime.images import read_photo
from flexdepth.synth.sequence_files import sequence_folder
from flexdepth.synth.shapes import Array

Picture = NDArray[np.uint8]

_WIDTH = 160
"""Pixels of one picture on a sheet."""

_IMAGES, _COLUMNS, _SEQUENCES = 24, 6, 12

NAME = "sheet.png"
"""The sheet of a world, in its folder."""


def write_image_sheet(folder: Path, count: int) -> Path:
    """Write the sheet of a world of `count` images: some of them, each above its depth.

    Raises:
        InputError: An image is missing, or the sheet cannot be written.
    """
    cells = []
    for index in _spread(count, _IMAGES):
        photo = read_photo(folder / "image" / f"{index:06d}.jpg").pixels
        cells.append(np.concatenate([_small(photo), _depth(folder / "depth" / f"{index:06d}.npz")]))
    rows = [cells[k : k + _COLUMNS] for k in range(0, len(cells), _COLUMNS)]
    return _written(folder, rows)


def write_sequence_sheet(folder: Path, count: int) -> Path:
    """Write the sheet of a world of `count` sequences: a row for some of them.

    A row has the first frame, its depth, its flow, what of it moves (green) and is not seen in
    the next frame (red), and the last frame.

    Raises:
        InputError: A sequence is missing, or the sheet cannot be written.
    """
    rows = []
    for index in _spread(count, _SEQUENCES):
        one = sequence_folder(folder, index)
        said = json.loads((one / "sequence.json").read_text("ascii"))
        first, last = (
            _small(read_photo(one / "image" / f"{number:04d}.jpg").pixels)
            for number in (0, said["frames"] - 1)
        )
        rows.append([first, _depth(one / "depth" / "0000.npz")])
        if said["frames"] > 1:
            rows[-1] += [*_ways(one), last]
    return _written(folder, rows)


def flow_colours(flow: Array) -> Picture:
    """Return flow as colours: the direction is the hue, red to the right; still is white.

    The 99th percentile of its length is fully saturated. What is NaN is black.
    """
    known = np.asarray(np.isfinite(flow).all(-1), bool)
    safe = np.where(known[..., None], flow, 0)
    length = np.linalg.norm(safe, axis=-1)
    full = max(float(np.percentile(length[known], 99)) if known.any() else 1.0, 1e-9)
    hue = np.degrees(np.arctan2(safe[..., 1], safe[..., 0])) % 360 / 2
    bands = (hue, 255 * np.clip(length / full, 0, 1), 255 * known)
    hsv = np.stack([np.floor(band) for band in bands], -1).astype(np.uint8)
    return np.asarray(cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB), np.uint8)


def _ways(folder: Path) -> tuple[Picture, Picture]:
    """Return the first frame's flow, and its masks, as pictures."""
    with np.load(folder / "points" / "0000.npz") as points:
        moving, occluded = points["moving"], points["occluded"]
    content = (folder / "flow" / "0000.flo").read_bytes()
    flow = np.frombuffer(content[12:], "<f4").reshape(*moving.shape, 2)
    flow = np.where(np.abs(flow) < 1e9, flow, np.nan)
    masks = np.stack([occluded, moving, np.zeros_like(moving)], -1)
    return _small(flow_colours(flow)), _small(np.uint8(210) * masks.astype(np.uint8))


def _spread(count: int, most: int) -> list[int]:
    """Return at most so many numbers below `count`, evenly spread."""
    return sorted(set(np.linspace(0, count - 1, min(count, most)).astype(int).tolist()))


def _small(picture: Picture) -> Picture:
    height = max(1, round(picture.shape[0] * _WIDTH / picture.shape[1]))
    return np.asarray(cv2.resize(picture, (_WIDTH, height), interpolation=cv2.INTER_AREA), np.uint8)


def _depth(file: Path) -> Picture:
    depth = read_depth(file)
    return _small(coloured(depth, limits(depth)))


def _written(folder: Path, rows: list[list[Picture]]) -> Path:
    """Write rows of equal pictures as one; what a row lacks stays white."""
    width = max(len(row) for row in rows)
    blank = np.full_like(rows[0][0], 255)
    full = [np.concatenate([*row, *[blank] * (width - len(row))], axis=1) for row in rows]
    with replacing(folder / NAME) as path:
        Image.fromarray(np.concatenate(full)).save(path)
    return folder / NAME
