"""Where the still world has gone, once the camera's motion is known: a search along its lines.

What stands still has one unknown a pixel, its inverse depth, and is seen on one line of the other
frame. On a smaller picture every inverse depth is tried at every pixel, and neighbours agree along
eight directions; so much more is found again than by a search over both directions, and what shows
nothing is filled from around it.

References:
    Hirschmüller, Stereo processing by semiglobal matching and mutual information, PAMI 2008; with
    inverse depths instead of disparities, and the costs of Zabih and Woodfill, ECCV 1994.
"""

from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.compiled import compiled
from flexdepth.flow.field import Flow, FlowField, checked
from flexdepth.flow.frames import Image, gray_pair, shrunk
from flexdepth.flow.semi_global import Words, apart, between, census, misfit
from flexdepth.runtime.depthmap import Intrinsics

Array = NDArray[np.float64]

_PIXELS = 77_000
"""Of the small picture, about."""

_LABELS = 128
"""Inverse depths that are tried, evenly spaced from 0."""

_REACH = 0.25
"""The longest parallax that is tried, in widths of the picture, where the lines are longest."""

_STEP, _JUMP, _SMOOTH_JUMP = 4, 40, 400
"""What neighbours pay for inverse depths one step apart, and at most, in bits of the census: the
last over one more than their difference in gray comes on top, for borders show."""

_BEYOND = 16
"""Bits that a pixel pays whose place leaves the picture: a third of all."""

_AHEAD = 0.05
"""The least z in the other frame, in that of the key frame."""

_NOWHERE = 1e-12
"""The length of a line that is none: where the camera goes to, all depths look alike."""

_DIRECTIONS = ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
"""Down and right: where a line leads."""

_FLOOR, _UNDERSTATEMENT = 0.05, 2.0
"""The least noise, pixels; and by how much the round trip understates it, as `dis.py` found."""

_WORSE = 1.0
"""Bits of the census by which other flow must look more alike to be believed before this."""

_BETTER = 3.0
"""Bits by which this must look more alike than other flow that is on the line as well, but
elsewhere: bricks look like the next bricks."""

_ON_LINE, _ELSEWHERE = 1.0, 2.0
"""Pixels: the farthest from its line, and the least from what is found, of such other flow."""


@dataclass(frozen=True, eq=False)
class AlongLines:
    """Two frames of one camera, in which the still world is looked for.

    Attributes:
        key: Height x width, or height x width x 3 in RGB; 0 to 255.
        target: Another view, of the same size.
        camera: Of both.
    """

    key: Image
    target: Image
    camera: Intrinsics

    def __call__(self, rotation: Array, translation: Array, flow: Flow) -> FlowField:
        """Return the flow of what may stand still.

        It is valid where the search from the target leads home, and where what it finds looks as
        much alike as what the given flow does, or that is not known. Given flow that leads to
        another place on the line is left only for what looks clearly more alike.

        Args:
            rotation: 3 x 3, of the camera's `target_from_key`.
            translation: Its 3 numbers; their length has no effect. Not 0.
            flow: What was found without knowing how the camera moved, pixels; NaN is unknown.
        """
        frames = gray_pair(self.key, self.target)
        there, back = (rotation, translation), (rotation.T, -rotation.T @ translation)
        lines, lines_back = (_lines(frames[0].shape, self.camera, each) for each in (there, back))
        found = checked(
            _refined(frames, lines, _nearness(frames, self.camera, there)),
            _refined(frames[::-1], lines_back, _nearness(frames[::-1], self.camera, back)),
            _UNDERSTATEMENT,
            _FLOOR,
        )
        words = census(frames[0]), census(frames[1])
        known = np.asarray(np.isfinite(flow).all(axis=-1))
        other = misfit(*words, np.where(known[..., None], flow, np.float32(0)))
        rival = _on_line(lines, flow) & (np.linalg.norm(found.flow - flow, axis=-1) > _ELSEWHERE)
        enough = other + np.where(rival, -_BETTER, _WORSE)
        alike = ~known | (misfit(*words, found.flow) <= enough)
        valid = found.valid & alike
        return FlowField(found.flow, valid, np.where(valid, found.noise, np.float32(np.nan)))


class _Lines(NamedTuple):
    """Where the pixels of a picture may have gone: infinity + ρ way / (ahead + ρ nearing).

    Attributes:
        infinity: Height x width x 2, pixels from the top left corner.
        way: Likewise.
        ahead: Height x width: z, in the other frame, of a point at infinity.
        nearing: By how much the camera goes back.
    """

    infinity: Array
    way: Array
    ahead: Array
    nearing: float


def _lines(shape: tuple[int, int], camera: Intrinsics, motion: tuple[Array, Array]) -> _Lines:
    """Return the lines of the pixels of a picture of the camera's."""
    height, width = shape
    rotation, translation = motion
    focal = np.array([camera.focal_x, camera.focal_y])
    centre = np.array([camera.centre_x, camera.centre_y])
    row, column = np.mgrid[:height, :width] + 0.5
    rays = np.ones((height, width, 3))
    rays[..., :2] = (np.stack([column, row], -1) - centre) / focal
    turned = rays @ rotation.T
    ahead = np.maximum(turned[..., 2], _AHEAD)
    place = turned[..., :2] / ahead[..., None]
    way = (translation[:2] - place * translation[2]) * focal
    return _Lines(place * focal + centre, way, ahead, float(translation[2]))


def _turned(lines: _Lines) -> Array:
    """Return the flow of what is infinitely far: the turn of the camera alone."""
    height, width = lines.ahead.shape
    row, column = np.mgrid[:height, :width] + 0.5
    return np.asarray(lines.infinity - np.stack([column, row], -1))


def _on_line(lines: _Lines, flow: Flow) -> NDArray[np.bool_]:
    """Return where flow leads to its pixel's line, on either side of infinity; not where NaN."""
    right, down = np.moveaxis(flow - _turned(lines), -1, 0)
    length = np.maximum(np.linalg.norm(lines.way, axis=-1), _NOWHERE)
    off = np.abs(right * lines.way[..., 1] - down * lines.way[..., 0]) / length
    return np.asarray(off < _ON_LINE)


def _nearness(
    frames: tuple[Image, Image], camera: Intrinsics, motion: tuple[Array, Array]
) -> NDArray[np.float32]:
    """Return the inverse depth of the first frame, were all still, as its small copy tells it."""
    height, width = frames[0].shape
    small = shrunk(frames, _PIXELS)
    rows, columns = small[0].shape
    lines = _lines((rows, columns), camera.scaled(columns / width, rows / height), motion)
    longest = float(np.quantile(np.linalg.norm(lines.way, axis=-1), 0.9))
    reach = _REACH * columns
    most = reach / max(longest - reach * lines.nearing, longest / 2)
    tried = np.linspace(0.0, most, _LABELS)
    costs = _costs(census(small[0]), census(small[1]), lines, tried)
    total = np.zeros(costs.shape, np.uint16)
    for direction in _DIRECTIONS:
        _add_along(costs, total, small[0], *direction)
    nearness = cv2.resize(_cheapest(total), (width, height)) * np.float32(tried[1])
    return np.asarray(nearness, np.float32)


def _refined(frames: tuple[Image, Image], lines: _Lines, nearness: NDArray[np.float32]) -> Flow:
    """Return the flow on the lines that is nearest to where the frames look most alike."""
    along = nearness / np.maximum(lines.ahead + nearness * lines.nearing, _AHEAD)
    turned = _turned(lines)
    moved = turned + along[..., None] * lines.way
    across, down = (np.ascontiguousarray(moved[..., k], np.float32) for k in range(2))
    cv2.VariationalRefinement.create().calcUV(*frames, across, down)
    unit = lines.way / np.maximum(np.linalg.norm(lines.way, axis=-1, keepdims=True), _NOWHERE)
    parallax = ((np.stack([across, down], -1) - turned) * unit).sum(-1, keepdims=True)
    return np.asarray(turned + np.maximum(parallax, 0.0) * unit, np.float32)


@compiled
def _costs(key: Words, target: Words, lines: _Lines, tried: Array) -> NDArray[np.uint8]:
    """Return how each pixel differs from its place at each inverse depth."""
    infinity, way, ahead, nearing = lines
    height, width = key.shape
    costs = np.full((height, width, len(tried)), _BEYOND, np.uint8)
    for row in range(height):
        for column in range(width):
            for k in range(len(tried)):
                z = ahead[row, column] + tried[k] * nearing
                if z <= _AHEAD:
                    continue
                along = tried[k] / z
                x = np.int64(np.floor(infinity[row, column, 0] + along * way[row, column, 0]))
                y = np.int64(np.floor(infinity[row, column, 1] + along * way[row, column, 1]))
                if 0 <= x < width and 0 <= y < height:
                    costs[row, column, k] = apart(key[row, column], target[y, x])
    return costs


@compiled
def _add_along(
    costs: NDArray[np.uint8], total: NDArray[np.uint16], gray: Image, down: int, right: int
) -> None:
    """Add to the total what the best way along one direction costs that ends in each depth."""
    height, width, labels = costs.shape
    before = np.zeros((width, labels), np.int16)
    here = np.zeros((width, labels), np.int16)
    for n in range(height):
        row = n if down >= 0 else height - 1 - n
        for m in range(width):
            column = m if right >= 0 else width - 1 - m
            y, x = row - down, column - right
            here[column] = 0
            if 0 <= y < height and 0 <= x < width:
                contrast = abs(np.float32(gray[row, column]) - np.float32(gray[y, x]))
                jump = np.int16(_JUMP + _SMOOTH_JUMP / (1 + contrast))
                _spread(here[x] if down == 0 else before[x], here[column], jump)
            for k in range(labels):
                here[column, k] += costs[row, column, k]
                total[row, column, k] += here[column, k]
        if down != 0:
            before, here = here, before


@compiled
def _spread(last: NDArray[np.int16], out: NDArray[np.int16], jump: np.int16) -> None:
    """Write the least of what a neighbour's depths cost and what the change from them does."""
    least, end = last.min(), len(last) - 1
    for k in range(len(last)):
        out[k] = min(np.int16(last[k] - least), jump)
        if k > 0:
            out[k] = min(out[k], np.int16(last[k - 1] - least + _STEP))
        if k < end:
            out[k] = min(out[k], np.int16(last[k + 1] - least + _STEP))


@compiled
def _cheapest(total: NDArray[np.uint16]) -> NDArray[np.float32]:
    """Return the number of the depth that costs least, by a parabola to a part of a step."""
    height, width, _ = total.shape
    found = np.zeros((height, width), np.float32)
    for row in range(height):
        for column in range(width):
            here = total[row, column]
            at = here.argmin()
            found[row, column] = at + between(here, at)
    return found
