"""Optical flow with what is known of its errors.

The flow at a pixel of the key frame is where its point lies in the target frame minus where it
lies in the key frame: right and down, in pixels. It is the same number whether pixel centres lie
at integers or, as in this project, at half integers.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError

Flow = NDArray[np.float32]
"""Height x width x 2; NaN is unknown."""

_WINDOW = 9
_RELATIVE, _ABSOLUTE = 0.01, 0.5

_ENOUGH = 0.1
_ALIKE = 0.85
# Of unrelated frames dense inverse search finds a place for up to a third of the pixels of small
# ones, but their grays then correlate by .64 to .76; those of pairs of KITTI, Sintel and 7-Scenes
# by .96 or more.


@dataclass(frozen=True, eq=False)
class FlowField:
    """Where the pixels of the key frame have gone in the target.

    Attributes:
        flow: Pixels; NaN is unknown.
        valid: Where it is known and, if both ways were matched, the ways agree.
        noise: The standard deviation of each component, pixels; height x width; NaN where the
            flow is not valid.
    """

    flow: Flow
    valid: NDArray[np.bool_]
    noise: NDArray[np.float32]

    @property
    def coverage(self) -> float:
        """The share of pixels that are valid."""
        return float(self.valid.mean())


def given(flow: Flow, size: tuple[int, int], noise: float) -> FlowField:
    """Return flow that somebody else has made: a file, another method.

    Args:
        flow: Pixels; NaN is unknown.
        size: Width and height of the frames that it belongs to.
        noise: Its standard deviation in pixels, which nothing in it tells.

    Raises:
        InputError: It is of another size, knows nothing, or its noise is no number above 0.
    """
    width, height = size
    if flow.shape != (height, width, 2):
        raise InputError(
            f"flow of {width}x{height} pixels with 2 components is wanted, as its frames are; got "
            f"an array of {'x'.join(map(str, flow.shape))} (height first); take the flow of these"
        )
    if not 0 < noise < np.inf:
        raise InputError(f"the flow's noise is wanted in pixels, above 0, got {noise:g}")
    valid = np.asarray(np.isfinite(flow).all(axis=-1))
    if not valid.any():
        raise InputError(
            "the flow is NaN or infinite at every pixel; take one that knows something"
        )
    return _field(flow, valid, np.full(valid.shape, noise, np.float32))


def checked(forward: Flow, backward: Flow, understatement: float, floor: float) -> FlowField:
    """Return the forward flow, valid where the way back leads home.

    With b the way back, taken at x + f(x), and e = f + b, a pixel is valid where
    |e|² < 0.01 (|f|² + |b|²) + 0.5 px²; what is hidden in the target, or left it, is not. If both
    flows erred by σ in each component, each by itself, |e|² would be 4 σ² on average; what they
    have in common cancels in e. So

        noise = floor + understatement · √(mean |e|² / 4)

    with the mean over the valid pixels of 9 x 9.

    Args:
        forward: From key to target, finite.
        backward: From target to key, finite.
        understatement: How many times larger the method's error is than what e shows.
        floor: Pixels; the error where the ways agree entirely.

    References:
        Sundaram, Brox and Keutzer, ECCV 2010, eq. 5 (the check).
    """
    back = sampled(backward, forward)
    error = forward + back
    known = np.isfinite(back).all(axis=-1)
    allowed = _RELATIVE * ((forward**2).sum(-1) + (back**2).sum(-1)) + _ABSOLUTE
    square = (error**2).sum(-1)
    valid: NDArray[np.bool_] = known & (square < allowed)
    window = (_WINDOW, _WINDOW)
    share = cv2.blur(valid.astype(np.float64), window)
    mean = cv2.blur(np.where(valid, square, 0.0), window) / np.where(valid, share, 1.0)
    noise = floor + understatement * np.sqrt(np.maximum(mean, 0.0) / 4)
    return _field(forward, valid, noise.astype(np.float32))


def _field(flow: Flow, valid: NDArray[np.bool_], noise: NDArray[np.float32]) -> FlowField:
    return FlowField(flow, valid, np.where(valid, noise, np.float32(np.nan)).astype(np.float32))


def sampled(values: NDArray[np.float32], shift: Flow) -> NDArray[np.float32]:
    """Return the values at each pixel plus its shift, bilinearly; NaN beyond the picture's edges.

    (OpenCV's constant border of NaN would spoil the last row and column too, by 0 · NaN.)
    """
    height, width = shift.shape[:2]
    row, column = np.mgrid[:height, :width].astype(np.float32)
    across, down = column + shift[..., 0], row + shift[..., 1]
    moved = cv2.remap(values, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    inside = (np.abs(across - (width - 1) / 2) <= width / 2) & (
        np.abs(down - (height - 1) / 2) <= height / 2
    )
    channels = moved.reshape(height, width, -1)
    return np.where(inside[..., None], channels, np.float32(np.nan)).astype(np.float32)


def likeness(key: NDArray[np.uint8], target: NDArray[np.uint8], field: FlowField) -> float:
    """Return how the grays of the valid pixels correlate with those where they have gone.

    1 is alike; NaN where nothing that is valid has texture, or stays in the picture.

    Args:
        key: Gray.
        target: Gray.
        field: From key to target.
    """
    there = sampled(target.astype(np.float32)[..., None], field.flow)[..., 0]
    seen = field.valid & np.isfinite(there)
    if not seen.any():
        return float("nan")
    with np.errstate(invalid="ignore", divide="ignore"):
        return float(np.corrcoef(key[seen], there[seen])[0, 1])


def without_cut(key: NDArray[np.uint8], target: NDArray[np.uint8], found: FlowField) -> FlowField:
    """Return the flow as it is, where it does not look as if there were a cut between the frames.

    Args:
        key: Gray.
        target: Gray.
        found: From key to target, by whatever method that matches both ways.

    Raises:
        InputError: Hardly anything is found again, or what is looks different.
    """
    if found.coverage < _ENOUGH:
        raise InputError(
            f"only {found.coverage:.0%} of the key frame is found again in the target and "
            f"back, {_ENOUGH:.0%} are wanted; is there a cut between them? take frames that "
            "see the same scene, closer in time"
        )
    alike = likeness(key, target, found)
    if not alike >= _ALIKE:  # NaN where nothing that is matched has texture.
        raise InputError(
            f"what is matched looks different in the two frames: its grays correlate by "
            f"{alike:.2f}, {_ALIKE} is wanted; is there a cut between them? take frames "
            "that see the same scene"
        )
    return found
