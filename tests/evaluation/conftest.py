from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest

from flexdepth.data.folder import Pair
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space


@dataclass(frozen=True)
class Shelf:
    """A set, or predictions, in memory."""

    items: tuple
    about: dict = field(default_factory=dict)

    def __len__(self):
        return len(self.items)

    def __getitem__(self, index):
        return self.items[index]

    def of(self, pair, number, view):  # noqa: ARG002
        return self.items[number]


def depth_map(values, space=Space.METRIC, camera=None):
    return DepthMap(np.array(values, np.float32), space, camera)


@pytest.fixture(scope="session")
def pair() -> Callable[..., Pair]:
    """Return a function that makes an image with measured depth; 0 is unknown."""

    def make(name, truth, space=Space.METRIC):
        values = np.array(truth, np.float32)
        height, width = values.shape
        camera = Intrinsics.centred(width, height, width, FocalSource.GIVEN)
        image = np.full((height, width, 3), 128, np.uint8)
        return Pair(name, image, depth_map(np.where(values > 0, values, np.nan), space, camera))

    return make


@pytest.fixture(scope="session")
def shelf() -> Callable[..., Shelf]:
    """Return a function that puts things in order."""
    return lambda *items: Shelf(items)


@pytest.fixture(scope="session")
def metric() -> Callable[..., DepthMap]:
    """Return a function that makes a prediction."""
    return depth_map
