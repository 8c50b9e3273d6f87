import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from flexdepth.data.folder import Pair
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.sample import Prediction


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


class OneConvolution(nn.Module):
    """An encoder, a normalisation and a decoder, none of which sees more than one pixel."""

    def __init__(self):
        super().__init__()
        self.encoder = nn.Conv2d(3, 3, 1)
        self.norm = nn.BatchNorm2d(3)
        self.decoder = nn.Conv2d(3, 1, 1)

    def forward(self, image):
        features = self.norm(self.encoder(image))
        return Prediction(self.decoder(features)[:, 0].exp(), canonical_focal=0.8)


@pytest.fixture
def network():
    torch.manual_seed(0)
    return OneConvolution()


@pytest.fixture(scope="session")
def forked(tmp_path_factory):
    """What forked.py has left in its folder, and how many of its processes were killed.

    Of a network without normalisation `1-0.safetensors`, trained alone, and `2-0` and `2-1`,
    trained by two processes, as are `still-2-0` and `still-2-1`, which learn nothing and end as
    soon as they see it; of an experiment the folders `straight`, `files` and `random`: not
    killed, killed before and after each of the first files it writes, and at random moments;
    `spoken` is that of two processes, and `said-0.txt` and `said-1.txt` are what they said.
    """
    if sys.platform == "win32":
        pytest.skip("processes cannot be forked")
    folder = tmp_path_factory.mktemp("forked")
    script = Path(__file__).with_name("forked.py")
    quiet = {**os.environ, "OMP_NUM_THREADS": "1", "CUDA_VISIBLE_DEVICES": ""}
    done = subprocess.run(
        [sys.executable, script, folder], check=True, env=quiet, timeout=900, capture_output=True
    )
    return folder, json.loads(done.stdout)
