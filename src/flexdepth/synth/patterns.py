"""Tileable grey patterns; a material turns one into colour.

A pattern is a square of two weights in [0, 1] per texel: how far the second and the third colour
of the material replace the first.
"""

from collections.abc import Callable

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

SIZE = 256
"""Texels along a side."""

Array = NDArray[np.float64]
_ROW, _COLUMN = np.mgrid[:SIZE, :SIZE] / SIZE


def fractal(rng: Generator, exponent: float) -> Array:
    """Return periodic noise in [0, 1] whose amplitude falls with frequency to the `exponent`."""
    spectrum = np.fft.rfft2(rng.normal(size=(SIZE, SIZE)))
    frequency = np.hypot(np.fft.fftfreq(SIZE)[:, None], np.fft.rfftfreq(SIZE)[None])
    frequency[0, 0] = np.inf
    noise = np.fft.irfft2(spectrum * frequency**-exponent, s=(SIZE, SIZE))
    low, high = np.percentile(noise, (1, 99))
    return np.asarray(np.clip((noise - low) / (high - low), 0, 1))


def _pair(first: ArrayLike, second: ArrayLike = 0.0) -> Array:
    return np.stack(np.broadcast_arrays(np.asarray(first, float), np.asarray(second, float)), -1)


def plain(rng: Generator) -> Array:
    """One colour with the faint unevenness of paint."""
    return _pair(fractal(rng, 1.3) * rng.uniform(0, 0.25))


def mottled(rng: Generator) -> Array:
    """Clouds of colour: plaster, concrete, carpet, stone."""
    return _pair(fractal(rng, rng.uniform(0.5, 1.6)), 0.5 * fractal(rng, 0.4))


def speckled(rng: Generator) -> Array:
    """Grains: asphalt, gravel, terrazzo, lawn."""
    grain = fractal(rng, rng.uniform(0.0, 0.6))
    return _pair(grain, fractal(rng, 1.5) * rng.uniform(0.2, 0.8))


def spots(rng: Generator) -> Array:
    """Irregular islands of the second colour."""
    noise = fractal(rng, rng.uniform(1.2, 2.2))
    return _pair(noise > rng.uniform(0.35, 0.65), 0.5 * fractal(rng, 0.6))


def checks(rng: Generator) -> Array:
    """A chequerboard or a tartan."""
    count = 2 * rng.integers(1, 7)
    across, down = (np.floor(count * axis) % 2 for axis in (_COLUMN, _ROW))
    if rng.random() < 0.5:
        return _pair((across + down) % 2, 0.2 * fractal(rng, 0.8))
    return _pair((across + down) / 2, 0.2 * fractal(rng, 0.8))


def stripes(rng: Generator) -> Array:
    """Bands of uneven width in one direction."""
    axis = _COLUMN if rng.random() < 0.6 else _ROW
    edges = np.sort(rng.random(2 * rng.integers(1, 12)))
    band = np.searchsorted(edges, axis) % 2
    return _pair(band, 0.3 * fractal(rng, 0.7))


def bricks(rng: Generator) -> Array:
    """Courses of bricks or planks; the third colour is the joint."""
    rows = 2 * rng.integers(2, 8)
    columns = rng.integers(1, 5)
    row = np.floor(rows * _ROW)
    x = (columns * _COLUMN + 0.5 * (row % 2)) % columns
    shade = rng.random((rows, columns))[row.astype(int), np.floor(x).astype(int)]
    joint = (x % 1 < 0.04 * columns / 2) | ((rows * _ROW) % 1 < 0.1)
    return _pair(0.7 * shade + 0.3 * fractal(rng, 0.8), joint)


def tiles(rng: Generator) -> Array:
    """Square tiles with joints."""
    count = rng.integers(2, 9)
    x, y = count * _COLUMN, count * _ROW
    shade = rng.random((count, count))[np.floor(y).astype(int), np.floor(x).astype(int)]
    joint = (x % 1 < 0.05) | (y % 1 < 0.05)
    return _pair(rng.uniform(0, 0.8) * shade + 0.2 * fractal(rng, 1.0), joint)


def wood(rng: Generator) -> Array:
    """Grain along the rows, sometimes in boards."""
    wave = fractal(rng, 1.8) * rng.uniform(0.1, 0.5) + _ROW * rng.integers(1, 4)
    grain = 0.5 + 0.5 * np.sin(2 * np.pi * rng.integers(3, 10) * wave)
    fine = cv2.blur(fractal(rng, 0.2), (31, 1))
    boards = rng.integers(0, 7)
    joint = (boards * _ROW) % 1 < 0.03 if boards else np.zeros_like(_ROW)
    return _pair(0.6 * grain + 0.4 * fine, joint)


def collage(rng: Generator) -> Array:
    """Rectangles and discs: posters, book covers, screens, shop fronts."""
    canvas = np.zeros((SIZE, SIZE, 2))
    for _ in range(rng.integers(4, 30)):
        x, y = rng.integers(0, SIZE, 2)
        w, h = rng.integers(6, SIZE // 2, 2)
        weights = rng.dirichlet((0.5, 0.5, 0.5))[:2].tolist()
        if rng.random() < 0.7:
            cv2.rectangle(canvas, (int(x), int(y)), (int(x + w), int(y + h)), weights, -1)
        else:
            cv2.circle(canvas, (int(x), int(y)), int(w // 2), weights, -1)
    return np.asarray(cv2.GaussianBlur(canvas, (0, 0), rng.uniform(0.3, 2)), float)


def print_lines(rng: Generator) -> Array:
    """Lines of a text too small to read."""
    canvas = np.zeros((SIZE, SIZE))
    step = int(rng.integers(6, 18))
    for y in range(step, SIZE - step, step):
        x = int(rng.integers(8, 24))
        while x < SIZE - 24:
            word = int(rng.integers(4, 26))
            cv2.rectangle(canvas, (x, y), (x + word, y + step // 2), 1.0, -1)
            x += word + int(rng.integers(3, 8))
    return _pair(cv2.GaussianBlur(canvas, (0, 0), 0.8), 0.1)


def windows(rng: Generator) -> Array:
    """A facade's panes in frames: the second colour is glass, the third the frame."""
    columns, rows = rng.integers(1, 5, 2)
    x, y = (columns * _COLUMN) % 1, (rows * _ROW) % 1
    left, top = rng.uniform(0.12, 0.32, 2)
    inside = (x > left) & (x < 1 - left) & (y > top) & (y < 1 - 0.7 * top)
    inner = (x > left + 0.04) & (x < 0.96 - left) & (y > top + 0.04) & (y < 0.96 - 0.7 * top)
    bar = (np.abs(x - 0.5) < 0.02) | (np.abs(y - 0.5) < 0.02)
    glass = inner & ~bar
    return _pair(
        np.where(glass, 0.6 + 0.4 * fractal(rng, 1.8), 0.1 * fractal(rng, 1)), inside & ~glass
    )


def panels(rng: Generator) -> Array:
    """Cabinet doors and drawers with grooves and knobs."""
    columns, rows = rng.integers(1, 4, 2)
    x, y = (columns * _COLUMN) % 1, (rows * _ROW) % 1
    groove = (x < 0.03) | (y < 0.03)
    knob = np.hypot(x - rng.choice([0.12, 0.5, 0.88]), (y - rng.choice([0.15, 0.5])) * 1.5) < 0.05
    return _pair(np.where(groove, 1.0, 0.15 * fractal(rng, 1.2)), knob)


def weave(rng: Generator) -> Array:
    """Threads or fine uneven lines: carpet tiles, ribs, cloth from near."""
    lines = fractal(rng, 0.3)[0]
    threads = np.broadcast_to(lines[None], (SIZE, SIZE))
    if rng.random() < 0.4:
        threads = np.where(
            ((4 * _ROW).astype(int) + (4 * _COLUMN).astype(int)) % 2, threads, threads.T
        )
    fine = np.clip(threads * rng.uniform(0.6, 1.2) + 0.3 * fractal(rng, 0.2), 0, 1)
    return _pair(fine, 0.4 * (cv2.blur(fractal(rng, 0.1), (1, 9)) > 0.6))


def doors(rng: Generator) -> Array:
    """Smooth fronts with thin gaps and long handles."""
    columns, rows = int(rng.integers(1, 4)), int(rng.integers(1, 4))
    x, y = (columns * _COLUMN) % 1, (rows * _ROW) % 1
    gap = (np.minimum(x, 1 - x) < 0.008 * columns) | (np.minimum(y, 1 - y) < 0.008 * rows)
    level = rng.choice([0.12, 0.88])
    handle = (np.abs(x - 0.5) < 0.22) & (np.abs(y - level) < 0.02)
    return _pair(np.where(gap, 1.0, 0.1 * fractal(rng, 1.2)), handle)


def keys(rng: Generator) -> Array:
    """Rows of keys; the second colour is the gap, the third the signs."""
    columns, rows = int(rng.integers(12, 18)), int(rng.integers(4, 7))
    x, y = (columns * _COLUMN) % 1, (rows * _ROW) % 1
    gap = (np.minimum(x, 1 - x) < 0.07) | (np.minimum(y, 1 - y) < 0.07)
    return _pair(gap, (np.abs(x - 0.4) < 0.08) & (np.abs(y - 0.4) < 0.12))


def turf(rng: Generator) -> Array:
    """Grass, needles and straw from above: strokes over strokes, dark between them."""
    canvas = np.zeros((SIZE, SIZE), np.uint8)
    length, slant = rng.uniform(6, 26), rng.uniform(0, np.pi)
    spread, count = rng.uniform(0.3, 1.6), int(4500 / length)
    for shade in np.linspace(30, 255, 8):
        start = rng.uniform(0, SIZE, (count, 2))
        angle = slant + rng.normal(0, spread, count)
        end = start + length * np.stack([np.cos(angle), np.sin(angle)], 1)
        for shift in _AROUND:
            strokes = np.stack([start + shift, end + shift], 1).round().astype(np.int32)
            cv2.polylines(canvas, list(strokes), False, int(shade), 1, cv2.LINE_AA)
    return _pair(canvas / 255, 0.5 * fractal(rng, 0.5))


def foliage(rng: Generator) -> Array:
    """Leaves beside and above one another, with light and dark ones and gaps."""
    canvas = np.zeros((SIZE, SIZE), np.uint8)
    size = rng.uniform(4, 15)
    for shade in np.linspace(25, 255, 8):
        for x, y, turn in rng.uniform(0, (SIZE, SIZE, 180), (int(4000 / size**1.6) + 8, 3)):
            tone = int(shade * rng.uniform(0.6, 1))
            axes = (int(size * rng.uniform(0.7, 1.2)), int(max(1, size * rng.uniform(0.25, 0.5))))
            for right, down in _AROUND:
                middle = (int(x + right), int(y + down))
                cv2.ellipse(canvas, middle, axes, float(turn), 0, 360, tone, -1, cv2.LINE_AA)
    return _pair(canvas / 255, 0.4 * fractal(rng, 0.4))


def pebbles(rng: Generator) -> Array:
    """Stones of all sizes with dark joints: gravel, cobbles, dry earth, rubble."""
    count = int(np.exp(rng.uniform(np.log(40), np.log(900))))
    place = rng.uniform(0, 1, (count, 2))
    shade = rng.random(count)
    tiled = np.concatenate([place + shift for shift in _AROUND / SIZE])
    seeds = np.full((3 * SIZE, 3 * SIZE), 255, np.uint8)
    column, row = ((tiled + 1) * SIZE).astype(int).T
    inside = (column >= 0) & (row >= 0) & (column < 3 * SIZE) & (row < 3 * SIZE)
    seeds[row[inside], column[inside]] = 0
    distance, label = cv2.distanceTransformWithLabels(
        seeds, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    middle = slice(SIZE, 2 * SIZE)
    number, rim = label[middle, middle], distance[middle, middle]
    tone = np.zeros(int(label.max()) + 1)
    tone[label[row[inside], column[inside]]] = np.tile(shade, len(_AROUND))[inside]
    edge = cv2.morphologyEx(number.astype(np.float32), cv2.MORPH_GRADIENT, np.ones((2, 2))) > 0
    bulge = rim / max(float(rim.max()), 1)
    return _pair(np.clip(tone[number] - 0.5 * bulge, 0, 1), 0.8 * edge + 0.2 * fractal(rng, 0.5))


_AROUND = SIZE * np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])
"""Shifts by a whole period, so that what is drawn across a border comes in at the other side."""


PATTERNS: dict[str, Callable[[Generator], Array]] = {
    maker.__name__: maker
    for maker in (
        plain, mottled, speckled, spots, checks, stripes, bricks,
        tiles, wood, collage, print_lines, windows, panels, weave, doors, keys,
        turf, foliage, pebbles,
    )
}  # fmt: skip
