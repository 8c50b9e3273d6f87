"""The textures of a world: several variants of every pattern and print, and their halvings."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.lettered import LETTERED
from flexdepth.synth.patterns import PATTERNS, SIZE, Array
from flexdepth.synth.photographs import Photo, cuts, skies
from flexdepth.synth.prints import PICTURES

PRINTS = {**PICTURES, **LETTERED}
"""Textures with colours of their own."""

_WOVEN = ("carpet", "petals", "tunnel")
"""Pictures that rugs and cloth show too."""

NAMES = (*PATTERNS, *PRINTS)
"""Every texture there is, in the order of the layers."""

Texels = NDArray[np.uint16]
"""Rows by columns by 3, a share of 1 as `WHOLE`.

In linear light 8 bits would leave steps of a tenth between dark tones, which an exposure for the
shadows shows as bands.
"""

WHOLE = 65535


@dataclass(frozen=True, eq=False)
class Library:
    """Several variants of every texture, each with its halvings for distant surfaces.

    A texel says how much of each of the three colours of a material shows. A pattern shares out
    one surface among them; a print is red, green and blue, for a material of these three colours.

    Attributes:
        variants: How many of each texture; variant v of texture t is layer `t * variants + v`.
        levels: Layers of texels; each level half the size of the one before.
        skies: Of photographs, linear light; the last row is the horizon.
    """

    variants: int
    levels: tuple[NDArray[np.uint16], ...]
    skies: tuple[Photo, ...] = ()

    @classmethod
    def made(cls, rng: Generator, variants: int, photos: Sequence[Photo] = ()) -> "Library":
        """Return a library drawn from the generator.

        Given photographs, every second variant of each picture that hangs or stands somewhere is
        a part of one. The rest is as it is without them.
        """
        levels = _empty(len(NAMES) * variants)
        makers = [*PATTERNS.values(), *PRINTS.values()]
        for layer in range(len(makers) * variants):
            texels = _shares if layer < len(PATTERNS) * variants else _hung
            _put(levels, layer, texels(makers[layer // variants](rng)))
        if photos:
            pictures = [NAMES.index(name) for name in PICTURES if name not in _WOVEN]
            taken = [k * variants + odd for k in pictures for odd in range(1, variants, 2)]
            for layer, cut in zip(taken, cuts(rng, photos, len(taken)), strict=True):
                _put(levels, layer, _hung(cut))
        return cls(variants, levels, tuple(skies(photos)))

    def layer(self, rng: Generator, name: str) -> int:
        """Return the layer of one variant of the texture."""
        return NAMES.index(name) * self.variants + int(rng.integers(self.variants))

    def shares(
        self, layer: NDArray[np.intp], uv: NDArray[np.floating], texels: NDArray[np.floating]
    ) -> NDArray[np.float32]:
        """Return how much of each colour shows at each texture coordinate.

        Args:
            layer: The layer of each point.
            uv: Points by two coordinates; the texture repeats with period 1.
            texels: How many finest texels one pixel covers at each point; it selects the level.
        """
        level = np.clip(np.log2(np.maximum(texels, 1)).round(), 0, len(self.levels) - 1).astype(int)
        out = np.empty((len(layer), 3), np.float32)
        for k, stack in enumerate(self.levels):
            here = np.flatnonzero(level == k)
            look = _smooth if k == 0 else _nearest
            out[here] = look(stack, layer[here], uv[here])
        return out / np.float32(WHOLE)


def _nearest(
    stack: NDArray[np.uint16], layer: NDArray[np.intp], uv: NDArray[np.floating]
) -> NDArray[np.uint16]:
    side = stack.shape[1]
    column, row = (np.floor(uv * side).astype(int) % side).T
    return np.asarray(stack[layer, row, column])


def _smooth(
    stack: NDArray[np.uint16], layer: NDArray[np.intp], uv: NDArray[np.floating]
) -> NDArray[np.float32]:
    """Return texels interpolated, so that a print seen from near has no steps."""
    side = stack.shape[1]
    place = uv * side - 0.5
    corner = np.floor(place)
    right, down = (place - corner).astype(np.float32).T[..., None]
    column, row = (corner.astype(int) % side).T
    beside, below = (column + 1) % side, (row + 1) % side
    upper = stack[layer, row, column] * (1 - right) + stack[layer, row, beside] * right
    lower = stack[layer, below, column] * (1 - right) + stack[layer, below, beside] * right
    return np.asarray(upper * (1 - down) + lower * down, np.float32)


def _empty(layers: int) -> tuple[NDArray[np.uint16], ...]:
    """Return room for so many layers at every level, down to one texel."""
    sides = SIZE >> np.arange(SIZE.bit_length())
    return tuple(np.empty((layers, side, side, 3), np.uint16) for side in sides)


def _put(levels: tuple[NDArray[np.uint16], ...], layer: int, texels: Texels) -> None:
    """Write a texture and its halvings."""
    for level in levels:
        side = level.shape[1]
        texels = np.asarray(cv2.resize(texels, (side, side), interpolation=cv2.INTER_AREA))
        level[layer] = texels


def _shares(weights: Array) -> Texels:
    """Return the shares of three colours where the second replaces the first, then the third."""
    second, third = np.moveaxis(weights, -1, 0)
    return _texels(np.stack([(1 - second) * (1 - third), second * (1 - third), third], -1))


def _hung(colours: NDArray[np.floating]) -> Texels:
    """Return a print's texels, turned as walls show them: u goes left and v goes up."""
    return _texels(colours[::-1, ::-1])


def _texels(shares: NDArray[np.floating]) -> Texels:
    return np.asarray((WHOLE * np.clip(shares, 0, 1)).round(), np.uint16)
