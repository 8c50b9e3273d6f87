"""Where the pixels of the key frame have gone: by a method, or from a file that says so."""

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np

from flexdepth.flow.field import Flow, FlowField, checked, given, likeness, without_cut
from flexdepth.flow.frames import Image, gray_pair
from flexdepth.flow.matches import Agreement
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.opening import open_input

FILE_NOISE = 0.1
"""Pixels: how far flow from a file is taken to err; rendered flow errs less, measured flow more."""

_ALIKE = 0.5
"""How the grays of matched pixels correlate at least; those of other frames' flow often do less."""

_MATCHES, _BORNE_OUT = 20, 0.5
# On KITTI 2015 000010 and MPI-Sintel alley_1, .97 and .95 of the matches agree with DIS, .95 and
# .91 with the true flow; .04 and .00 with that reversed, .37 and .30 with that of the other pair,
# whose grays yet correlate by .76 to .96. Two frames of KITTI odometry apart, .83 agree with DIS.


class FlowMethod(Protocol):
    """What finds correspondence: `flow.dis.Dis`, `RaftFlow`, `FlowFile`."""

    def between(self, key: Image, target: Image) -> FlowField:
        """Return the flow from key to target, two pictures of one size in RGB."""


_RAFT_FLOOR, _RAFT_UNDERSTATEMENT = 0.05, 2.0
# A network's two ways err alike, as those of the dense inverse search do, so the factor is the
# same; where they agree, what is left of its error on rendered pairs is some twentieth of a pixel.


@dataclass(frozen=True)
class RaftFlow:
    """A RAFT of torchvision, both ways.

    Attributes:
        weights: A .pth or .safetensors file that the user has; nothing is downloaded.
    """

    weights: Path

    def between(self, key: Image, target: Image) -> FlowField:
        """Return the flow from key to target.

        Args:
            key: RGB.
            target: RGB.

        Raises:
            InputError: The frames show nothing or have nothing in common; the weights are
                missing, or of another network.
        """
        open_input(self.weights).close()
        # Only here, for everything else does without torch, which takes seconds to load.
        from flexdepth.networks.flow import Raft  # noqa: PLC0415

        one, other = gray_pair(key, target)
        ways = Raft(self.weights).both_ways(key, target)
        return without_cut(one, other, checked(*ways, _RAFT_UNDERSTATEMENT, _RAFT_FLOOR))


@dataclass(frozen=True)
class FlowFile:
    """Flow that somebody else has computed, for the frames at the size that they have as files.

    Attributes:
        path: A .flo file (Middlebury), or a 16-bit PNG as KITTI has it.
        noise: Its standard deviation, pixels of that size.
        reduced: By how much the frames have been made smaller, across and down, 1 not at all.
    """

    path: Path
    noise: float = FILE_NOISE
    reduced: tuple[float, float] = (1.0, 1.0)

    def between(self, key: Image, target: Image) -> FlowField:
        """Return the flow that the file holds, as large as the frames are.

        Args:
            key: RGB.
            target: RGB.

        Raises:
            InputError: The file is missing, broken, no flow or flow of another size, says nothing,
                or leads to pixels that look different.
        """
        one, other = gray_pair(key, target)
        stored = _read(self.path)
        height, width = one.shape
        whole = round(width / self.reduced[0]), round(height / self.reduced[1])
        try:
            field = given(stored, whole, self.noise)
        except InputError as mistake:
            raise InputError(f"{self.path}: {mistake}") from mistake
        if whole != (width, height):
            field = _smaller(field, (width, height), self.noise)
        alike = likeness(one, other, field)
        if alike < _ALIKE:
            raise InputError(
                f"{self.path}: leads from what the key frame shows to what looks different in the "
                f"target, their grays correlate by {alike:.2f}, {_ALIKE} is wanted; is it the flow "
                "of these two frames, in this order?"
            )
        return field


def doubts(borne_out: Agreement) -> tuple[str, ...]:
    """Return the line that warns of flow which the matches contradict; none where few say so.

    Args:
        borne_out: Of the flow by matches that were found by other means, as AKAZE's are.
    """
    if borne_out.matches < _MATCHES or borne_out.share >= _BORNE_OUT:
        return ()
    return (
        f"only {borne_out.share:.0%} of {borne_out.matches} points that AKAZE matches have gone "
        "where the flow says: it may be that of other frames, and depth and motion hang on it",
    )


def _read(path: Path) -> Flow:
    # Only here, for the room of data sets needs packages that the light install lacks.
    if path.suffix.lower() == ".flo":
        from flexdepth.data.tagged_floats import read_flow  # noqa: PLC0415

        return read_flow(path)
    if path.suffix.lower() == ".png":
        from flexdepth.data.kitti_2015 import read_flow as read_png  # noqa: PLC0415

        return read_png(path)
    raise InputError(
        f"{path}: a flow file ends in .flo (Middlebury) or .png (KITTI, 16 bits, three channels)"
    )


def _smaller(field: FlowField, size: tuple[int, int], noise: float) -> FlowField:
    """Return flow for smaller frames: of the pixels that are known there, their mean."""
    height, width = field.valid.shape
    factors = np.array([size[0] / width, size[1] / height], np.float32)
    share = cv2.resize(field.valid.astype(np.float32), size, interpolation=cv2.INTER_AREA)
    known = np.where(field.valid[..., None], field.flow, np.float32(0))
    total = np.asarray(cv2.resize(known, size, interpolation=cv2.INTER_AREA))
    seen = share > 0.5
    mean = total / np.where(seen, share, 1)[..., None] * factors
    flow = np.where(seen[..., None], mean, np.float32(np.nan)).astype(np.float32)
    return given(flow, size, noise * float(factors.max()))
