"""What is minimised over two frames: flexdepth's own objective, a part of it, or chapter 5's."""

from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from flexdepth.flow.frames import gray_pair
from flexdepth.flow.matches import Akaze
from flexdepth.solvers.two_frame import Dense, Seen, TwoFrame, TwoFrameSettings, two_frame

Picture = NDArray[np.uint8]


class Objective(StrEnum):
    """How two frames are solved."""

    DENSE = "dense"
    """Regions, then depth and motion of every pixel together."""
    REGIONS = "regions"
    """Regions alone: faster, and rougher under noise."""
    DISSERTATION = "dissertation"
    """Chapter 5's eleven terms as written, by Adam: to be compared with; it does not find depth."""
    CORRECTED = "dissertation-corrected"
    """The same without its errata: it does not find depth either."""

    @property
    def is_the_dissertations(self) -> bool:
        """Whether it takes frames and flow alone: no prior, no third frame, no stereo."""
        return self in (Objective.DISSERTATION, Objective.CORRECTED)


def solved(objective: Objective, seen: Seen, key: Picture, target: Picture) -> TwoFrame:
    """Return depth and motion of every pixel by an objective.

    Args:
        objective: Which.
        seen: What the frames show.
        key: RGB.
        target: RGB.

    Raises:
        InputError: Too little is seen in both frames.
    """
    if objective.is_the_dissertations:
        return _dissertation(objective, seen, key, target)
    dense = Dense() if objective is Objective.DENSE else None
    return two_frame(seen, TwoFrameSettings(dense=dense))


def _dissertation(objective: Objective, seen: Seen, key: Picture, target: Picture) -> TwoFrame:
    # Only here, for the others do without torch, which takes seconds to load.
    from flexdepth.solvers.dissertation import Form  # noqa: PLC0415
    from flexdepth.solvers.first_order import Clues, FirstOrder, first_order  # noqa: PLC0415

    form = Form.AS_WRITTEN if objective is Objective.DISSERTATION else Form.CORRECTED
    matches = Akaze().between(key, target)
    clues = Clues(matches.key, matches.target, gray_pair(key, target))
    return first_order(seen, FirstOrder(form=form), clues)
