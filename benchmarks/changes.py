"""Ways of showing the same scene again, for `stability.py`."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import BytesIO
from types import MappingProxyType

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flexdepth.runtime.sizes import resized

FARTHEST = 8
"""Pixels by which a picture is shifted at most: so many are cut off it at first."""

Pixels = NDArray[np.uint8]
Reals = NDArray[np.float32]


@dataclass(frozen=True)
class Change:
    """A way of showing a scene again.

    Attributes:
        shown: From a picture, with `FARTHEST` pixels more to the right and below than was shown
            first, to what is shown.
        back: From depth, and the size it was at first, to depth where it was; NaN: not shown.
    """

    shown: Callable[[Pixels], Pixels]
    back: Callable[[Reals, tuple[int, int]], Reals]


def at_first(picture: Pixels, start: int = 0) -> Pixels:
    """Return the part of a picture that begins so many pixels from its corner."""
    height, width = (length - FARTHEST for length in picture.shape[:2])
    return picture[start : start + height, start : start + width]


def shifted(by: int) -> Change:
    """Begin so many pixels farther right and down."""

    def back(depth: Reals, size: tuple[int, int]) -> Reals:
        there = np.full(size, np.nan, np.float32)
        there[by:, by:] = depth[: size[0] - by, : size[1] - by]
        return there

    return Change(lambda picture: at_first(picture, by), back)


def smaller(times: float) -> Change:
    """Show fewer pixels of the same; depth is read at the nearest of them."""

    def shown(picture: Pixels) -> Pixels:
        height, width = at_first(picture).shape[:2]
        size = round(times * width), round(times * height)
        return resized(np.ascontiguousarray(at_first(picture)), size)

    def back(depth: Reals, size: tuple[int, int]) -> Reals:
        nearest = cv2.INTER_NEAREST_EXACT
        return np.asarray(cv2.resize(depth, size[::-1], interpolation=nearest), np.float32)

    return Change(shown, back)


def brighter(picture: Pixels) -> Pixels:
    """Return a picture with all values 10 % larger, up to white."""
    return (picture * 1.1).round().clip(0, 255).astype(np.uint8)


def noisy(picture: Pixels) -> Pixels:
    """Return a picture with noise of a standard deviation of two steps, the same each time."""
    noise = np.random.default_rng(0).normal(0, 2, picture.shape)
    return (picture + noise).round().clip(0, 255).astype(np.uint8)


def compressed(picture: Pixels) -> Pixels:
    """Return a picture as it comes out of a JPEG file of quality 75."""
    file = BytesIO()
    Image.fromarray(picture).save(file, "JPEG", quality=75)
    return np.asarray(Image.open(file))


def recoloured(change: Callable[[Pixels], Pixels]) -> Change:
    """Change colours alone: depth is where it was."""
    return Change(lambda picture: change(at_first(picture)), lambda depth, _: depth)


CHANGES: Mapping[str, Change] = MappingProxyType(
    {
        **{f"shift {by}": shifted(by) for by in (1, FARTHEST)},
        "mirror": Change(
            lambda picture: at_first(picture)[:, ::-1], lambda depth, _: depth[:, ::-1]
        ),
        "x .9": smaller(0.9),
        "brighter": recoloured(brighter),
        "noise": recoloured(noisy),
        "JPEG": recoloured(compressed),
    }
)
