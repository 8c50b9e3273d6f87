"""16-bit PNG: one gray channel of codes, and the meaning in an iTXt chunk `flexdepth`.

0 is unknown, 65535 is sky, 1 to 65534 are values, to half a step:

* metric depth that rounds to at most 65.534 m: the code is millimetres, as most tools expect;
* other depth: `value = scale * code`, the largest value at 65534;
* affine spaces, and anything with negative values or all zero: `value = scale * code + offset`,
  the least value at 1 and the largest at 65534.

A value below half a step takes the code 1, so that it stays valid.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from PIL.PngImagePlugin import PngImageFile, PngInfo

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.formats.meaning import Coding, Meaning, parsed
from flexdepth.runtime.formats.reading import check_size, reading

INVALID, NEAREST, FARTHEST, SKY = 0, 1, 65534, 65535
MILLIMETRE = 0.001

_KEY = "flexdepth"
_ROWS_AT_ONCE = 256
_ERRORS = (ValueError, SyntaxError, TypeError, KeyError, IndexError, EOFError, OverflowError)


def write(path: Path, depth_map: DepthMap, origin: Mapping[str, str] | None) -> None:
    """Write `depth_map` and its meaning to `path`."""
    chosen = coding(depth_map.values, depth_map.space)
    text = PngInfo()
    text.add_itxt(_KEY, Meaning.of(depth_map, chosen, origin).text())
    picture = Image.fromarray(codes(depth_map.values, chosen))
    with replacing(path) as temporary:
        picture.save(temporary, format="PNG", compress_level=1, pnginfo=text)


def numbers(path: Path) -> NDArray[np.uint16]:
    """Return the codes in `path`, once its checksums have been found right."""
    with reading(path, "a 16-bit PNG", _ERRORS):
        with PngImageFile(path) as picture:
            check_size(*picture.size)
            picture.verify()
        return _codes(path)


def meaning(path: Path) -> Meaning | None:
    """Return what the text chunk of `path` says."""
    with reading(path, "a 16-bit PNG", _ERRORS), PngImageFile(path) as picture:
        text = picture.info.get(_KEY)
    return None if text is None else parsed(str(text), path)


def coding(values: NDArray[np.float32], space: Space) -> Coding:
    """Return the coding that stores the finite `values` best."""
    finite = np.isfinite(values)
    low, high = (
        (
            float(values.min(where=finite, initial=np.inf)),
            float(values.max(where=finite, initial=-np.inf)),
        )
        if finite.any()
        else (0.0, 0.0)
    )
    if space is Space.METRIC and low >= 0 and high / MILLIMETRE < FARTHEST + 0.5:
        return Coding(MILLIMETRE, 0.0, INVALID, SKY)
    if space in (Space.METRIC, Space.SCALE) and low >= 0 and high > 0:
        return Coding(high / FARTHEST, 0.0, INVALID, SKY)
    step = (high - low) / (FARTHEST - NEAREST) or 1.0
    return Coding(step, low - NEAREST * step, INVALID, SKY)


def codes(values: NDArray[np.float32], chosen: Coding) -> NDArray[np.uint16]:
    """Return the 16-bit codes of `values`.

    Rounds in float64, for float32 would err by a hundredth of a step; some rows at a time, for
    that would take eight bytes a pixel.
    """
    stored = np.empty(values.shape, np.uint16)
    for top in range(0, len(values), _ROWS_AT_ONCE):
        rows = values[top : top + _ROWS_AT_ONCE]
        finite = np.isfinite(rows)
        steps = (np.where(finite, rows, 0).astype(np.float64) - chosen.offset) / chosen.scale
        code = np.rint(steps).clip(NEAREST, FARTHEST)
        code[~finite] = INVALID
        code[np.isinf(rows)] = SKY
        stored[top : top + _ROWS_AT_ONCE] = code
    return stored


def _codes(path: Path) -> NDArray[np.uint16]:
    with PngImageFile(path) as picture:
        if picture.mode not in ("I;16", "I"):
            raise ValueError(f"one channel of 16 bits is wanted, its mode is {picture.mode}")
        return np.asarray(picture).astype(np.uint16)
