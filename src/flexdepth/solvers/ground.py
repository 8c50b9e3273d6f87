"""The ground: the plane that most of the lower half of the static world lies in."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.least_squares import weights

Array = NDArray[np.float64]

_DRAWS = 120
_POINTS = 2000
_NEAR = 0.03
"""Relative inverse depth within which a pixel lies in the plane."""

_UPRIGHT, _LEANS = 0.6, 0.5
"""A ground's normal has at least this part along the picture's height, and no more to the side."""

_SHARE, _GATHERED = 0.25, 0.15
"""The share of the pixels below the middle that a ground has at least: any, and one at whose very
plane they gather."""


@dataclass(frozen=True, eq=False)
class Ground:
    """A plane g·x = ρ, with x = K⁻¹ (u, v, 1).

    Attributes:
        plane: g.
        share: How many of the static pixels of the lower half lie in it.
    """

    plane: Array
    share: float

    @property
    def normal(self) -> Array:
        """The plane's unit normal in the key camera, away from it: down."""
        return np.asarray(self.plane / np.linalg.norm(self.plane))


def ground(key: Array, inverse_depth: Array, static: NDArray[np.bool_]) -> Ground | None:
    """Return the ground, or None where no plane fills a quarter of the frame's lower half.

    A seventh is enough where more than half of what is near the plane is in the middle third of
    that: what is no plane spreads over all of it.

    Args:
        key: Rays, height x width x 3.
        inverse_depth: Height x width.
        static: Where it is known of what is still.
    """
    lower = static.copy()
    lower[: len(static) // 2] = False
    rays, inverse = key[lower], inverse_depth[lower]
    if len(rays) < 50:
        return None
    some = np.linspace(0, len(rays) - 1, min(len(rays), _POINTS)).astype(int)
    rays, inverse = rays[some], inverse[some]
    random = np.random.default_rng(0)
    drawn = random.integers(0, len(rays), (_DRAWS, 3))
    corners = rays[drawn]
    sound = np.abs(np.linalg.det(corners)) > 1e-6
    planes = np.linalg.solve(corners[sound], inverse[drawn[sound]][..., None])[..., 0]
    normals = planes / np.linalg.norm(planes, axis=1, keepdims=True)
    planes = planes[(normals[:, 1] > _UPRIGHT) & (np.abs(normals[:, 0]) < _LEANS)]
    if not len(planes):
        return None
    near = np.abs(rays @ planes.T / inverse[:, None] - 1) < _NEAR
    plane = planes[np.argmax(near.sum(axis=0))]
    for _ in range(5):
        left = rays @ plane / inverse - 1
        weight = weights(left**2, _NEAR / 2)
        relative = rays / inverse[:, None]
        normal = (relative * weight[:, None]).T @ relative
        plane = np.linalg.solve(normal + 1e-12 * np.eye(3), relative.T @ weight)
    off = np.abs(rays @ plane / inverse - 1)
    share = float((off < _NEAR).mean())
    gathers = (off < _NEAR / 3).mean() > share / 2
    large = share >= (_GATHERED if gathers else _SHARE)
    return Ground(plane, share) if large and plane[1] > 0 else None
