"""What a network answers for a batch of pictures, and the mean of several answers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.sizes import resized

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

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the maps."""
        height, width = self.depth.shape[1:]
        return width, height

    def resized(self, size: tuple[int, int]) -> "Answer":
        """Return the same with maps of this width and height; depth is a mean of logarithms."""
        depth = np.exp(_each_resized(np.log(self.depth), size))
        spread = None if self.spread is None else _each_resized(self.spread, size)
        return replace(self, depth=depth, sky=_each_resized(self.sky, size), spread=spread)

    @staticmethod
    def joined(answers: "Sequence[Answer]", depth: Reals) -> "Answer":
        """Return the means of answers; how the depths were joined is for the caller to say."""
        return Answer(
            depth,
            np.mean([answer.sky for answer in answers], axis=0),
            _mean_if_all([answer.spread for answer in answers]),
            _mean_if_all([answer.focal for answer in answers]),
        )


def _each_resized(maps: Reals, size: tuple[int, int]) -> Reals:
    return np.stack([resized(np.ascontiguousarray(each), size) for each in maps])


def _mean_if_all(values: Sequence[Reals | None]) -> Reals | None:
    said = [value for value in values if value is not None]
    return np.mean(said, axis=0) if len(said) == len(values) else None
