"""The textures of a world: several variants of every pattern and print, and their halvings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.lettered import LETTERED
from flexdepth.synth.patterns import PATTERNS, Array
from flexdepth.synth.photographs import Photo, cuts, skies
from flexdepth.synth.prints import PICTURES

PRINTS = {**PICTURES, **LETTERED}
"""Textures with colours of their own."""

_WOVEN = ("carpet", "petals", "tunnel")
"""Pictures that rugs and cloth show too."""

NAMES = (*PATTERNS, *PRINTS)
"""Every texture there is, in the order of the layers."""


@dataclass(frozen=True, eq=False)
class Library:
    """Several variants of every texture, each with its halvings for distant surfaces.

    A texel says how much of each of the three colours of a material shows. A pattern shares out
    one surface among them; a print is red, green and blue, for a material of these three colours.

    Attributes:
        variants: How many of each texture; variant v of texture t is layer `t * variants + v`.
        levels: Layers by rows by columns by 3, uint8; each level half the size of the one before.
        skies: Of photographs, linear light; the last row is the horizon.
    """

    variants: int
    levels: tuple[NDArray[np.uint8], ...]
    skies: tuple[Photo, ...] = ()

    @classmethod
    def made(cls, rng: Generator, variants: int, photos: Sequence[Photo] = ()) -> "Library":
        """Return a library drawn from the generator.

        Given photographs, every second variant of each picture that hangs or stands somewhere is
        a part of one. The rest is as it is without them.
        """
        layers = [_shares(make(rng)) for make in PATTERNS.values() for _ in range(variants)]
        layers += [_hung(make(rng)) for make in PRINTS.values() for _ in range(variants)]
        if photos:
            pictures = [NAMES.index(name) for name in PICTURES if name not in _WOVEN]
            taken = [k * variants + odd for k in pictures for odd in range(1, variants, 2)]
            for layer, cut in zip(taken, cuts(rng, photos, len(taken)), strict=True):
                layers[layer] = _hung(cut)
        levels = [np.asarray(layers)]
        while levels[-1].shape[1] > 1:
            fine = levels[-1].astype(np.uint16)
            halved = (
                fine[:, ::2, ::2] + fine[:, 1::2, ::2] + fine[:, ::2, 1::2] + fine[:, 1::2, 1::2]
            )
            levels.append(((halved + 2) // 4).astype(np.uint8))
        return cls(variants, tuple(levels), tuple(skies(photos)))

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
        return out / np.float32(255)


def _nearest(
    stack: NDArray[np.uint8], layer: NDArray[np.intp], uv: NDArray[np.floating]
) -> NDArray[np.uint8]:
    side = stack.shape[1]
    column, row = (np.floor(uv * side).astype(int) % side).T
    return np.asarray(stack[layer, row, column])


def _smooth(
    stack: NDArray[np.uint8], layer: NDArray[np.intp], uv: NDArray[np.floating]
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


def _shares(weights: Array) -> NDArray[np.uint8]:
    """Return the shares of three colours where the second replaces the first, then the third."""
    second, third = np.moveaxis(weights, -1, 0)
    some, other = (255 * second * (1 - third)).round(), (255 * third).round()
    return np.stack([255 - some - other, some, other], -1).clip(0, 255).astype(np.uint8)


def _hung(colours: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Return a print's texels, turned as walls show them: u goes left and v goes up."""
    return np.asarray((255 * np.clip(colours[::-1, ::-1], 0, 1)).round(), np.uint8)
