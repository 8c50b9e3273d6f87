"""Two frames as a matcher wants them: gray, of one size, with something to match."""

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError

Image = NDArray[np.uint8]

SMALLEST = 32
"""Pixels of a side: a smaller frame has no room for the matchers' windows."""

_TEXTURE = 1.0
"""Shades of gray: a frame whose standard deviation is smaller shows nothing."""


def gray_pair(key: Image, target: Image) -> tuple[Image, Image]:
    """Return both frames in gray.

    Args:
        key: Height x width, or height x width x 3 in RGB; 0 to 255.
        target: Another view of it.

    Raises:
        InputError: The frames differ in size, are too small, or one shows nothing.
    """
    if key.shape[:2] != target.shape[:2]:
        sizes = " and ".join(f"{each.shape[1]}x{each.shape[0]}" for each in (key, target))
        raise InputError(
            f"two frames of one size are wanted, got {sizes}; "
            "resize one, and its focal length with it"
        )
    height, width = key.shape[:2]
    if min(height, width) < SMALLEST:
        raise InputError(
            f"frames of at least {SMALLEST}x{SMALLEST} pixels are wanted, got {width}x{height}"
        )
    return _gray(key, "key"), _gray(target, "target")


def shrunk(frames: tuple[Image, Image], pixels: int) -> tuple[Image, Image]:
    """Return both frames at about so many pixels, in their shape; larger than they are, never.

    Args:
        frames: Gray, of one size.
        pixels: About as many as the small ones have.
    """
    height, width = frames[0].shape
    times = max(1.0, float(np.sqrt(height * width / pixels)))
    size = round(width / times), round(height / times)
    key, target = (
        np.asarray(cv2.resize(each, size, interpolation=cv2.INTER_AREA), np.uint8)
        for each in frames
    )
    return key, target


def _gray(frame: Image, name: str) -> Image:
    gray = frame if frame.ndim == 2 else np.asarray(cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY))
    if gray.std() < _TEXTURE:
        raise InputError(
            f"the {name} frame has no texture: its gray deviates by {gray.std():.2g} of 255; "
            "nothing in it can be found again, take a frame that shows something"
        )
    return np.ascontiguousarray(gray, dtype=np.uint8)
