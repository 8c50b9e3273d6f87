"""Closer looks at a picture: once more and larger, or in overlapping tiles, joined without seams.

A network that looks at a whole photo sees it small and misses what is fine; shown the photo larger
than it learnt from, or a tile of it, it sees what is fine but not how far away all of it is. So the
large shape is taken from the first look at the whole and the detail from the closer one: with log
depth w in the whole and t in the tile, or in the larger whole,

    q = w + λ (t - w - mean(t - w)),   λ = (var t + ε) / (var t + κ var w + ε),

means and variances being those of a pixel's neighbourhood. A tile that is wrong by a factor, or by
a slow drift, is put right; one that agrees with the whole changes nothing; λ keeps the whole where
the tile is blind to a relief that the whole shows, as a tile inside one object may be. What
neighbouring tiles then still disagree on is fine detail, and is faded from the one to the other by
weights that rise and fall smoothly. The probability of sky is joined in the same way.

A tile is seen through a longer lens than the whole; that too is a factor, and goes the same way.
Tiles are asked for and never taken by themselves: each costs as much as the whole, and a photo
and its smaller copy would not have the same shape.

References:
    Miangoleh et al., CVPR 2021: tiles merged into the whole, there by a network.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from math import ceil

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.sizes import resized

_OVERLAP = 1 / 3
"""How much of a tile its neighbour sees too."""

_REACH = 4
"""How far each of the two means that follow one another, and so fade out, reaches to each side.

In pixels of the map of the whole, which is trusted for what is larger. With measured depth as the
tiles, bent and shifted, and its blurred copy as the whole, 3 to 4 came nearest to the measured.
"""

_REACH_OF_DETAILS = 12
"""The same for the whole shown larger, whose large shape is nearer to the true one.

8 and 12, photos of 640x480 shown at their own size, with the weights of 0.4.0: boundary F1 on
every 12th frame of ICL-NUIM .079, .082 (.017 without), AbsRel there .0828, .0816, on every 20th of
7-Scenes .1398, .1403.
"""

_BLIND = 0.25
"""κ: how readily a tile is held for blind; 1 would halve the detail of a seeing one."""

_FLAT = 1e-3
"""ε: a variance of log depth that counts as none."""

_SKY_COUNTS = 1e-3
"""How much a pixel of sky, whose depth means nothing, counts in the fit of depth."""


@dataclass(frozen=True, eq=False)
class Seen:
    """What a network sees in a picture or a part of it.

    Attributes:
        log_depth: The logarithm of canonical depth.
        sky: The probability of sky, of the same shape.
    """

    log_depth: NDArray[np.float32]
    sky: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Strip:
    """The pixels of a tile along one side of the picture, and how much each of them counts."""

    start: int
    weights: NDArray[np.float32]

    @property
    def pixels(self) -> slice:
        """Where the strip lies in the picture."""
        return slice(self.start, self.start + len(self.weights))


def strips(length: int, count: int) -> tuple[Strip, ...]:
    """Return `count` overlapping strips of equal length that cover a side.

    At each pixel the weights sum to one. They rise and fall as sin² across the overlap, and stay
    up at the ends of the side.

    Args:
        length: Of the side, in pixels.
        count: At least 1.
    """
    each = _each(length, count)
    starts = [round(k * (length - each) / max(count - 1, 1)) for k in range(count)]
    ramp = np.clip((np.arange(each) + 0.5) / (_OVERLAP * each), 0, 1)
    rise = np.sin(np.pi / 2 * ramp) ** 2
    level = np.ones(each)
    total = np.zeros(length)
    found = []
    for start in starts:
        left = level if start == 0 else rise
        right = level if start + each == length else rise[::-1]
        total[start : start + each] += left * right
        found.append((start, left * right))
    return tuple(
        Strip(start, (weights / total[start : start + each]).astype(np.float32))
        for start, weights in found
    )


def tiling(width: int, height: int, most: int, seen: int) -> tuple[int, int]:
    """Return columns and rows of a picture's tiles, (1, 1) for the whole alone.

    There are `most` along the longer side, and along the shorter as many as make the tiles
    nearly square and not longer that way: 4 x 3 for a photo, 4 x 1 for a panorama. There are
    fewer where a tile would have fewer pixels than its map, for it could then show nothing new.

    Args:
        width: Of the picture, in pixels.
        height: In pixels.
        most: Tiles along the longer side.
        seen: How many pixels the map of a tile has.
    """
    longer, shorter = max(width, height), min(width, height)
    for count in range(most, 1, -1):
        beside = ceil(count * shorter / longer)
        if _each(longer, count) * _each(shorter, beside) >= seen:
            return (count, beside) if width >= height else (beside, count)
    return 1, 1


def joined(
    pixels: NDArray[np.uint8],
    whole: Seen,
    grid: tuple[int, int],
    look: Callable[[NDArray[np.uint8]], Seen],
) -> Seen:
    """Return what is seen in the whole and in its tiles, at the picture's own size.

    Beside the picture and the result, no more than a tile is held in memory.

    Args:
        pixels: The picture, in RGB.
        whole: What is seen in it, at any size.
        grid: Columns and rows of the tiles; (1, 1) leaves the whole as it is.
        look: What is seen in a part of the picture, at any size.
    """
    height, width = pixels.shape[:2]
    if grid == (1, 1):
        return Seen(*(resized(each, (width, height)) for each in (whole.log_depth, whole.sky)))
    log_depth, sky = np.zeros((2, height, width), np.float32)
    for down, across in product(strips(height, grid[1]), strips(width, grid[0])):
        place = (down.pixels, across.pixels)
        near = look(np.ascontiguousarray(pixels[place]))
        far, reach = _part(whole, pixels.shape[:2], (down, across), near.sky.shape)
        fitted = _fitted(near, far, reach)
        weights = down.weights[:, None] * across.weights
        log_depth[place] += weights * resized(fitted.log_depth, weights.shape[::-1])
        sky[place] += weights * resized(fitted.sky, weights.shape[::-1])
    return Seen(log_depth, sky)


def closer(whole: Seen, larger: Seen) -> Seen:
    """Return the detail of a picture that is shown larger on the shape that the whole has.

    Args:
        whole: What is seen in the picture.
        larger: What is seen in the same picture at a larger size.
    """
    (coarse_height, coarse_width), (height, width) = whole.sky.shape, larger.sky.shape
    grown = Seen(*(resized(each, (width, height)) for each in (whole.log_depth, whole.sky)))
    up = ceil(_REACH_OF_DETAILS * height / coarse_height)
    across = ceil(_REACH_OF_DETAILS * width / coarse_width)
    return _fitted(larger, grown, (up, across))


def _each(length: int, count: int) -> int:
    """Return the length of each of `count` overlapping strips that cover a side."""
    return ceil(length / (1 + (count - 1) * (1 - _OVERLAP)))


def _part(
    whole: Seen, picture: tuple[int, int], tile: tuple[Strip, Strip], shape: tuple[int, int]
) -> tuple[Seen, tuple[int, int]]:
    """Return the whole in the tile, at the tile's `shape`, and how far `_REACH` is there.

    Everything is height before width; `picture` is in pixels.
    """
    coarse = whole.sky.shape
    sides = list(zip(tile, picture, coarse, shape, strict=True))
    rows, columns = (_between(*side) for side in sides)
    up, across = (
        ceil(_REACH * length * fine / (len(strip.weights) * coarse))
        for strip, length, coarse, fine in sides
    )
    log_depth, sky = np.stack([rows] * 2) @ [whole.log_depth, whole.sky] @ columns.T
    return Seen(log_depth, sky), (up, across)


def _between(strip: Strip, length: int, coarse: int, fine: int) -> NDArray[np.float32]:
    """Return the matrix that interpolates a map of the whole side at the pixels of a strip's map.

    Args:
        strip: Of the picture.
        length: Of the picture's side, in its pixels.
        coarse: Of the side in the map of the whole.
        fine: Of the strip in its own map.
    """
    places = strip.start + (np.arange(fine) + 0.5) * len(strip.weights) / fine
    nodes = np.clip(places * coarse / length - 0.5, 0, coarse - 1)
    return np.maximum(1 - abs(nodes[:, None] - np.arange(coarse)), 0).astype(np.float32)


def _fitted(near: Seen, far: Seen, reach: tuple[int, int]) -> Seen:
    """Return the detail of `near` on the large shape of `far`, of the same shape.

    `reach` is that of the means, up and down, left and right.
    """
    solid = np.maximum((1 - near.sky) * (1 - far.sky), np.float32(_SKY_COUNTS))
    log_depth = _detailed(near.log_depth, far.log_depth, solid, reach)
    sky = _detailed(near.sky, far.sky, np.ones_like(far.sky), reach)
    return Seen(log_depth, np.clip(sky, 0, 1))


def _detailed(
    near: NDArray[np.float32],
    far: NDArray[np.float32],
    counts: NDArray[np.float32],
    reach: tuple[int, int],
) -> NDArray[np.float32]:
    """Return q for t `near` and w `far`; see the top. `counts` weighs the pixels of the means."""
    box = (2 * reach[1] + 1, 2 * reach[0] + 1)

    def total(values: NDArray[np.float32]) -> NDArray[np.float32]:
        once = cv2.blur(values, box, borderType=cv2.BORDER_CONSTANT)
        return np.asarray(cv2.blur(once, box, borderType=cv2.BORDER_CONSTANT), np.float32)

    all_counts = total(counts)

    def mean(values: NDArray[np.float32]) -> NDArray[np.float32]:
        return total(counts * values) / all_counts

    def variance(values: NDArray[np.float32]) -> NDArray[np.float32]:
        centred = values - values.mean()
        return np.asarray(np.maximum(mean(centred**2) - mean(centred) ** 2, 0), np.float32)

    seen = variance(near) + np.float32(_FLAT)
    detail = near - far
    detail -= mean(detail)
    detail *= seen / (seen + np.float32(_BLIND) * variance(far))
    return far + detail
