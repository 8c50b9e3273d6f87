"""What moves in a sequence, how much of the picture, and how the camera does."""

from dataclasses import dataclass
from enum import Enum
from math import floor

from numpy.random import Generator

from flexdepth.runtime.errors import InputError


class Footing(Enum):
    """What the first frame shows of a mover's feet."""

    SEEN = "feet seen"
    """They stand, walk or roll on the ground, where the camera sees it."""
    HIDDEN = "feet hidden"
    """They do so behind something, or below the picture."""
    NONE = "in the air"
    """It flies, jumps or hangs."""


@dataclass(frozen=True)
class Motion:
    """How the frames of a sequence differ.

    Attributes:
        frames: Frames of a sequence; 1 shows no motion.
        rate: Frames a second.
        focal: Focal length in pixels; None draws the field of view.
        parallax: Least and most pixels by which the camera's travel moves the median still point
            from one frame to the next, sky left out; None lets cameras travel as they do.
        moving: Least and most share of the first frame that moves by itself.
        rigid: Least and most number of rigid movers.
        flexible: Least and most number of movers that bend.
        feet: Share of the movers whose feet are seen in the first frame; half of the others hide
            them, half are in the air.
        shutter: Share of the time between two frames during which the shutter is open, and what
            moves is blurred; 0 freezes it.
    """

    frames: int = 1
    rate: float = 10.0
    focal: float | None = None
    parallax: tuple[float, float] | None = None
    moving: tuple[float, float] = (0.01, 0.5)
    rigid: tuple[int, int] = (0, 2)
    flexible: tuple[int, int] = (0, 2)
    feet: float = 2 / 3
    shutter: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what cannot be filmed."""
        spans = (self.moving, self.rigid, self.flexible, self.parallax or (0, 0))
        if any(not 0 <= low <= high for low, high in spans) or self.moving[1] > 1:
            raise InputError(
                f"moving, rigid, flexible and parallax each go from a least to a most, from 0 up, "
                f"and moving is a share of the picture; got {self}"
            )
        if self.frames < 1 or self.rate <= 0 or not 0 <= self.feet <= 1:
            raise InputError(
                f"a sequence has >= 1 frames, a rate > 0 and a share of feet from 0 to 1, "
                f"got {self}"
            )
        if not 0 <= self.shutter <= 1:
            raise InputError(f"a shutter is open for a share from 0 to 1, got {self.shutter:g}")
        if self.focal is not None and self.focal <= 0:
            raise InputError(f"a focal length is more than 0 pixels, got {self.focal:g}")

    def time(self, frame: int) -> float:
        """Return when a frame is taken, seconds after the first."""
        return frame / self.rate

    def cast(self, rng: Generator, number: int) -> list[tuple[bool, Footing]]:
        """Return of each mover whether it bends, and its footing.

        Args:
            rng: Draws how many there are.
            number: Of the sequence. The share `feet`, and the halves of the rest, are kept to
                within one mover over any row of numbers in which all sequences have the same
                number of movers.
        """
        counts = [int(rng.integers(low, high + 1)) for low, high in (self.rigid, self.flexible)]
        if sum(counts) == 0 and self.flexible[1] + self.rigid[1] > 0:
            counts = [min(1, self.rigid[1]), min(1, self.flexible[1])]
        bends = [False] * counts[0] + [True] * counts[1]
        first = number * len(bends)
        return [(bent, self._footing(first + k)) for k, bent in enumerate(bends)]

    def _footing(self, mover: int) -> Footing:
        """Return the footing of a mover of an endless row."""
        seen_before, seen = floor(mover * self.feet), floor((mover + 1) * self.feet)
        if seen > seen_before:
            return Footing.SEEN
        # Hidden, air, air, hidden and again, since every second mover bends.
        return Footing.NONE if (mover - seen_before + 1) // 2 % 2 else Footing.HIDDEN
