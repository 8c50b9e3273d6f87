"""Prints: pictures on flat things, in colour. Most of them suggest a depth that is not there.

A print is a square of linear red, green and blue in [0, 1], its first row on top.
"""

from collections.abc import Callable
from itertools import pairwise

import cv2
import numpy as np
from numpy.random import Generator

from flexdepth.synth.patterns import SIZE, Array, fractal

_ROW, _COLUMN = np.mgrid[:SIZE, :SIZE] / SIZE


def tint(rng: Generator, low: float = 0.02, high: float = 0.9) -> Array:
    """Return a random colour of the given range of brightness."""
    value = rng.uniform(low**0.5, high**0.5) ** 2
    hue = rng.dirichlet((1, 1, 1)) * 3
    mix = rng.beta(1.5, 1.5)
    return np.asarray(np.clip(value * ((1 - mix) + mix * hue), 0, 1))


def filled(colour: Array) -> Array:
    """Return a print of one colour."""
    return np.broadcast_to(colour, (SIZE, SIZE, 3)).copy()


def blend(first: Array, second: Array, weight: Array) -> Array:
    """Return the first print, replaced by the second as far as the weight says."""
    return np.asarray(first + weight[..., None] * (second - first))


def _polygon(canvas: Array, corners: object, colour: Array) -> None:
    points = (256 * SIZE * np.asarray(corners, float)).round().astype(np.int32)
    cv2.fillPoly(canvas, [points], tuple(colour.tolist()), cv2.LINE_AA, 8)


def _sky(rng: Generator) -> Array:
    top, bottom = tint(rng, 0.1, 0.8) * (0.6, 0.8, 1), tint(rng, 0.5, 1)
    sky = blend(filled(top), bottom, _ROW ** rng.uniform(0.5, 2))
    clouds = np.clip(3 * (fractal(rng, 1.7) - rng.uniform(0.3, 1)), 0, 1)
    return blend(sky, tint(rng, 0.6, 1), clouds)


def landscape(rng: Generator) -> Array:
    """Sky, ridge behind ridge, meadows and a few trees."""
    canvas = _sky(rng)
    horizon = rng.uniform(0.25, 0.7)
    haze, near = canvas[int(horizon * SIZE)].mean(0), tint(rng, 0.03, 0.3) * (0.8, 1, 0.6)
    count = int(rng.integers(2, 6))
    lines, texture = fractal(rng, 2.0), 0.7 + 0.6 * fractal(rng, 0.8)[..., None]
    for k in range(count):
        line = horizon + 0.12 * k - 0.25 / (k + 1) * (lines[16 * k] - 0.5)
        share = (k + 1) / count
        ridge = (share * near + (1 - share) * haze) * texture
        canvas = np.where((line[None] < _ROW)[..., None], ridge, canvas)
    for _ in range(int(rng.integers(0, 8))):
        x, y, size = rng.random(), rng.uniform(horizon, 1), rng.uniform(0.03, 0.2)
        crown = np.hypot(_COLUMN - x, (_ROW - y) * 0.7) + 0.5 * size * texture[..., 0] < 1.4 * size
        canvas = blend(canvas, near * rng.uniform(0.2, 1.4), crown * 0.9)
    return canvas


def interior(rng: Generator) -> Array:
    """A room in perspective: a chequered floor, walls, a ceiling, doors."""
    x, y = rng.uniform(0.3, 0.7, 2)
    w, h = rng.uniform(0.08, 0.3, 2)
    left, right, top, low = x - w * 0.8, x + w * 0.8, y - h, y + h
    corners = {
        "ceiling": [(0, 0), (1, 0), (right, top), (left, top)],
        "left": [(0, 0), (left, top), (left, low), (0, 1)],
        "right": [(1, 0), (right, top), (right, low), (1, 1)],
        "back": [(left, top), (right, top), (right, low), (left, low)],
    }
    canvas = filled(tint(rng, 0.05, 0.6))
    deep = np.maximum(_ROW - y, 1e-3)
    across = np.floor((_COLUMN - x) / deep * rng.uniform(1, 4)) + np.floor(
        rng.uniform(0.5, 2) / deep
    )
    canvas = blend(canvas, tint(rng), (across % 2) * (low < _ROW))
    for outline in corners.values():
        _polygon(canvas, outline, tint(rng, 0.1, 0.9))
    for _ in range(int(rng.integers(0, 5))):
        a, b = np.sort(rng.uniform(left, right, 2))
        c = rng.uniform(top, low)
        _polygon(canvas, [(a, c), (b, c), (b, low), (a, low)], tint(rng))
    return canvas * (0.5 + 0.5 * fractal(rng, 1.8))[..., None]


def facade(rng: Generator) -> Array:
    """Houses on both sides of a street that runs away from the viewer."""
    canvas = _sky(rng)
    x, y = rng.uniform(0.3, 0.7), rng.uniform(0.4, 0.65)
    _polygon(canvas, [(x, y), (1.5, 1.2), (-0.5, 1.2)], tint(rng, 0.05, 0.3))
    for side in (-1, 1):
        edges = x + side * np.geomspace(1.2, 0.03, int(rng.integers(3, 8)))
        for outer, inner in pairwise(edges):
            height, base = rng.uniform(0.6, 1.6), rng.uniform(0.4, 0.7)
            wall = tint(rng, 0.05, 0.7)
            d0, d1 = abs(outer - x), abs(inner - x)
            _polygon(
                canvas,
                [(outer, y - height * d0), (inner, y - height * d1), (inner, y + base * d1),
                 (outer, y + base * d0)],
                wall,
            )  # fmt: skip
            for a in (0.15, 0.45, 0.75):
                s, t = outer + a * (inner - outer), outer + (a + 0.17) * (inner - outer)
                for b in np.arange(0.1, height, 0.25):
                    p, q = abs(s - x), abs(t - x)
                    pane = [(s, y - b * p), (t, y - b * q), (t, y - (b + 0.13) * q),
                            (s, y - (b + 0.13) * p)]  # fmt: skip
                    _polygon(canvas, pane, wall * rng.uniform(0.1, 1.5))
    return canvas


def still_life(rng: Generator) -> Array:
    """Shaded balls, jars and boxes on a table: relief that is only painted."""
    ground = rng.uniform(0.4, 0.8)
    canvas = np.where((ground < _ROW)[..., None], tint(rng, 0.05, 0.6), tint(rng, 0.02, 0.6))
    light = rng.uniform(-0.7, 0.7, 2)
    for _ in range(int(rng.integers(2, 9))):
        x, size = rng.uniform(0.1, 0.9), rng.uniform(0.05, 0.25)
        y = ground + rng.uniform(-0.1, 0.25)
        u, v = (_COLUMN - x) / size, (_ROW - y) / (size * rng.uniform(0.6, 2.2))
        inside = u**2 + v**2 < 1 if rng.random() < 0.6 else (np.abs(u) < 0.8) & (np.abs(v) < 1)
        shade = np.clip(0.7 - 0.5 * (light[0] * u + light[1] * v), 0.08, 1.3)
        canvas = np.where(inside[..., None], tint(rng) * shade[..., None], canvas)
    return canvas * (0.8 + 0.2 * fractal(rng, 0.6))[..., None]


def portrait(rng: Generator) -> Array:
    """A head and shoulders before a soft background."""
    canvas = blend(filled(tint(rng)), tint(rng), fractal(rng, 1.8))
    x, y, size = rng.uniform(0.35, 0.65), rng.uniform(0.3, 0.5), rng.uniform(0.12, 0.25)
    skin = np.array((0.5, 0.33, 0.25)) * rng.uniform(0.2, 1.4)
    u, v = (_COLUMN - x) / size, (_ROW - y) / size
    shade = np.clip(1 - 0.4 * u * rng.choice([-1, 1]) - 0.2 * v, 0.2, 1.4)[..., None]
    canvas = np.where((u**2 + (v * 0.8 + 0.2) ** 2 < 1.3)[..., None], tint(rng, 0.01, 0.3), canvas)
    cloth = (u / 2.2) ** 2 + ((v - 2.8) / 1.6) ** 2 < 1
    canvas = np.where(cloth[..., None], tint(rng) * shade, canvas)
    canvas = np.where(((u / 0.8) ** 2 + (v / 1.05) ** 2 < 1)[..., None], skin * shade, canvas)
    for side in (-0.35, 0.35):
        canvas[np.hypot((u - side) / 0.18, (v + 0.1) / 0.08) < 1] = 0.03
    canvas[np.hypot(u / 0.3, (v - 0.5) / 0.07) < 1] = (0.3, 0.05, 0.05)
    return canvas


def petals(rng: Generator) -> Array:
    """Flowers or leaves from near, one over the other, each shaded."""
    canvas = filled(tint(rng, 0.01, 0.2))
    base = tint(rng, 0.1, 0.9)
    for _ in range(int(rng.integers(20, 70))):
        x, y = rng.random(2)
        long, wide = rng.uniform(0.04, 0.2), rng.uniform(0.02, 0.07)
        angle = rng.uniform(0, 180)
        tone = np.clip(base * np.exp(rng.normal(0, 0.35)) * np.exp(rng.normal(0, 0.2, 3)), 0, 1)
        for share in (1.0, 0.6):
            cv2.ellipse(
                canvas, (int(SIZE * x), int(SIZE * y)),
                (int(SIZE * long * share), max(1, int(SIZE * wide * share))),
                angle, 0, 360, (tone * (1.6 - share * 0.7)).tolist(), -1, cv2.LINE_AA,
            )  # fmt: skip
    return np.asarray(np.clip(canvas, 0, 1))


def painting(rng: Generator) -> Array:
    """Broad strokes and fields of colour."""
    canvas = filled(tint(rng))
    for _ in range(int(rng.integers(10, 120))):
        a = rng.integers(0, SIZE, 2)
        b = a + rng.normal(0, rng.uniform(10, 80), 2)
        wide = int(rng.integers(1, 22))
        cv2.line(canvas, a.tolist(), b.astype(int).tolist(), tint(rng).tolist(), wide, cv2.LINE_AA)
    return canvas


def tunnel(rng: Generator) -> Array:
    """Frames within frames, or rings within rings, that grow darker or lighter inwards."""
    x, y = rng.uniform(0.35, 0.65, 2)
    u, v = np.abs(_COLUMN - x), np.abs(_ROW - y)
    radius = np.hypot(u, v) if rng.random() < 0.5 else np.maximum(u, v)
    band = np.floor(np.log(radius + 0.02) * rng.uniform(3, 9)) % 2
    shade = radius / radius.max() if rng.random() < 0.6 else 1 - radius / radius.max()
    rings = blend(filled(tint(rng)), tint(rng), band)
    return np.asarray(rings * (0.2 + 0.8 * shade)[..., None])


def photograph(rng: Generator) -> Array:
    """The statistics of a photograph without its things: noise in each colour, and edges."""
    common = fractal(rng, 1.5)
    canvas = np.stack([0.7 * common + 0.3 * fractal(rng, 1.3) for _ in range(3)], -1)
    for _ in range(int(rng.integers(1, 7))):
        edge = fractal(rng, 2.0) > rng.uniform(0.3, 0.8)
        canvas = np.where(edge[..., None], canvas * tint(rng, 0.1, 1) * 2, canvas)
    return np.asarray(np.clip(canvas**2, 0, 1))


def carpet(rng: Generator) -> Array:
    """An oriental rug: borders within borders and a mirrored field."""
    field = fractal(rng, 1.2)
    mirrored = field + field[::-1] + field[:, ::-1] + field[::-1, ::-1]
    level = np.digitize(mirrored, np.quantile(mirrored, np.sort(rng.random(3))))
    palette = np.stack([tint(rng, 0.02, 0.5) for _ in range(8)])
    canvas = palette[level]
    rim = np.minimum(np.minimum(_COLUMN, 1 - _COLUMN), np.minimum(_ROW, 1 - _ROW))
    for k, width in enumerate(np.sort(rng.uniform(0.02, 0.2, 3))[::-1]):
        motif = (np.sin((_COLUMN + _ROW) * 2 * np.pi * 24) > 0)[..., None]
        canvas = np.where(
            (rim < width)[..., None], np.where(motif, palette[4 + k], palette[5 + k]), canvas
        )
    return np.asarray(canvas * (0.7 + 0.3 * fractal(rng, 0.2))[..., None])


_PICTURES: tuple[Callable[[Generator], Array], ...] = (
    landscape, landscape, interior, facade, still_life, portrait, petals, painting, photograph,
    photograph, tunnel,
)  # fmt: skip


def picture(rng: Generator) -> Array:
    """Return any of the pictures."""
    return np.ascontiguousarray(_PICTURES[int(rng.integers(len(_PICTURES)))](rng))


PICTURES: dict[str, Callable[[Generator], Array]] = {
    maker.__name__: maker
    for maker in (
        landscape, interior, facade, still_life, portrait, petals, painting, tunnel, photograph,
        carpet,
    )
}  # fmt: skip
