"""Prints with words on them: pages, labels, screens."""

from collections.abc import Callable

import cv2
import numpy as np
from numpy.random import Generator

from flexdepth.synth.patterns import SIZE, Array
from flexdepth.synth.prints import blend, filled, picture, tint


def _lettering(rng: Generator, canvas: Array, box: tuple[int, int, int, int], ink: Array) -> None:
    """Draw lines of words into the box of left, top, right and bottom texels."""
    left, top, right, bottom = box
    step = int(rng.integers(4, 12))
    for y in range(top, bottom - step, step):
        x = left
        while x < right - 6:
            word = int(rng.integers(3, 22))
            end = min(x + word, right)
            cv2.rectangle(canvas, (x, y), (end, y + step // 2), ink.tolist(), -1)
            x = end + int(rng.integers(2, 6))


def _word(
    rng: Generator, canvas: Array, place: tuple[int, int], sizes: tuple[float, float]
) -> None:
    """Draw a few random letters, their lower left corner at `place`."""
    letters = "".join(chr(c) for c in rng.integers(65, 91, int(rng.integers(2, 9))))
    ink = np.zeros((SIZE, SIZE), np.uint8)
    thick = int(rng.integers(1, 6))
    cv2.putText(
        ink, letters, place, int(rng.integers(8)), rng.uniform(*sizes), 255, thick, cv2.LINE_AA
    )
    canvas[:] = blend(canvas, tint(rng), ink / 255)


def page(rng: Generator) -> Array:
    """A sheet or a magazine: headline, columns, a picture."""
    canvas = filled(rng.uniform(0.6, 0.95) * rng.uniform(0.85, 1, 3))
    if rng.random() < 0.15:
        canvas = filled(tint(rng))
    ink = tint(rng, 0.01, 0.1)
    top = int(rng.integers(20, 50))
    _word(rng, canvas, (12, top), (0.6, 1.6))
    middle = int(rng.integers(110, 150))
    _lettering(rng, canvas, (12, top + 10, middle - 6, SIZE - 12), ink)
    _lettering(rng, canvas, (middle + 6, top + 10, SIZE - 12, SIZE - 12), ink)
    if rng.random() < 0.7:
        inner = picture(rng)
        x, y = rng.integers(8, 100, 2)
        w, h = rng.integers(60, 140, 2)
        canvas[y : y + h, x : x + w] = cv2.resize(inner, (int(w), int(h)))
    return canvas


def label(rng: Generator) -> Array:
    """The front of a packet, a tin, a book or a bottle: bands, a name, a badge."""
    canvas = filled(tint(rng))
    for _ in range(int(rng.integers(1, 5))):
        a, b = np.sort(rng.integers(0, SIZE, 2))
        canvas[a:b] = tint(rng)
    if rng.random() < 0.5:
        x, y = rng.integers(60, 200, 2)
        cv2.circle(canvas, (int(x), int(y)), int(rng.integers(15, 70)), tint(rng).tolist(), -1)
    for _ in range(int(rng.integers(1, 4))):
        _word(rng, canvas, (int(rng.integers(0, 120)), int(rng.integers(30, SIZE))), (0.8, 3))
    if rng.random() < 0.4:
        y = int(rng.integers(0, 180))
        _lettering(rng, canvas, (20, y, SIZE - 20, y + 70), tint(rng))
    return canvas


def display(rng: Generator) -> Array:
    """What a screen shows: a picture, or windows with bars and text."""
    canvas = picture(rng) if rng.random() < 0.6 else filled(tint(rng))
    for _ in range(int(rng.integers(0, 4))):
        x, y = rng.integers(0, 160, 2)
        w, h = rng.integers(60, 200, 2)
        body = tint(rng, 0.5, 1) if rng.random() < 0.7 else tint(rng, 0.01, 0.1)
        right, low = int(min(x + w, SIZE - 1)), int(min(y + h, SIZE - 1))
        cv2.rectangle(canvas, (int(x), int(y)), (right, low), body.tolist(), -1)
        cv2.rectangle(canvas, (int(x), int(y)), (right, int(y) + 8), tint(rng).tolist(), -1)
        _lettering(rng, canvas, (int(x) + 6, int(y) + 14, right - 4, low), tint(rng))
    return canvas


LETTERED: dict[str, Callable[[Generator], Array]] = {
    maker.__name__: maker for maker in (page, label, display)
}
