"""Depth as a picture with a legend that says how far, and pictures side by side."""

from collections.abc import Iterable, Sequence
from math import ceil, floor, log10, sqrt
from typing import TypeAlias

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from flexdepth.runtime.colour import (
    SKY,
    UNKNOWN,
    Colour,
    Limits,
    Pixels,
    coloured,
    limits,
    merged,
    nearness,
    palette,
)
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError

__all__ = [
    "NARROWEST_LEGEND",
    "SKY",
    "UNKNOWN",
    "Limits",
    "limits",
    "merged",
    "panels",
    "preview",
    "round_numbers",
]

Font: TypeAlias = ImageFont.FreeTypeFont | ImageFont.ImageFont

NARROWEST_LEGEND = 64
"""Pictures narrower than so many pixels get no legend: no word would be legible."""

_PAPER: Colour = (255, 255, 255)
_INK: Colour = (40, 40, 40)


def preview(depth_map: DepthMap, shown: Limits | None = None) -> Pixels:
    """Return the map in colours, with a legend below it: RGB, uint8.

    The legend has round metres for metric depth, and "near" and "far" for all else. Its height
    follows from the picture's size alone, so the frames of a clip are of one size.

    Args:
        depth_map: The map.
        shown: The ends of the colours, beyond which they stay; by default the map's own.

    Raises:
        InputError: The limits do not suit the map (`colour.coloured`).
    """
    ends = limits(depth_map) if shown is None else shown
    picture = coloured(depth_map, ends)
    if picture.shape[1] < NARROWEST_LEGEND:
        return picture
    height, width = depth_map.values.shape
    return np.concatenate([picture, _legend(width, height, ends, depth_map.space)])


def panels(pictures: Sequence[Pixels], titles: Sequence[str]) -> Pixels:
    """Return pictures side by side, each under its title: RGB, uint8.

    All are enlarged to the width of the widest and begin at one height, so a photo and its
    preview stay comparable pixel by pixel. A title too long for its picture ends in an ellipsis.

    Args:
        pictures: Height x width x 3, uint8 RGB; at least one.
        titles: One for each picture.

    Raises:
        InputError: There is no picture, or not one title for each.
    """
    if not pictures or len(pictures) != len(titles):
        raise InputError(
            f"panels need one title for each picture, "
            f"got {len(pictures)} pictures and {len(titles)} titles"
        )
    width = max(picture.shape[1] for picture in pictures)
    scaled = [_of_width(picture, width) for picture in pictures]
    height = max(picture.height for picture in scaled)
    size = _font_size(width, height)
    font = ImageFont.load_default(size)
    head, across = 2 * size, width + size // 2
    sheet = Image.new("RGB", (across * len(scaled) - size // 2, head + height), _PAPER)
    draw = ImageDraw.Draw(sheet)
    for number, (picture, title) in enumerate(zip(scaled, titles, strict=True)):
        sheet.paste(picture, (number * across, head))
        middle = number * across + width / 2
        draw.text((middle, head / 2), _shortened(title, font, width), _INK, font, anchor="mm")
    return np.asarray(sheet)


def _font_size(width: int, height: int) -> int:
    """Return the size of letters that can be read beside a picture, at least 10 pixels."""
    return max(10, round(min(sqrt(width * height) / 34, width / 12)))


def _legend(width: int, height: int, ends: Limits, space: Space) -> Pixels:
    """Return the strip below a picture: a bar from near to far, its marks, and sky."""
    size = _font_size(width, height)
    strip = Image.new("RGB", (width, round(3.2 * size)), _PAPER)
    draw, font = ImageDraw.Draw(strip), ImageFont.load_default(size)
    top, bottom = round(0.7 * size), round(1.6 * size)
    baseline, margin = 2.8 * size, size // 2
    left, right = margin, width - margin - 1
    if ends.sky:
        across = max(round(draw.textlength("sky", font)), 2 * size)
        draw.rectangle((right - across, top, right, bottom), SKY)
        draw.text((right - across / 2, baseline), "sky", _INK, font, anchor="ms")
        right -= across + margin
    if not ends.empty:
        _bar(strip, (left, top, right, bottom))
        _marks(draw, font, (left, right, bottom), baseline, _labels(ends, space))
    return np.asarray(strip)


def _bar(strip: Image.Image, box: tuple[int, int, int, int]) -> None:
    """Draw the colours from near on the left to far on the right."""
    left, top, right, bottom = box
    row = np.linspace(255, 0, right - left + 1).round().astype(np.uint8)
    strip.paste(Image.fromarray(np.repeat(palette()[row][None], bottom - top + 1, 0)), (left, top))


def _labels(ends: Limits, space: Space) -> list[tuple[float, str]]:
    """Return the words below the bar, the most important first, and where: 0 near, 1 far."""
    if space is not Space.METRIC:
        return [(0.0, "near"), (1.0, "far")]
    values = round_numbers(ends.nearest, ends.farthest)
    where = 1 - nearness(np.array(values, np.float32), ends, space)
    return [(float(place), f"{value:g} m") for place, value in zip(where, values, strict=True)]


def round_numbers(low: float, high: float) -> list[float]:
    """Return round numbers from `low` to `high`, the most telling first.

    They are 1, 2 and 5 times powers of ten; where fewer than three of these lie in the range,
    multiples of the largest such step of which at least three do.
    """
    decades = range(floor(log10(low)), ceil(log10(high)) + 1)
    series = [float(f"{digit}e{power}") for digit in (1, 5, 2) for power in decades]
    inside = [value for value in series if low <= value <= high]
    if len(inside) >= 3:
        return inside
    power = ceil(log10(high - low))
    for exponent in range(power, power - 3, -1):
        for digit in (5, 2, 1):
            step = float(f"{digit}e{exponent}")
            first, last = low / step, high / step
            multiples = range(ceil(first), floor(last) + 1)
            if len(multiples) >= 3:
                return [float(f"{digit * multiple}e{exponent}") for multiple in multiples]
    return inside


def _marks(
    draw: ImageDraw.ImageDraw,
    font: Font,
    bar: tuple[int, int, int],
    baseline: float,
    labels: Iterable[tuple[float, str]],
) -> None:
    """Draw each mark that has room: its word overlaps no earlier word and stays below the bar."""
    left, right, bottom = bar
    gap = draw.textlength("n", font)
    taken: list[tuple[float, float]] = []
    for place, word in labels:
        centre = left + place * (right - left)
        half = draw.textlength(word, font) / 2
        middle = min(max(centre, left + half), right - half)
        span = (middle - half - gap / 2, middle + half + gap / 2)
        if any(span[0] < end and begin < span[1] for begin, end in taken):
            continue
        taken.append(span)
        draw.line((centre, bottom, centre, bottom + 0.5 * gap), _INK, max(1, round(gap / 5)))
        draw.text((middle, baseline), word, _INK, font, anchor="ms")


def _of_width(picture: Pixels, width: int) -> Image.Image:
    """Return the picture enlarged to a width, its shape kept."""
    image = Image.fromarray(picture)
    if image.width == width:
        return image
    height = max(1, round(image.height * width / image.width))
    return image.resize((width, height), Image.Resampling.BICUBIC)


def _shortened(title: str, font: Font, width: int) -> str:
    """Return the title, or as much of it as fits before an ellipsis."""
    if font.getlength(title) <= width:
        return title
    lengths = range(len(title) - 1, -1, -1)
    return next((f"{title[:n]}…" for n in lengths if font.getlength(f"{title[:n]}…") <= width), "")
