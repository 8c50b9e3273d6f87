"""A small network of the compact kind learns four images by heart, in metres."""

import numpy as np
import torch

from flexdepth.data.colour import Colour
from flexdepth.data.folder import Pair
from flexdepth.data.transforms import Crop
from flexdepth.evaluation.alignment import Alignment
from flexdepth.losses import GradientMatching, Silog
from flexdepth.networks.compact import Compact
from flexdepth.networks.encoders import Encoder
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.training.batches import BatchSettings
from flexdepth.training.loop import LoopSettings, Run, Sources, train
from flexdepth.training.objective import Term
from flexdepth.training.optimiser import AdamWCosine
from flexdepth.training.record import Silence

SIZE, FOG = 64, 8.0
WALLS = ((250, 60, 60), (60, 250, 60), (60, 60, 250), (220, 220, 40))
NETWORK = Compact(encoder=Encoder("test_efficientnet"), widths=(32, 24, 16, 16))
SETTINGS = LoopSettings(
    iterations=240,
    save_every=240,
    average_decay=0.95,
    batches=BatchSettings(
        size=4, shapes=((SIZE, SIZE),), crop=Crop(smallest=1.0, stretch=1.0), colour=Colour(0.0)
    ),
    optimiser=AdamWCosine(rate=0.015, encoder_share=1.0, weight_decay=0.0, warm_up=10),
    alignment=Alignment.NONE,
)
TERMS = {"silog": Term(Silog(0.5)), "gradient": Term(GradientMatching(), 0.5)}


def corridor(number):
    """A slanting wall 3, 5, 7 or 9 m away, the ground 1 m below and a wall 1.5 m beside, in fog."""
    rng = np.random.default_rng(number)
    camera = Intrinsics.centred(SIZE, SIZE, float(SIZE), FocalSource.GIVEN)
    steps = (np.arange(SIZE) + 0.5 - SIZE / 2) / SIZE
    across, down = np.meshgrid(steps, steps)
    planes = np.stack(
        [
            (3 + 2 * number) / (1 + rng.uniform(-0.5, 0.5) * across),
            1.0 / np.maximum(down, 1e-6),
            1.5 / np.maximum(rng.choice([-1, 1]) * across, 1e-6),
        ]
    )
    depth = planes.min(0)
    colours = np.array([WALLS[number], (200, 200, 200), (120, 160, 250)])
    light = colours[planes.argmin(0)] * np.exp(-depth / FOG)[..., None]
    image = np.clip(light + rng.normal(0, 2, light.shape), 0, 255).astype(np.uint8)
    return Pair(str(number), image, DepthMap(depth.astype(np.float32), Space.METRIC, camera))


def test_four_images_are_learnt_by_heart():
    pairs, scores = [corridor(number) for number in range(4)], []
    torch.manual_seed(0)
    network = NETWORK.build().to(memory_format=torch.channels_last)
    run, sources = Run.started(network, SETTINGS), Sources(pairs, pairs, 0)
    train(run, SETTINGS, TERMS, sources, Silence(), lambda _, score: scores.append(score))
    assert scores[-1] < 0.02
