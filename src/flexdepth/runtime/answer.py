"""What a network answers for a batch of pictures, and the mean of two answers."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

_HALF = np.float32(0.5)

Reals = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Answer:
    """The outputs of a network. All but `focal` are (batch, height, width).

    Attributes:
        depth: Canonical depth, > 0.
        sky: The probability of sky.
        spread: The relative standard deviation of depth, the one factor of each map left out;
            None where the network does not say.
        focal: The focal length in diagonals of the picture, (batch,); None where the network does
            not say.
    """

    depth: Reals
    sky: Reals
    spread: Reals | None = None
    focal: Reals | None = None

    def mirrored(self) -> "Answer":
        """Return the same with left and right exchanged."""
        spread = None if self.spread is None else self.spread[..., ::-1]
        return replace(self, depth=self.depth[..., ::-1], sky=self.sky[..., ::-1], spread=spread)

    def each(self) -> "list[Answer]":
        """Return the answer for each picture: maps of height x width, and one focal length."""
        count = len(self.depth)
        spreads = [None] * count if self.spread is None else list(self.spread)
        focals = [None] * count if self.focal is None else list(self.focal)
        return [Answer(*one) for one in zip(self.depth, self.sky, spreads, focals, strict=True)]

    @property
    def focal_of_one(self) -> float | None:
        """The focal length in an answer for one picture."""
        return None if self.focal is None else float(self.focal)

    def joined(self, other: "Answer", depth: Reals) -> "Answer":
        """Return the means of two answers; how the depths were joined is for the caller to say."""
        return Answer(
            depth,
            _mean(self.sky, other.sky),
            _mean_if_any(self.spread, other.spread),
            _mean_if_any(self.focal, other.focal),
        )


def _mean(one: Reals, other: Reals) -> Reals:
    return (one + other) * _HALF


def _mean_if_any(one: Reals | None, other: Reals | None) -> Reals | None:
    return None if one is None or other is None else _mean(one, other)
