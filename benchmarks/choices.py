"""Which network, losses, sizes and augmentation: short trainings beside one another.

    python benchmarks/choices.py --data DIR --held-out DIR [--only NAME ...] [--iterations N]

Every variant differs from `compact`, at 160x128, in one thing. All start from the
same seed and, but for those that change the batches themselves, see the same batches; `again` is
`compact` with another seed, and says how much of a difference is luck. Each is judged, at the size
it learnt at, on rendered scenes that were not trained on, by its averaged weights and by those of
the last iteration: AbsRel and delta1 fitted in disparity, AbsRel of metres with the true focal
length, boundary F1. With -o, averaged weights are written, half-precision, one file a variant.
Prints one line of JSON a variant. Uses a GPU where there is one.
"""

import argparse
import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from safetensors.torch import save_file
from torch import Tensor, nn
from torch.nn.functional import interpolate

from flexdepth.data.colour import Colour
from flexdepth.data.folder import Folder, Pair
from flexdepth.data.transforms import as_sample, resized
from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.boundary import boundary_f1, has_edge
from flexdepth.experiments.experiment import Experiment
from flexdepth.experiments.start import give_weights
from flexdepth.geometry.depth import DepthBins
from flexdepth.losses import GradientMatching, VirtualNormal, WeightedCrossEntropy
from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.compact import Compact, CompactNetwork
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.heads import LogDepth, LogDepthHead
from flexdepth.networks.merge import SpatialPlusChannelAttention
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction
from flexdepth.tensors import moved, stacked
from flexdepth.training.averaging import follow
from flexdepth.training.batches import Batches, BatchSettings, Pairs, loader
from flexdepth.training.loop import LoopSettings, Run, learn
from flexdepth.training.objective import Term, check_finite
from flexdepth.training.optimiser import set_rate
from flexdepth.training.processes import Place
from flexdepth.training.validation import CAP, validate

BINS = DepthBins(96, 0.05, 500.0, unit=1.0)
"""Of canonical depth in metres, half a centimetre to a decimetre wide near, equally in the log."""


@dataclass(frozen=True)
class BinnedLogDepth(LogDepth):
    """Depth as the mean, in the logarithm, of bins that are scored at half the image's size."""

    def build(self, inputs: int) -> "BinnedLogDepthHead":
        """Return the head on features of `inputs` channels."""
        return BinnedLogDepthHead(self, inputs)


class BinnedLogDepthHead(LogDepthHead):
    """The module of `BinnedLogDepth`; keeps the scores for the loss of classification."""

    def __init__(self, settings: LogDepth, inputs: int) -> None:
        super().__init__(settings, inputs)
        self.score = nn.Conv2d(inputs, BINS.count, 3, padding=1, padding_mode="replicate")
        self.logits: Tensor | None = None

    def forward(
        self, features: Float[Tensor, "batch channels height width"]
    ) -> tuple[
        Float[Tensor, "batch full_height full_width"], Float[Tensor, "batch full_height full_width"]
    ]:
        """Return depth and the sky's logit, at twice the size of the features."""
        logits = self.score(features)
        self.logits = logits
        log_depth = BINS.depth(logits).log()[:, None]
        maps = torch.cat([log_depth, self.conv(features)[:, 1:]], 1)
        log_depth, sky_logit = interpolate(maps, scale_factor=2.0, mode="bilinear").unbind(1)
        return log_depth.exp(), sky_logit


class ScoredNetwork(CompactNetwork):
    """`CompactNetwork` whose prediction has the scores of the bins."""

    def forward(self, image: Float[Tensor, "batch 3 height width"]) -> Prediction:
        """Return what `CompactNetwork` does, and the scores at the image's size."""
        prediction = super().forward(image)
        if not isinstance(self.head, BinnedLogDepthHead) or self.head.logits is None:
            raise TypeError("ScoredNetwork needs the head BinnedLogDepth")
        logits = interpolate(self.head.logits, scale_factor=2.0, mode="bilinear")
        return replace(prediction, logits=logits, bins=BINS)


class WithoutAttention(nn.Module):
    """The plain merge: what the encoder saw is added as it is."""

    def forward(self, lateral: Tensor, _decoder: Tensor) -> tuple[Tensor, None]:
        """Return the lateral features; there is no map of attention."""
        return lateral, None


@dataclass(frozen=True)
class Addition:
    """The coefficient 1 everywhere."""

    def build(self, _lateral: int, _decoder: int) -> WithoutAttention:
        """Return the module."""
        return WithoutAttention()


@dataclass(frozen=True)
class Variant:
    """One thing that is done otherwise than in `compact`.

    Attributes:
        network: What is trained.
        terms: What is added to, or replaces, the terms of `compact`; None takes one away.
        batches: How batches are made.
        seed: Of the weights that do not come pretrained.
        scored: The network is a `ScoredNetwork`.
    """

    network: Compact = field(default_factory=Compact)
    terms: Mapping[str, Term | None] = field(default_factory=dict)
    batches: BatchSettings = field(default_factory=lambda: SMALL)
    seed: int = 0
    scored: bool = False


SMALL = BatchSettings(shapes=((160, 128),))
_BINNED = Compact(head=BinnedLogDepth())

VARIANTS: Mapping[str, Variant] = {
    "compact": Variant(),
    "again": Variant(seed=1),
    "bins": Variant(_BINNED, scored=True),
    "bins, WCEL": Variant(
        _BINNED, {"cross_entropy": Term(WeightedCrossEntropy(), 0.3)}, scored=True
    ),
    "silog alone": Variant(terms={"gradient": None}),
    "gradient x 4": Variant(terms={"gradient": Term(GradientMatching(), 2.0)}),
    "virtual normals": Variant(terms={"normal": Term(VirtualNormal(focal=None), 1.0)}),
    "addition": Variant(Compact(coefficient=Addition())),  # type: ignore[arg-type]
    "S1": Variant(Compact(coefficient=ChannelAttention(8))),
    "S7": Variant(
        Compact(coefficient=SpatialPlusChannelAttention(ratio=16, channel=ChannelAttention(16)))
    ),
    "lite1": Variant(Compact(encoder=Encoder("tf_efficientnet_lite1"))),
    "lite2": Variant(Compact(encoder=Encoder("tf_efficientnet_lite2"))),
    "no augmentation": Variant(batches=replace(SMALL, colour=Colour(strength=0.0))),
    "twice the pixels": Variant(batches=replace(SMALL, shapes=((224, 192),))),
}


def built(variant: Variant) -> CompactNetwork:
    """Return a variant's network with the encoder's first weights."""
    torch.manual_seed(variant.seed)
    network = (ScoredNetwork if variant.scored else CompactNetwork)(variant.network)
    give_weights(network, Experiment().start)
    return network.to(memory_format=torch.channels_last)


def terms_of(variant: Variant) -> Mapping[str, Term]:
    """Return what a variant minimises."""
    named = {**Experiment().terms, **variant.terms}
    return {name: term for name, term in named.items() if term is not None}


def trained(
    variants: Mapping[str, Variant], data: Pairs, loop: LoopSettings, processes: int, place: Place
) -> Mapping[str, Run]:
    """Train variants that see the same batches, each batch by one after another."""
    runs = {name: Run.started(built(each), loop, place) for name, each in variants.items()}
    batches = next(iter(variants.values())).batches
    for number, batch in enumerate(loader(Batches(data, batches, loop.iterations), 0, processes)):
        seen = moved(batch, place.device)
        rate = loop.optimiser.rate_at(number, loop.iterations)
        for name, run in runs.items():
            set_rate(run.optimiser, rate)
            check_finite(learn(run.network, loop, terms_of(variants[name]), seen), number)
            nn.utils.clip_grad_norm_(run.network.parameters(), loop.optimiser.largest_gradient)
            run.optimiser.step()
            follow(run.average, run.network, number, loop.average_decay)
    return runs


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


def judged(network: nn.Module, held_out: Pairs, place: Place) -> Mapping[str, float]:
    """Return the figures of one network."""
    fitted = validate(network, held_out, Alignment.LEAST_SQUARES_DISPARITY, place)
    metres = validate(network, held_out, Alignment.NONE, place)
    figures = {
        "abs_rel": fitted["abs_rel"],
        "delta1": fitted["delta1"],
        "metres": metres["abs_rel"],
        "edges": sharpness(network, held_out, place),
    }
    return {name: round(value, 4) for name, value in figures.items()}


def groups(names: Sequence[str]) -> list[dict[str, Variant]]:
    """Return the wanted variants, those together that see the same batches."""
    found: list[dict[str, Variant]] = []
    for name in names:
        variant = VARIANTS[name]
        same = [g for g in found if next(iter(g.values())).batches == variant.batches]
        if same:
            same[0][name] = variant
        else:
            found.append({name: variant})
    return found


def main() -> None:
    """Train, judge and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--held-out", type=Path, required=True)
    parser.add_argument("--only", action="append", choices=VARIANTS, help="may be repeated")
    parser.add_argument("--iterations", type=int, default=240)
    parser.add_argument("--processes", type=int, default=2, help="that make batches")
    parser.add_argument("-o", "--output-dir", type=Path)
    options = parser.parse_args()
    place = Place(device="cuda" if torch.cuda.is_available() else "cpu")
    data, held_out = Folder(options.data).load(), Folder(options.held_out).load()
    loop = LoopSettings(iterations=options.iterations, average_decay=0.99)
    for group in groups(options.only or list(VARIANTS)):
        (size, *_) = next(iter(group.values())).batches.shapes
        judging = Resized(held_out, size)
        start = time.monotonic()
        runs = trained(group, data, loop, options.processes, place)
        seconds = round(time.monotonic() - start, 1)
        for name, run in runs.items():
            figures = {
                "averaged": judged(run.average, judging, place),
                "last": judged(run.network, judging, place),
            }
            print(json.dumps({"variant": name, "group_seconds": seconds, **figures}), flush=True)
            if options.output_dir is not None:
                options.output_dir.mkdir(parents=True, exist_ok=True)
                weights = {k: half(v) for k, v in run.average.state_dict().items()}
                save_file(weights, options.output_dir / f"{name}.safetensors")


def half(value: Tensor) -> Tensor:
    """Return weights in half precision, counts as they are."""
    return (value.half() if value.is_floating_point() else value).cpu().contiguous()


if __name__ == "__main__":
    try:
        main()
    except InputError as error:
        raise SystemExit(f"error: {error}") from error
