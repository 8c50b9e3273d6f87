"""Where things have gone, roughly and however far: semi-global matching over both directions.

Searches that follow slopes lose what is small and goes far, and what noise covers. Here, on a small
picture, every shift within reach is tried at every pixel, and neighbours agree along four lines.

References:
    Hirschmüller, Stereo processing by semiglobal matching and mutual information, PAMI 2008; with
    shifts across and down instead of disparities, and the costs of Zabih and Woodfill, ECCV 1994.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.compiled import compiled
from flexdepth.flow.field import Flow
from flexdepth.flow.frames import Image, shrunk

Words = NDArray[np.uint64]

_PIXELS = 16_000
"""Of the small picture, about."""

_ACROSS, _DOWN = 24, 16
"""The largest shift that is tried, pixels of the small picture."""

_STEP, _JUMP, _SMOOTH_JUMP = 8, 60, 600
"""What neighbours pay for a shift that differs by a pixel, and at most, in bits of the census:
the last over one more than their difference in gray comes on top, for borders show."""

_BEYOND = 16
"""Bits that a pixel pays whose shift leaves the picture: a third of all."""

_LINES = ((0, 1), (0, -1), (1, 0), (-1, 0))
"""Down and right: where a line leads."""


def rough_flow(key: Image, target: Image) -> Flow:
    """Return the flow to a few pixels, found without a beginning.

    It reaches about a quarter of the frame's width, and fills what shows nothing from around it.

    Args:
        key: Gray.
        target: Gray, of the same size.
    """
    height, width = key.shape
    small = shrunk((key, target), _PIXELS)
    rows, columns = small[0].shape
    costs = _costs(census(small[0]), census(small[1]), _ACROSS, _DOWN)
    total = np.zeros(costs.shape, np.uint16)
    for line in _LINES:
        _add_along(costs, total, small[0], *line)
    shifts = np.asarray(cv2.resize(_cheapest(total), (width, height)), np.float32)
    return shifts * np.array([width / columns, height / rows], np.float32)


@compiled
def census(gray: Image) -> Words:
    """Return of each pixel, bit by bit, which of its 48 neighbours are darker than itself."""
    height, width = gray.shape
    words = np.zeros((height, width), np.uint64)
    for row in range(height):
        for column in range(width):
            word = np.uint64(0)
            for down in range(-3, 4):
                for right in range(-3, 4):
                    if down == 0 and right == 0:
                        continue
                    y = min(max(row + down, 0), height - 1)
                    x = min(max(column + right, 0), width - 1)
                    darker = gray[y, x] < gray[row, column]
                    word = (word << np.uint64(1)) | np.uint64(darker)
            words[row, column] = word
    return words


@compiled
def apart(one: np.uint64, other: np.uint64) -> np.uint64:
    """Return in how many bits two words differ."""
    bits = one ^ other
    bits -= (bits >> np.uint64(1)) & np.uint64(0x5555555555555555)
    pairs = np.uint64(0x3333333333333333)
    bits = (bits & pairs) + ((bits >> np.uint64(2)) & pairs)
    bits = (bits + (bits >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
    return (bits * np.uint64(0x0101010101010101)) >> np.uint64(56)


@compiled
def _costs(key: Words, target: Words, across: int, down: int) -> NDArray[np.uint8]:
    """Return how each pixel differs from each place within reach."""
    height, width = key.shape
    costs = np.full((height, width, 2 * down + 1, 2 * across + 1), _BEYOND, np.uint8)
    for row in range(height):
        for column in range(width):
            for j in range(2 * down + 1):
                y = row + j - down
                if not 0 <= y < height:
                    continue
                for i in range(2 * across + 1):
                    x = column + i - across
                    if 0 <= x < width:
                        costs[row, column, j, i] = apart(key[row, column], target[y, x])
    return costs


@compiled
def _add_along(
    costs: NDArray[np.uint8], total: NDArray[np.uint16], gray: Image, down: int, right: int
) -> None:
    """Add to the total what the best way along one line costs that ends in each shift."""
    height, width, tall, wide = costs.shape
    before = np.zeros((width, tall, wide), np.int16)
    here = np.zeros((width, tall, wide), np.int16)
    for k in range(height):
        row = k if down >= 0 else height - 1 - k
        for n in range(width):
            column = n if right >= 0 else width - 1 - n
            y, x = row - down, column - right
            here[column] = 0
            if 0 <= y < height and 0 <= x < width:
                contrast = abs(np.float32(gray[row, column]) - np.float32(gray[y, x]))
                jump = np.int16(_JUMP + _SMOOTH_JUMP / (1 + contrast))
                _spread(here[x] if down == 0 else before[x], here[column], jump)
            for j in range(tall):
                for i in range(wide):
                    here[column, j, i] += costs[row, column, j, i]
                    total[row, column, j, i] += here[column, j, i]
        if down != 0:
            before, here = here, before


@compiled
def _spread(last: NDArray[np.int16], out: NDArray[np.int16], jump: np.int16) -> None:
    """Write the least of what a neighbour's shifts cost and what the change from them does."""
    tall, wide = last.shape
    least = last.min()
    for j in range(tall):
        for i in range(wide):
            out[j, i] = min(np.int16(last[j, i] - least), jump)
    _ease(out)
    _ease(out.T)


@compiled
def _ease(costs: NDArray[np.int16]) -> None:
    """Let no shift cost more than one beside it, along the first axis, and the step from there."""
    rows, columns = costs.shape
    step = np.int16(_STEP)
    for j in range(1, rows):
        for i in range(columns):
            costs[j, i] = min(costs[j, i], np.int16(costs[j - 1, i] + step))
    for j in range(rows - 2, -1, -1):
        for i in range(columns):
            costs[j, i] = min(costs[j, i], np.int16(costs[j + 1, i] + step))


@compiled
def _cheapest(total: NDArray[np.uint16]) -> Flow:
    """Return the shift that costs least at each pixel, by a parabola to a part of a pixel."""
    height, width, tall, wide = total.shape
    shifts = np.zeros((height, width, 2), np.float32)
    for row in range(height):
        for column in range(width):
            here = total[row, column]
            at = here.argmin()
            j, i = at // wide, at % wide
            shifts[row, column, 0] = i - (wide - 1) // 2 + between(here[j, :], i)
            shifts[row, column, 1] = j - (tall - 1) // 2 + between(here[:, i], j)
    return shifts


@compiled
def between(costs: NDArray[np.uint16], at: int) -> float:
    """Return where between the neighbours of a least cost it would be, from -.5 to .5."""
    if at == 0 or at == len(costs) - 1:
        return 0.0
    before = np.float64(costs[at - 1]) - costs[at]
    after = np.float64(costs[at + 1]) - costs[at]
    return float(0.5 * (before - after) / max(before, after, 1.0))


def misfit(key: Words, target: Words, flow: Flow) -> NDArray[np.float32]:
    """Return in how many bits of the census the frames differ where the flow leads.

    It is the mean over 15 x 15 pixels; where the flow leaves the picture half of the bits.

    Args:
        key: Its census.
        target: Likewise.
        flow: Pixels, finite.
    """
    return np.asarray(cv2.blur(_differences(key, target, flow), (15, 15)))


@compiled
def _differences(key: Words, target: Words, flow: Flow) -> NDArray[np.float32]:
    height, width = key.shape
    found = np.full((height, width), 24, np.float32)
    for row in range(height):
        for column in range(width):
            y, x = round(row + flow[row, column, 1]), round(column + flow[row, column, 0])
            if 0 <= y < height and 0 <= x < width:
                found[row, column] = apart(key[row, column], target[y, x])
    return found
