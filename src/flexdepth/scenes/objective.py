"""What is minimised over two frames: flexdepth's own objective, or a part of it."""

from enum import StrEnum

from flexdepth.solvers.two_frame import Dense, Seen, TwoFrame, TwoFrameSettings, two_frame


class Objective(StrEnum):
    """How two frames are solved."""

    DENSE = "dense"
    """Regions, then depth and motion of every pixel together."""
    REGIONS = "regions"
    """Regions alone: faster, and rougher under noise."""


def solved(objective: Objective, seen: Seen) -> TwoFrame:
    """Return depth and motion of every pixel by an objective.

    Raises:
        InputError: Too little is seen in both frames.
    """
    dense = Dense() if objective is Objective.DENSE else None
    return two_frame(seen, TwoFrameSettings(dense=dense))
