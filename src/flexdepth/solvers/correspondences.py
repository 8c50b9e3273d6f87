"""Points of the key frame and where they are in the target, with their noise and their camera."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError

Array = NDArray[np.float64]

_CERTAIN = 0.8
"""The share of pixels with valid flow that tell how the camera has moved, those of least noise."""

_PARTS = 4
"""Across and down: in each part of the frame that share is taken by itself, lest all that is
certain lies on one thing that moves, before a wall without texture."""

FEWEST = 16
"""Twice what a homography needs: below it no choice between models means anything."""


@dataclass(frozen=True, eq=False)
class Correspondences:
    """n points in two frames of one camera.

    Attributes:
        key: n x 2, pixels.
        target: Likewise.
        noise: n standard deviations of each component of target - key, pixels.
        camera: Of both frames.
    """

    key: Array
    target: Array
    noise: Array
    camera: Intrinsics

    def __post_init__(self) -> None:
        """Refuse what no motion can be found from."""
        if len(self.noise) < FEWEST:
            raise InputError(
                f"the camera's motion needs at least {FEWEST} points that are seen in both frames, "
                f"got {len(self.noise)}; take frames that show more, or that are closer in time"
            )
        if not (np.isfinite(self.key).all() and np.isfinite(self.target).all()):
            raise InputError("points seen in both frames must be finite; leave out unknown flow")
        if not (np.isfinite(self.noise) & (self.noise > 0)).all():
            raise InputError("the noise of matched points must be finite and above 0 pixels")

    def __len__(self) -> int:
        """Return how many points there are."""
        return len(self.noise)

    @property
    def focal(self) -> Array:
        """The focal length across and down, pixels."""
        return np.array([self.camera.focal_x, self.camera.focal_y])

    def rays(self) -> tuple[Array, Array]:
        """Return the rays through the points in key and target: n x 3, z = 1."""
        return rays(self.key, self.camera), rays(self.target, self.camera)


def rays(pixels: Array, camera: Intrinsics) -> Array:
    """Return K⁻¹ (u, v, 1): ... x 3."""
    centre = np.array([camera.centre_x, camera.centre_y])
    across = (pixels - centre) / np.array([camera.focal_x, camera.focal_y])
    return np.concatenate([across, np.ones_like(across[..., :1])], axis=-1)


def pixel_centres(height: int, width: int) -> Array:
    """Return where the pixels are: height x width x 2, the first at (0.5, 0.5)."""
    row, column = np.mgrid[:height, :width] + 0.5
    return np.stack([column, row], axis=-1)


def from_flow(
    flow: NDArray[np.float32],
    valid: NDArray[np.bool_],
    noise: NDArray[np.float32],
    camera: Intrinsics,
    most: int = 5_000,
) -> Correspondences:
    """Return the more certain of each part's valid pixels, on a regular grid, about `most` at most.

    The errors of neighbours in dense flow are alike, so that more of them add little. The noisiest
    add nothing: there estimated flow is what smoothness has made of it, wrong alike over whole
    surfaces. Where all noise is the same, no pixel is left out.

    Args:
        flow: Height x width x 2, pixels; anything where it is not valid.
        valid: Height x width.
        noise: Standard deviation of each component, pixels.
        camera: Of both frames, in their pixels.
        most: How many pixels are wanted.

    Raises:
        InputError: Too few pixels are valid, or a valid one is not finite or without noise.
    """
    certain = _certain(valid, noise)
    stride = max(1, round(float(np.sqrt(certain.sum() / most))))
    grid = slice(stride // 2, None, stride), slice(stride // 2, None, stride)
    at = certain[grid]
    key = pixel_centres(*valid.shape)[grid][at]
    shift = flow[grid][at].astype(np.float64)
    return Correspondences(key, key + shift, noise[grid][at].astype(np.float64), camera)


def _certain(valid: NDArray[np.bool_], noise: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return the pixels of least noise, the same share of what is valid in each part."""
    certain = np.zeros_like(valid)
    rows, columns = (np.linspace(0, length, _PARTS + 1).astype(int) for length in valid.shape)
    for top, bottom in pairwise(rows):
        for left, right in pairwise(columns):
            part = slice(top, bottom), slice(left, right)
            seen = valid[part]
            if seen.any():
                certain[part] = seen & (noise[part] <= np.quantile(noise[part][seen], _CERTAIN))
    return certain
