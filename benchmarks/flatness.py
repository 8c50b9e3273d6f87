"""How flat depth is where the truth is a plane, and whether it leans as the truth does.

A plane in space is affine in inverse depth, 1/z = a x + b y + c over the pixels of a pinhole
camera, whatever the one factor of the map. So a picture is cut into windows, and one counts where
all of its true inverse depth lies within `PLANAR` of its least-squares plane.

References:
    The planarity errors of Koch et al., Evaluation of CNN-based single-image depth estimation
    methods, ECCV workshops 2018 (iBims-1), ask the like in space, of planes marked by hand.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

WINDOW = 32
"""Width and height of a window, in pixels; windows lie side by side."""

PLANAR = 1e-3
"""By which share of its inverse depth a true pixel may be off the plane."""

Reals = NDArray[np.float64]


def _basis() -> Reals:
    """Return level, to the right and down over the pixels of a window, their mean squares 1."""
    along = np.arange(WINDOW) - (WINDOW - 1) / 2
    along /= np.sqrt((along**2).mean())
    return np.stack([np.ones(WINDOW**2), np.tile(along, WINDOW), np.repeat(along, WINDOW)])


@dataclass(frozen=True)
class Flatness:
    """Medians over the planar windows of one image, as shares of depth.

    Attributes:
        windows: How many there are.
        bent: Root mean square of predicted inverse depth off its own least-squares plane, by its
            mean.
        tilted: Root mean square of that plane less the true one, each divided by its mean.
        level: What `tilted` is for a prediction that is as far everywhere.
    """

    windows: int
    bent: float
    tilted: float
    level: float


def flatness(depth: Reals, truth: Reals, valid: NDArray[np.bool_]) -> Flatness | None:
    """Return how flat a prediction is where the truth is a plane; None where that is nowhere.

    Args:
        depth: Predicted, up to a factor; +inf in its sky. A window that it takes for sky alone is
            bent and tilted by 1.
        truth: Measured.
        valid: Where the truth is known.
    """
    true = _windows(1 / np.where(valid, truth, np.inf))
    known = true[(true > 0).all(1)]
    planar = (np.abs(_off_plane(known)) <= PLANAR * known).all(1)
    if not planar.any():
        return None
    seen = _windows(1 / depth)[(true > 0).all(1)][planar]
    slope, true_slope = _slope(seen), _slope(known[planar])
    is_sky = ~seen.any(1)
    mean = np.where(is_sky, 1.0, seen.mean(1))
    bent = np.sqrt((_off_plane(seen) ** 2).mean(1)) / mean
    tilted = np.linalg.norm(slope - true_slope, axis=1)
    return Flatness(
        int(planar.sum()),
        float(np.median(np.where(is_sky, 1.0, bent))),
        float(np.median(np.where(is_sky, 1.0, tilted))),
        float(np.median(np.linalg.norm(true_slope, axis=1))),
    )


def mean_over_images(found: Sequence[Flatness]) -> Mapping[str, float]:
    """Return the mean of each figure, each image counting the same, and how much is behind it."""
    figures = ("bent", "tilted", "level")
    means = {name: float(np.mean([getattr(each, name) for each in found])) for name in figures}
    return {"images": len(found), "windows": sum(each.windows for each in found), **means}


def _windows(values: Reals) -> Reals:
    """Return the whole windows of a map, the pixels of each in a row."""
    rows, columns = (length // WINDOW for length in values.shape)
    cut = values[: rows * WINDOW, : columns * WINDOW]
    return cut.reshape(rows, WINDOW, columns, WINDOW).swapaxes(1, 2).reshape(-1, WINDOW**2)


def _plane(windows: Reals) -> Reals:
    """Return the least-squares plane of each window on `_basis`."""
    return windows @ _basis().T / WINDOW**2


def _off_plane(windows: Reals) -> Reals:
    return windows - _plane(windows) @ _basis()


def _slope(windows: Reals) -> Reals:
    """Return by which share each window's plane rises to the right and down, in mean squares."""
    level, *rises = _plane(windows).T
    return np.stack(rises, 1) / np.where(level > 0, level, 1.0)[:, None]
