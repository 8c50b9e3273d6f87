"""The right picture of a rectified stereo camera, and whether it is one."""

import numpy as np

from flexdepth.flow.field import FlowField
from flexdepth.runtime.errors import InputError
from flexdepth.solvers.two_frame import Stereo

_CLEAR = 2.0
"""Standard deviations by which a disparity tells left from right."""

_ENOUGH = 100
"""Pixels that have to tell."""

_SKEW = 1.5
"""Pixels: rectified pictures show things on the same row, to within less than this."""


def right_view(flow: FlowField, baseline: float, name: str) -> tuple[Stereo, tuple[str, ...]]:
    """Return the right picture as the solver takes it, and what is odd about it.

    Args:
        flow: From the key frame to it.
        baseline: Metres between the two cameras.
        name: Of the picture, for messages.

    Raises:
        InputError: Things lie farther right in it, so it is the left camera's.
    """
    across, down = flow.flow[..., 0], flow.flow[..., 1]
    tell = flow.valid & (np.abs(across) > _CLEAR * np.nan_to_num(flow.noise, nan=np.inf))
    if tell.sum() >= _ENOUGH and np.median(across[tell]) > 0:
        raise InputError(
            f"{name}: things lie farther right in it than in the key frame, as in the left "
            "camera's picture; --stereo takes the right camera's, and KEY is the left one's"
        )
    skew = float(np.median(np.abs(down[flow.valid])))
    notes: tuple[str, ...] = ()
    if skew > _SKEW:
        notes = (
            f"{name}: things lie {skew:.1f} px higher or lower in it than in the key frame; stereo "
            "pictures are wanted rectified, and depth in metres is off where they are not",
        )
    return Stereo(flow.flow, flow.noise, baseline), notes
