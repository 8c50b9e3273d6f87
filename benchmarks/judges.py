"""What the variants of `choices.py` are judged on: rendered scenes, photos with known depth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
import torch
from samples import SETS, Readable, SampleSet, scored_pixels
from scores import Fit, Predict, fitted, looked_at
from torch import nn

from flexdepth.data.folder import Pair
from flexdepth.data.transforms import as_sample, resized
from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.boundary import boundary_f1, has_edge
from flexdepth.evaluation.metrics import abs_rel
from flexdepth.networks.compact import CompactNetwork
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.images import Photo
from flexdepth.runtime.lens import Said, intrinsics
from flexdepth.runtime.sizes import Area, network_size
from flexdepth.runtime.sizes import resized as at_size
from flexdepth.tensors import stacked
from flexdepth.training.batches import Pairs
from flexdepth.training.processes import Place
from flexdepth.training.validation import CAP, validate

CHOSEN_ON: Mapping[str, int] = MappingProxyType(
    {
        "7-Scenes": 9,
        "ICL-NUIM": 8,
        "KITTI laser": 1,
        "TUM": 1,
        "SUN RGB-D": 1,
        "NYU dining": 1,
        "ICL living": 1,
    }
)
"""The sets of photos that choices are made on, and of which frames: every so manyth."""

_MULTIPLE = 32
"""Of the width and the height of what a network sees."""


def looking(network: CompactNetwork, size: tuple[int, int], place: Place) -> Predict:
    """Return the way from a photo to depth: one look, of about so many pixels as `size` has.

    What the network calls sky is not asked.
    """
    wanted = Area(size, _MULTIPLE)

    @torch.no_grad()
    def predict(photo: Photo) -> DepthMap:
        height, width = photo.pixels.shape[:2]
        shown = at_size(photo.pixels, network_size(width, height, wanted))
        image = torch.from_numpy(shown).to(place.device).permute(2, 0, 1)[None] / 255
        depth = network.eval()(image).depth[0].float().cpu().numpy()
        camera = intrinsics(width, height, None, Said(photo.focal_in_diagonals))
        unit = camera.focal_by_area(width, height) / network.settings.canonical_focal
        metres = np.float32(unit) * np.exp(at_size(np.log(depth), (width, height)))
        return DepthMap(metres, Space.METRIC if camera.source.is_known else Space.SCALE, camera)

    return predict


def on_set(
    predict: Predict, sample_set: SampleSet, files: Sequence[Readable]
) -> Mapping[Fit, float]:
    """Return the mean AbsRel of photos, fitted in disparity and, with a known camera, as metres."""
    errors: dict[Fit, list[float]] = {}
    for seen in looked_at(files, {"": predict}):
        truth = np.nan_to_num(seen.pair.truth.values.astype(np.float64), nan=0.0, posinf=0.0)
        valid = scored_pixels(truth, sample_set.cap)
        if not valid.any():
            continue
        said = seen.maps[""]
        fits = (Fit.DISPARITY, Fit.METRES) if said.space is Space.METRIC else (Fit.DISPARITY,)
        for fit in fits:
            depth = fitted(said, fit, truth, valid, sample_set.cap)
            errors.setdefault(fit, []).append(abs_rel(depth, truth, valid))
    return {fit: float(np.mean(found)) for fit, found in errors.items()}


def on_photos(predict: Predict, samples: Path) -> Mapping[Fit, float]:
    """Return the mean over the sets of `on_set`.

    Raises:
        InputError: A set is missing.
    """
    found = [
        on_set(predict, each, each.load(samples)[:: CHOSEN_ON[each.name]])
        for each in SETS
        if each.name in CHOSEN_ON
    ]
    return {
        fit: float(np.mean([each[fit] for each in found if fit in each]))
        for fit in (Fit.DISPARITY, Fit.METRES)
    }


@torch.no_grad()
def sharpness(network: nn.Module, pairs: Pairs, place: Place) -> float:
    """Return the mean boundary F1 over the images that have an edge."""
    network.eval()
    found = []
    for number in range(len(pairs)):
        pair = pairs[number]
        truth = pair.truth.values.astype(np.float64)
        valid = pair.truth.valid & (truth > 0) & (truth < CAP)
        truth = np.where(valid, truth, 0.0)
        if not valid.any() or not has_edge(truth, valid):
            continue
        image = stacked([as_sample(pair)]).key.image.to(place.device)
        found.append(boundary_f1(network(image).depth[0].double().cpu().numpy(), truth, valid))
    return float(np.mean(found))


@dataclass(frozen=True)
class Resized:
    """Pairs, all of them at one size."""

    pairs: Pairs
    size: tuple[int, int]

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.pairs)

    def __getitem__(self, index: int) -> Pair:
        """Return one."""
        return resized(self.pairs[index], *self.size)


@dataclass(frozen=True)
class Judges:
    """What networks are judged on.

    Attributes:
        held_out: Rendered scenes that were not trained on; None: not on any.
        samples: The folder of all photos with measured depth; None: not on any.
    """

    held_out: Pairs | None
    samples: Path | None

    def figures(
        self, network: CompactNetwork, size: tuple[int, int], place: Place
    ) -> Mapping[str, float]:
        """Return the figures of one network, at the size that it learnt at."""
        found: dict[str, float] = {}
        if self.held_out is not None:
            pairs = Resized(self.held_out, size)
            disparity = validate(network, pairs, Alignment.LEAST_SQUARES_DISPARITY, place)
            found["abs_rel"], found["delta1"] = disparity["abs_rel"], disparity["delta1"]
            found["metres"] = validate(network, pairs, Alignment.NONE, place)["abs_rel"]
            found["edges"] = sharpness(network, pairs, place)
        if self.samples is not None:
            errors = on_photos(looking(network, size, place), self.samples)
            found |= {f"photos, {fit}": error for fit, error in errors.items()}
        return {name: round(value, 4) for name, value in found.items()}
