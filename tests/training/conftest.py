import numpy as np
import pytest

from flexdepth.data.folder import Pair
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space


def pair(number, width=64, height=48):
    rng = np.random.default_rng(number)
    camera = Intrinsics.centred(width, height, 0.7 * 80, FocalSource.GIVEN)
    depth = np.linspace(1, 4, width, dtype=np.float32) * np.ones((height, 1), np.float32)
    shade = np.broadcast_to((60 * depth)[..., None], (height, width, 3))
    image = np.clip(shade + rng.normal(0, 5, shade.shape), 0, 255).astype(np.uint8)
    return Pair(str(number), image, DepthMap(depth * (1 + number), Space.METRIC, camera))


@pytest.fixture
def pairs():
    return [pair(number) for number in range(5)]
