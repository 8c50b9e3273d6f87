from collections.abc import Callable

import numpy as np
import pytest

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.solvers.correspondences import Correspondences

CAMERA = Intrinsics(500.0, 520.0, 320.0, 240.0, FocalSource.GIVEN)


@pytest.fixture
def camera() -> Intrinsics:
    """A camera of 640 x 480 pixels, whose pixels are not quite square."""
    return CAMERA


def turn(axis: str, radians: float) -> np.ndarray:
    """Return the rotation about one axis, written out."""
    c, s = np.cos(radians), np.sin(radians)
    return np.array(
        {
            "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
            "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
            "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
        }[axis]
    )


@pytest.fixture
def rotation() -> np.ndarray:
    """A turn about all three axes, 3 degrees in all."""
    return turn("x", 0.02) @ turn("y", -0.05) @ turn("z", 0.01)


@pytest.fixture
def see() -> Callable[..., Correspondences]:
    """Return a function that shows points to a camera before and after it moves.

    Points are 3 to 15 away, or in a plane nᵀX = 1 of the given normal; `movers` of them have moved
    by themselves, each its own way. What is said of the noise is true, 1e-4 pixels where there is
    none.
    """

    def look(
        rotation,
        translation=(0.0, 0.0, 0.0),
        *,
        count=1000,
        noise=0.0,
        movers=0.0,
        plane=None,
        seed=0,
    ) -> Correspondences:
        random = np.random.default_rng(seed)
        focal, centre = np.array([500.0, 520.0]), np.array([320.0, 240.0])
        key = random.uniform((0, 0), (640, 480), (count, 2))
        rays = np.column_stack([(key - centre) / focal, np.ones(count)])
        depth = random.uniform(3, 15, count) if plane is None else 1 / (rays @ plane)
        there = (rays * depth[:, None]) @ rotation.T + translation
        moving = random.random(count) < movers
        there[moving] += random.normal((0.5, -0.4, 0), 0.5, (moving.sum(), 3))
        target = there[:, :2] / there[:, 2:] * focal + centre
        target += random.normal(0, 1, target.shape) * noise
        return Correspondences(key, target, np.full(count, max(noise, 1e-4)), CAMERA)

    return look
