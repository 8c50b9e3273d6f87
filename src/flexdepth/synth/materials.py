"""What surfaces look like: a pattern, three colours and a size."""

import colorsys
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.shapes import Mesh


@dataclass(frozen=True, eq=False)
class Material:
    """A diffuse surface.

    Attributes:
        pattern: The name of a pattern in `patterns.PATTERNS`.
        colours: Three linear albedos (or emitted colours), rows of red, green, blue.
        size: Metres after which the pattern repeats, along u and v.
        glow: Light it emits in units of its colour: 0 for everything but lamps and windows.
        gloss: Share of the light from straight ahead that it mirrors; more from aside.
        ripple: How steep the waves on it are: water.
    """

    pattern: str
    colours: NDArray[np.float64]
    size: tuple[float, float]
    glow: float = 0.0
    gloss: float = 0.0
    ripple: float = 0.0


@dataclass(frozen=True, eq=False)
class Part:
    """A mesh of one material."""

    mesh: Mesh
    material: Material


def colour(
    rng: Generator, saturation: float = 0.6, bright: tuple[float, float] = (0.05, 0.8)
) -> NDArray[np.float64]:
    """Return a random linear albedo: half of the time nearly grey, as most man-made things are."""
    low, high = np.sqrt(bright)
    value = rng.uniform(low, high) ** 2
    if rng.random() < 0.45:
        return np.asarray(np.clip(value + rng.normal(0, 0.03, 3), 0.01, 0.95))
    chroma = min(1.0, 1.2 * saturation) * rng.beta(1.6, 1.8)
    return np.array(colorsys.hsv_to_rgb(rng.random(), chroma, value)) * 0.97 + 0.01


def _around(rng: Generator, base: NDArray[np.float64], spread: float) -> NDArray[np.float64]:
    """Return the base colour and two neighbours of it."""
    factors = np.exp(rng.normal(0, spread, (3, 1)))
    factors[0] = 1
    return np.asarray(np.clip(base * factors + rng.normal(0, 0.02 * spread, (3, 3)), 0.005, 0.97))


_KINDS: dict[str, tuple[tuple[str, ...], float, tuple[float, float]]] = {
    "wall": (
        ("plain", "plain", "plain", "mottled", "stripes", "bricks", "tiles", "wood"),
        0.25,
        (0.6, 2.5),
    ),
    "ceiling": (("plain", "plain", "mottled", "tiles"), 0.1, (0.8, 2.4)),
    "floor": (("wood", "wood", "tiles", "mottled", "speckled", "checks", "plain"), 0.4, (0.6, 2.5)),
    "wood": (("wood", "wood", "plain"), 0.35, (0.3, 1.2)),
    "fabric": (("plain", "mottled", "speckled", "stripes", "checks", "spots"), 0.5, (0.1, 0.8)),
    "cabinet": (("panels", "panels", "plain", "wood"), 0.5, (0.8, 1.8)),
    "thing": (
        ("plain", "plain", "mottled", "stripes", "collage", "spots", "print_lines", "wood"),
        0.7,
        (0.1, 0.6),
    ),
    "poster": (("collage", "collage", "spots", "print_lines", "mottled"), 1.2, (0.4, 1.6)),
    "metal": (("plain", "mottled"), 0.3, (0.3, 1.0)),
    "facade": (("windows", "windows", "bricks", "mottled", "plain", "tiles"), 0.6, (2.0, 7.0)),
    "brickwork": (("bricks", "mottled", "plain", "tiles"), 0.3, (0.8, 2.5)),
    "bare": (("mottled", "mottled", "bricks", "bricks", "speckled", "wood"), 0.5, (0.8, 2.5)),
}

_NATURE: dict[str, tuple[tuple[str, ...], tuple[float, float, float], tuple[float, float]]] = {
    "asphalt": (("speckled", "mottled"), (0.13, 0.13, 0.14), (1.0, 4.0)),
    "pavement": (("tiles", "bricks", "speckled"), (0.3, 0.28, 0.26), (0.8, 3.0)),
    "grass": (("speckled", "mottled"), (0.12, 0.2, 0.05), (0.5, 4.0)),
    "leaf": (("speckled", "mottled"), (0.08, 0.16, 0.04), (0.3, 1.5)),
    "bark": (("mottled", "wood"), (0.14, 0.1, 0.07), (0.3, 1.0)),
    "skin": (("plain",), (0.5, 0.33, 0.25), (0.3, 0.6)),
    "roof": (("tiles", "bricks", "stripes"), (0.25, 0.12, 0.09), (1.0, 3.0)),
    "glass": (("mottled", "plain"), (0.05, 0.06, 0.08), (1.0, 3.0)),
    "soil": (("mottled", "speckled", "spots"), (0.16, 0.11, 0.075), (0.6, 4.0)),
    "sand": (("mottled", "speckled", "plain"), (0.45, 0.36, 0.24), (0.6, 4.0)),
    "gravel": (("speckled", "spots"), (0.3, 0.28, 0.25), (0.3, 1.5)),
    "snow": (("plain", "mottled"), (0.82, 0.84, 0.88), (1.0, 5.0)),
    "rock": (("mottled", "spots", "speckled"), (0.25, 0.23, 0.21), (0.8, 6.0)),
    "straw": (("speckled", "wood", "mottled"), (0.42, 0.3, 0.11), (0.3, 2.0)),
    "wood far": (("speckled", "spots"), (0.05, 0.09, 0.035), (8.0, 40.0)),
    "autumn": (("speckled", "mottled"), (0.3, 0.14, 0.03), (0.3, 1.5)),
    "blossom": (("speckled", "plain"), (0.6, 0.4, 0.45), (0.3, 1.0)),
    "water": (("mottled", "plain"), (0.02, 0.045, 0.05), (3.0, 12.0)),
    "paint": (("plain", "speckled"), (0.75, 0.75, 0.72), (0.5, 2.0)),
    "tyre": (("plain",), (0.02, 0.02, 0.02), (0.3, 0.5)),
}  # fmt: skip


_SMOOTH = {"glass": (0.08, 0.0), "water": (0.03, 0.03)}
"""Kinds that mirror: the share from straight ahead, and the steepest waves."""


def material(rng: Generator, kind: str) -> Material:
    """Return a random material of a kind, such as `wall`, `wood`, `asphalt` or `leaf`."""
    if kind in _NATURE:
        patterns, base, span = _NATURE[kind]
        tinted = np.asarray(base) * np.exp(rng.normal(0, 0.3)) * np.exp(rng.normal(0, 0.12, 3))
        size = rng.uniform(*span)
        gloss, ripple = _SMOOTH.get(kind, (0.0, 0.0))
        return Material(
            str(rng.choice(patterns)),
            _around(rng, tinted, rng.uniform(0.25, 0.75)),
            (size, size),
            gloss=gloss,
            ripple=ripple * float(rng.uniform(0, 1)) ** 2,
        )
    patterns, spread, span = _KINDS[kind]
    bright = (0.35, 0.9) if kind in ("ceiling", "wall") and rng.random() < 0.7 else (0.04, 0.8)
    colours = _around(rng, colour(rng, 0.25 if kind == "ceiling" else 0.7, bright), spread)
    if rng.random() < spread / 2:
        colours = np.stack([colour(rng) for _ in range(3)])
    size = rng.uniform(*span)
    return Material(str(rng.choice(patterns)), colours, (size, size * rng.uniform(0.7, 1.4)))


def fitted(rng: Generator, kind: str, width: float, height: float) -> Material:
    """Return a material whose pattern covers a surface of the given size exactly once."""
    base = material(rng, kind)
    return Material(base.pattern, base.colours, (width, height))


def glowing(rng: Generator, pattern: str, strength: float) -> Material:
    """Return a surface that shines: a lamp, a window in daylight, a screen."""
    tint = np.array([1.0, rng.uniform(0.85, 1), rng.uniform(0.7, 1)])
    colours = tint * rng.uniform(0.3, 1, (3, 1))
    size = float(rng.uniform(0.5, 2))
    return Material(pattern, colours, (size, size), strength)
