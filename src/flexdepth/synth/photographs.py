"""Photographs in a rendered world: as prints and posters, as views from windows, and as skies.

A folder of any photographs will do: no depth of them is needed, for that of a print is the depth
of what it is on, and a sky is infinitely far.
"""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.runtime.images import photos_in, read_photo
from flexdepth.runtime.opening import open_input
from flexdepth.synth.patterns import SIZE

Photo = NDArray[np.float32]
"""Rows by columns by 3, linear light, 1 is white."""

MOST = 64
"""Photographs of a folder that one world shows."""

_SIDE = 480
"""Pixels of the longer side at which photographs are kept."""

_LEAST_CUT = 0.5
"""Share of a photograph's height and width that a print shows at least."""

_FINE, _BUSY, _MANY = 2.0, 0.03, 0.01
"""Clouds have no detail of this many pixels, as an error of gray; trees and roofs have, in this
share of a row."""

_LEAST_SKY = 0.25
"""Of a photograph's height."""

_DARK, _GREEN, _RED = 0.08, 1.05, 4.0
"""The least light of a sky; the most green beside the stronger of red and blue; the most red of a
red sky beside its faintest colour."""

_GAMMA = 2.2


def photograph_files(folder: Path) -> list[Path]:
    """Return the photographs in a folder and the folders in it, by name.

    Raises:
        InputError: There is no such folder, or no photograph in it.
    """
    return photos_in(folder, "**/*")


def digest(files: Sequence[Path]) -> str:
    """Return what tells these photographs, in this order, from all others, wherever they lie.

    Raises:
        InputError: One cannot be read.
    """
    total = hashlib.sha256()
    for path in files:
        with open_input(path) as file:
            total.update(hashlib.sha256(file.read()).digest())
    return total.hexdigest()[:16]


def photographs(rng: Generator, files: Sequence[Path]) -> list[Photo]:
    """Return some of the photographs, all if they are few: small, in linear light.

    Raises:
        InputError: One cannot be read.
    """
    chosen = rng.permutation(len(files))[:MOST]
    return [_small(read_photo(files[k]).pixels) for k in chosen]


def _small(pixels: NDArray[np.uint8]) -> Photo:
    height, width = pixels.shape[:2]
    scale = min(1.0, _SIDE / max(height, width))
    size = max(2, round(scale * width)), max(2, round(scale * height))
    # 16 bits, lest the means of many pixels be rounded to the steps of one.
    deep = pixels * np.uint16(257)
    shrunk = cv2.resize(deep, size, interpolation=cv2.INTER_AREA)
    return np.asarray((shrunk / np.float32(65535)) ** _GAMMA, np.float32)


def cuts(rng: Generator, photos: Sequence[Photo], count: int) -> list[Photo]:
    """Return square prints of parts of photographs, each photograph alike often."""
    return [_cut(rng, photos[k % len(photos)]) for k in range(count)]


def _cut(rng: Generator, photo: Photo) -> Photo:
    spans = []
    for length in photo.shape[:2]:
        kept = max(2, round(float(rng.uniform(_LEAST_CUT, 1)) * length))
        first = int(rng.integers(length - kept + 1))
        spans.append(slice(first, first + kept))
    return np.asarray(cv2.resize(photo[tuple(spans)], (SIZE, SIZE), interpolation=cv2.INTER_AREA))


def skies(photos: Sequence[Photo]) -> list[Photo]:
    """Return the skies of those photographs that have one, the horizon at the last row."""
    return [sky for sky in map(_sky, photos) if sky is not None]


def _sky(photo: Photo) -> Photo | None:
    """Return the rows above all that is finely structured, unless they are few or no sky's."""
    gray = photo.mean(-1) ** np.float32(1 / _GAMMA)
    detail = np.abs(gray - cv2.GaussianBlur(gray, (0, 0), _FINE))
    busy = np.flatnonzero((detail > _BUSY).mean(1) > _MANY)
    # The blur sees what is below as well.
    end = int(busy[0] - 2 * _FINE) if len(busy) else len(photo)
    if end < _LEAST_SKY * len(photo):
        return None
    colour = photo[:end].mean((0, 1))
    red, green, blue = colour
    dark, leafy = colour.max() < _DARK, green > _GREEN * max(red, blue)
    painted = red >= blue and red > _RED * colour.min()
    return None if dark or leafy or painted else photo[:end]
