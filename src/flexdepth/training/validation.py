"""How good a network is on pairs it was not trained on."""

from collections.abc import Mapping
from math import fsum, sqrt

import numpy as np
import torch
from torch import nn
from torch.nn.functional import pad

from flexdepth.data.folder import Pair
from flexdepth.data.transforms import as_sample, resized
from flexdepth.evaluation.alignment import Alignment, aligned
from flexdepth.evaluation.metrics import METRICS, scored
from flexdepth.runtime.colour import Pixels, limits
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.picture import panels, preview
from flexdepth.sample import in_metres
from flexdepth.tensors import stacked
from flexdepth.training.batches import Pairs
from flexdepth.training.processes import ALONE, Place

CAP = 80.0
"""Metres; farther truth is not scored, and no fitted depth is farther."""

LARGEST = 1024 * 512
"""Pixels; images of more are brought down to it."""

MULTIPLE = 32
"""Images are continued by their last pixels to sides that this divides, as some networks need."""

SCORES = ("abs_rel", "sq_rel", "log10", "rmse", "rmse_log", "delta1", "delta2", "delta3")
"""The metrics of chapter 3 (`evaluation.metrics`); a run is judged by the first."""

SHOWN = 3
"""Held-out images of which pictures are made."""


@torch.no_grad()
def validate(
    network: nn.Module, pairs: Pairs, alignment: Alignment, place: Place = ALONE
) -> Mapping[str, float]:
    """Return the mean of each of `SCORES` over the images in which any depth is known.

    Images may be of any sizes, and are predicted whole. The network is left in evaluation mode.

    Args:
        network: Gives metres, or what the alignment makes metres of.
        pairs: To be judged on; each process judges by its share.
        alignment: How depth is fitted to the truth of its image before it is scored.
        place: Where the network is.

    Raises:
        InputError: No image has any depth to be judged by.
    """
    network.eval()
    own = range(place.rank, len(pairs), place.count)
    scores = [_scores(network, _within(pairs[number]), alignment, place) for number in own]
    known = [score for score in scores if score is not None]
    sums = [fsum(score[name] for score in known) for name in SCORES]
    *totals, count = place.summed([*sums, float(len(known))])
    if not count:
        raise InputError(
            f"none of the {len(pairs)} held-out images has known depth nearer than {CAP:g} m: "
            f"there is nothing to judge the network by; name other held-out data"
        )
    return {name: total / count for name, total in zip(SCORES, totals, strict=True)}


@torch.no_grad()
def pictures(network: nn.Module, pairs: Pairs, place: Place = ALONE) -> Mapping[str, Pixels]:
    """Return, by name, a few images beside their truth and what the network makes of them.

    Both depths have the colours of the truth. The network is left in evaluation mode.
    """
    network.eval()
    count = min(SHOWN, len(pairs))
    chosen = [_within(pairs[number * len(pairs) // count]) for number in range(count)]
    return {pair.name: _picture(pair, _predicted(network, pair, place)) for pair in chosen}


def _picture(pair: Pair, predicted: DepthMap) -> Pixels:
    ends = limits(pair.truth)
    shown = None if ends.empty else ends
    sides = [pair.image, preview(pair.truth, shown), preview(predicted, shown)]
    return panels(sides, ["image", "truth", "prediction"])


def _within(pair: Pair) -> Pair:
    """Return the pair at no more than `LARGEST` pixels."""
    rows, columns = pair.truth.values.shape
    ratio = sqrt(LARGEST / (rows * columns))
    return pair if ratio >= 1 else resized(pair, int(ratio * columns), int(ratio * rows))


def _scores(
    network: nn.Module, pair: Pair, alignment: Alignment, place: Place
) -> Mapping[str, float] | None:
    """Return the scores of one image; None where nothing is known of its depth."""
    true = pair.truth.values
    judged = pair.truth.valid & (true > 0) & (true < CAP)
    if not judged.any():
        return None
    fitted = aligned(_predicted(network, pair, place), alignment, true, judged, CAP)
    seen = scored(fitted, true, judged)
    return {name: METRICS[name].of(METRICS[name].means(seen), seen.truth.size) for name in SCORES}


def _predicted(network: nn.Module, pair: Pair, place: Place) -> DepthMap:
    """Return what the network says of an image, in metres."""
    sample = stacked([as_sample(pair)])
    rows, columns = pair.truth.values.shape
    below, right = -rows % MULTIPLE, -columns % MULTIPLE
    image = pad(sample.key.image.to(place.device), (0, right, 0, below), mode="replicate")
    prediction = network(image)
    depth = prediction.depth.cpu()[..., :rows, :columns]
    metres = in_metres(depth, prediction, sample)[0].numpy()
    return DepthMap(np.ascontiguousarray(metres), Space.METRIC, pair.truth.intrinsics)
