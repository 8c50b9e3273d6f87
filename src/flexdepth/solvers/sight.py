"""What the solver's parts look at, and what a region is taken to be before anything is known."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.region_motion import Pixels

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_STEEP = 0.5
"""The level share of the squared ray to a thing, below which it is seen from above."""

_PROFILE = (0.5, 2.0)
"""The least and the most of an upright thing's inverse depth, in that of its middle."""


@dataclass(frozen=True, eq=False)
class Sight:
    """What the solver's parts look at; maps of the key frame's size.

    Attributes:
        key: Rays x 3, z = 1.
        target: Rays to where the flow leads.
        flow: x 2, pixels, 0 where unknown.
        noise: Pixels; 1 where the flow is not to be trusted.
        trusted: Where it is.
        focal: Across and down, pixels.
        down: The ground's unit normal in the key camera; None where no ground is seen.
    """

    key: Array
    target: Array
    flow: Array
    noise: Array
    trusted: Mask
    focal: Array
    down: Array | None = None

    def pixels(self, inside: Mask) -> Pixels:
        """Return the trusted pixels of a region."""
        at = inside & self.trusted
        key = self.key[at]
        profile = upright(key, self.down)
        return Pixels(key, self.target[at], self.noise[at], self.focal, profile)


def upright(key: Array, down: Array | None) -> Array:
    """Return the inverse depth of a flat thing that stands upright and faces the camera; mean 1.

    The plane m·X = c has ρ = m·x / c, and m is where the thing is seen, made level. What is seen
    from steeply above shows its upper side as well: there the thing is taken to be equally deep.

    Args:
        key: Rays to the thing, n x 3.
        down: The ground's unit normal; None where no ground is seen.
    """
    if down is None or not len(key):
        return np.ones(len(key))
    middle = key.mean(axis=0)
    level = middle - (middle @ down) * down
    if level @ level < _STEEP * (middle @ middle):
        return np.ones(len(key))
    return np.asarray(np.clip(key @ level / (middle @ level), *_PROFILE))
