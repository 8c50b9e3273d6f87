"""How good a network is on pairs it was not trained on."""

from collections.abc import Sequence

import numpy as np
import torch
from torch import nn

from flexdepth.evaluation.alignment import Alignment, aligned
from flexdepth.evaluation.metrics import abs_rel
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.sample import Sample, measured
from flexdepth.training.batches import Pairs, whole

CAP = 80.0
"""Metres; farther truth is not scored, and no fitted depth is farther."""


@torch.no_grad()
def validate(network: nn.Module, pairs: Pairs, batch: int = 8) -> float:
    """Return the mean over images of AbsRel, disparity fitted by least squares.

    Up to that fit the number does not depend on what a picture cannot tell: scale and focal
    length. The network is left in evaluation mode.
    """
    network.eval()
    scores: list[float] = []
    for first in range(0, len(pairs), batch):
        sample = whole(pairs, range(first, min(first + batch, len(pairs))))
        scores += _scores(network, sample)
    return float(np.mean(scores))


def _scores(network: nn.Module, sample: Sample) -> Sequence[float]:
    truth = measured(sample, "validate")
    predicted = network(sample.key.image).depth.numpy()
    scores = []
    for depth, true, valid in zip(predicted, truth.depth.numpy(), truth.valid.numpy(), strict=True):
        scored = valid & (true < CAP)
        if scored.any():
            guess = DepthMap(depth, Space.SCALE)
            fitted = aligned(guess, Alignment.LEAST_SQUARES_DISPARITY, true, scored, CAP)
            scores.append(abs_rel(fitted, true, scored))
    return scores
