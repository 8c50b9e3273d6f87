"""What surfaces look like: a pattern, three colours and a size."""

import colorsys
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.library import PRINTS
from flexdepth.synth.shapes import Mesh
from flexdepth.synth.surfaces import KINDS, NATURE


@dataclass(frozen=True, eq=False)
class Material:
    """A surface.

    Attributes:
        pattern: The name of a texture, one of `library.NAMES`.
        colours: Three linear albedos (or emitted colours), rows of red, green, blue.
        size: Metres after which the pattern repeats, along u and v.
        glow: Light it emits in units of its colour: 0 for everything but lamps and windows.
        gloss: Share of the light from straight ahead that it mirrors: 0 for dull things, 0.04 for
            varnish and plastic, 0.9 for mirrors.
        rough: How uneven a glossy surface is: the spread of its unit normal.
        ripple: How steep the waves on it are: water.
        clear: Share of the light from behind that passes, times the colour: glass. The rest is
            scattered back.
    """

    pattern: str
    colours: NDArray[np.float64]
    size: tuple[float, float]
    glow: float = 0.0
    gloss: float = 0.0
    rough: float = 0.0
    ripple: float = 0.0
    clear: float = 0.0


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
    return np.array(colorsys.hsv_to_rgb(_hue(rng), chroma, value)) * 0.97 + 0.01


def _hue(rng: Generator) -> float:
    """Return a hue: mostly the warm ones of wood, stone and skin, then blue, then any."""
    share = rng.random()
    middle, spread = next(hue[1:] for hue in _HUES if share < hue[0])
    return float(rng.normal(middle, spread) % 1)


_HUES = ((0.5, 0.08, 0.035), (0.7, 0.6, 0.05), (0.8, 0.3, 0.08), (1.0, 0.5, 10.0))
"""Share up to here, middle and spread of hues; red is 0 and 1, green 1/3, blue 2/3."""


def _around(rng: Generator, base: NDArray[np.float64], spread: float) -> NDArray[np.float64]:
    """Return the base colour and two neighbours of it."""
    factors = np.exp(rng.normal(0, spread, (3, 1)))
    factors[0] = 1
    return np.asarray(np.clip(base * factors + rng.normal(0, 0.02 * spread, (3, 3)), 0.005, 0.97))


def material(rng: Generator, kind: str) -> Material:
    """Return a random material of a kind, such as `wall`, `wood`, `asphalt` or `leaf`."""
    if kind in NATURE:
        nature = NATURE[kind]
        tinted = (
            np.asarray(nature.base) * np.exp(rng.normal(0, 0.3)) * np.exp(rng.normal(0, 0.12, 3))
        )
        size = rng.uniform(*nature.span)
        pattern = nature.patterns[int(rng.integers(len(nature.patterns)))]
        colours = _inked(rng, pattern, _around(rng, tinted, rng.uniform(0.25, 0.75)))
        ripple = nature.ripple * float(rng.random()) ** 2
        return Material(
            pattern, colours, (size, size), 0.0, nature.gloss, nature.rough, ripple, nature.clear
        )
    sort = KINDS[kind]
    pattern = sort.patterns[int(rng.integers(len(sort.patterns)))]
    colours = _around(rng, colour(rng, sort.saturation, sort.bright), sort.spread)
    if rng.random() < sort.spread / 2:
        colours = np.stack([colour(rng, sort.saturation) for _ in range(3)])
    size = rng.uniform(*sort.span)
    shiny = rng.random() < sort.shiny
    return Material(
        pattern,
        _inked(rng, pattern, colours),
        (size, size * rng.uniform(0.7, 1.4)),
        0.0,
        float(rng.uniform(*sort.gloss)) if shiny else 0.0,
        float(rng.uniform(*sort.rough)),
        clear=sort.clear,
    )


def _inked(rng: Generator, pattern: str, colours: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the colours that the texture's three shares stand for; a print has its own inks."""
    if pattern not in PRINTS:
        return colours
    inks = rng.uniform(0.5, 0.95) * np.exp(rng.normal(0, 0.05, 3))
    mixed = np.diag(inks) * 0.96 + 0.01
    faded = rng.beta(1, 3) * 0.6
    return np.asarray(np.clip((1 - faded) * mixed + faded * mixed.mean(0) / 3, 0.0, 0.97))


def fitted(rng: Generator, kind: str, width: float, height: float) -> Material:
    """Return a material whose pattern covers a surface of the given size exactly once."""
    return replace(material(rng, kind), size=(width, height))


def shown(picture: str, size: tuple[float, float], strength: float) -> Material:
    """Return a screen or a view that shines with a print's colours, once on the given size."""
    return Material(picture, np.eye(3) * strength, size, 1.0)


def glowing(rng: Generator, pattern: str, strength: float) -> Material:
    """Return a surface that shines: a lamp, a window in daylight, a screen."""
    tint = np.array([1.0, rng.uniform(0.85, 1), rng.uniform(0.7, 1)])
    colours = tint * rng.uniform(0.3, 1, (3, 1))
    size = float(rng.uniform(0.5, 2))
    return Material(pattern, colours, (size, size), strength)
