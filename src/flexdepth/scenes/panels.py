"""Maps as labelled panels: a title, the picture, and below it a legend that says the numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from flexdepth.runtime.colour import UNKNOWN, Colour, palette

Pixels = NDArray[np.uint8]
Floats = NDArray[np.floating]

WIDTH = 440
"""Pixels of a panel, however large the frames are."""

_PAPER: Colour = (255, 255, 255)
_INK: Colour = (40, 40, 40)
_GAP, _LETTERS = 14, 13
_TITLE, _LEGEND = 24, 38

_COLD, _MIDDLE, _HOT = (33, 102, 172), (247, 247, 247), (178, 24, 43)
"""Below, at and above the middle of a signed map."""


@dataclass(frozen=True)
class Bar:
    """A legend of numbers: colours from left to right, and what some of them mean.

    Attributes:
        colours: Some by 3, RGB, from left to right.
        marks: Words at the left end, in the middle and at the right end.
    """

    colours: Pixels
    marks: tuple[str, str, str]


@dataclass(frozen=True)
class Key:
    """A legend of kinds: what each colour means."""

    colours: Mapping[str, Colour]


@dataclass(frozen=True, eq=False)
class Panel:
    """One labelled picture.

    Attributes:
        title: Above it.
        picture: RGB; None where the solution has none.
        legend: Below it.
    """

    title: str
    picture: Pixels | None
    legend: Bar | Key | None = None


def magnitude(title: str, values: Floats, unit: str = "", most: float | None = None) -> Panel:
    """Return a map of numbers from 0 up, dark to bright; gray is unknown.

    Args:
        title: Above it.
        values: Height x width; NaN and infinite are unknown.
        unit: Follows the numbers.
        most: The brightest; None takes all but the largest 2 %.
    """
    known = np.isfinite(values)
    top = most if most is not None else _quantile(values[known], 98)
    share = np.clip(np.where(known, values, 0) / (top or 1.0), 0, 1)
    picture = palette()[np.rint(255 * share).astype(np.uint8)]
    picture[~known] = UNKNOWN
    return Panel(title, picture, Bar(palette(), _marks(0.0, top, unit)))


def signed(title: str, values: Floats, middle: float, least: float, unit: str = "") -> Panel:
    """Return a map of numbers around a middle that is white: blue below it, red above.

    Both ends are as far from the middle as all but 1 % of the numbers.

    Args:
        title: Above it.
        values: Height x width; NaN is unknown, and gray.
        middle: Such as the camera's own.
        least: The ends are at least so far from the middle.
        unit: Follows the numbers.
    """
    known = np.isfinite(values)
    reach = max(_quantile(np.abs(values[known] - middle), 99), least)
    share = np.clip((np.where(known, values, middle) - middle) / reach, -1, 1)
    picture = _diverging()[np.rint(127.5 * (share + 1)).astype(np.uint8)]
    picture[~known] = UNKNOWN
    return Panel(title, picture, Bar(_diverging(), _marks(middle - reach, middle + reach, unit)))


def kinds(title: str, numbers: NDArray[np.integer], words: Sequence[tuple[str, Colour]]) -> Panel:
    """Return a map of kinds, with those that occur in its legend, and their shares.

    Args:
        title: Above it.
        numbers: Height x width; which of the words.
        words: Word and colour of each kind.
    """
    table = np.array([colour for _, colour in words], np.uint8)
    shares = np.bincount(numbers.ravel(), minlength=len(words)) / numbers.size
    legend = {
        f"{word} {_percent(share)}": colour
        for (word, colour), share in zip(words, shares, strict=True)
        if share
    }
    return Panel(title, table[numbers], Key(legend))


def sheet(heading: Sequence[str], panels: Sequence[Panel], columns: int) -> Pixels:
    """Return panels in rows below some lines of text: RGB.

    Args:
        heading: Lines at the top.
        panels: In the order in which they are read.
        columns: Panels of a row.
    """
    shape = next(panel.picture.shape for panel in panels if panel.picture is not None)
    tall = max(1, round(WIDTH * shape[0] / shape[1]))
    across, down = WIDTH + _GAP, _TITLE + tall + _LEGEND + _GAP
    rows = -(-len(panels) // columns)
    top = _GAP + round(1.6 * _LETTERS) * len(heading) + _GAP // 2
    whole = Image.new("RGB", (columns * across + _GAP, top + rows * down), _PAPER)
    draw, font = ImageDraw.Draw(whole), ImageFont.load_default(_LETTERS)
    for line, text in enumerate(heading):
        size = _LETTERS + 3 if line == 0 else _LETTERS
        draw.text(
            (_GAP, _GAP + round(1.6 * _LETTERS) * line), text, _INK, ImageFont.load_default(size)
        )
    for number, panel in enumerate(panels):
        left, upper = _GAP + number % columns * across, top + number // columns * down
        draw.text((left, upper + _TITLE - 6), panel.title, _INK, font, anchor="ls")
        box = (left, upper + _TITLE, left + WIDTH, upper + _TITLE + tall)
        if panel.picture is None:
            draw.rectangle((*box[:2], box[2] - 1, box[3] - 1), (240, 240, 240))
            middle = ((box[0] + box[2]) / 2, (box[1] + box[3]) / 2)
            draw.text(middle, "not part of this solution", (130, 130, 130), font, anchor="mm")
        else:
            whole.paste(_fitted(panel.picture, (WIDTH, tall)), box[:2])
        if panel.legend is not None:
            _draw_legend(draw, whole, panel.legend, (left, box[3] + 6))
    return np.asarray(whole)


def _draw_legend(
    draw: ImageDraw.ImageDraw, whole: Image.Image, legend: Bar | Key, at: tuple[int, int]
) -> None:
    left, top = at
    font = ImageFont.load_default(_LETTERS - 2)
    if isinstance(legend, Bar):
        strip = Image.fromarray(legend.colours[None]).resize((WIDTH, 9), Image.Resampling.BILINEAR)
        whole.paste(strip, (left, top))
        places = ((left, "ls"), (left + WIDTH / 2, "ms"), (left + WIDTH, "rs"))
        for (x, anchor), word in zip(places, legend.marks, strict=True):
            draw.text((x, top + 23), word, _INK, font, anchor=anchor)
        return
    x, y = left, top
    for word, colour in legend.colours.items():
        length = 14 + round(draw.textlength(word, font)) + 10
        if x > left and x + length > left + WIDTH:
            x, y = left, y + 15
        draw.rectangle((x, y, x + 9, y + 9), colour, (120, 120, 120))
        draw.text((x + 14, y + 9), word, _INK, font, anchor="ls")
        x += length


def _fitted(picture: Pixels, size: tuple[int, int]) -> Image.Image:
    """Return a picture at another size: means where it shrinks, whole pixels where it grows."""
    shrinks = size[0] <= picture.shape[1]
    how = cv2.INTER_AREA if shrinks else cv2.INTER_NEAREST
    return Image.fromarray(np.asarray(cv2.resize(picture, size, interpolation=how)))


def _diverging() -> Pixels:
    share = np.linspace(-1, 1, 256)[:, None]
    ends = np.where(share < 0, np.array(_COLD), np.array(_HOT))
    colours = np.array(_MIDDLE) + np.abs(share) * (ends - np.array(_MIDDLE))
    return np.asarray(np.rint(colours), np.uint8)


def _quantile(values: Floats, percent: float) -> float:
    return float(np.percentile(values, percent)) if values.size else 0.0


def _marks(low: float, high: float, unit: str) -> tuple[str, str, str]:
    def word(value: float) -> str:
        return f"{_round(value, high - low)}{unit}" if isfinite(value) else ""

    return word(low), word((low + high) / 2), word(high)


def number(value: float) -> str:
    """Return a number with three digits that tell, and no power of ten."""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def _round(value: float, span: float) -> str:
    """Return a number with as many decimals as tell it from others in the span."""
    decimals = int(np.clip(np.ceil(2 - np.log10(max(span, 1e-9))), 0, 5))
    return f"{round(value, decimals) + 0.0:.{decimals}f}"  # + 0.0: no minus before a zero


def _percent(share: float) -> str:
    return f"{share:.0%}" if share >= 0.095 else f"{share:.1%}" if share >= 0.0005 else "<.1%"
