"""Whether the model knows how far off it is, and which lens took the picture.

    python benchmarks/certainty.py [--model BUNDLE] [--held-out DIR] [--samples DIR] [--picture PNG]
                                   [--strict]

On rendered scenes that were not trained on (`flexdepth synth --seed 1 --count 160`): the error of a
pixel is |log(depth / truth)| less the image's median of the logarithm, for the one factor of the
whole map is not the pixel's. 68 % of the errors should be within one spread and 95 % within two;
the picture shows both shares for pixels of small and of large spread. `spread factor` is what all
spreads were better multiplied by: then the one share is above what is wanted and the other below,
both by as much of what is allowed (5 and 3 points). The map's factor itself is off by
`scale`, the value that 68 % of the images stay within; the bundle says it as `scale_spread`.

On real pictures with measured depth (docs/samples.md): AbsRel as `quality.py` has it, of all
scored pixels and without the fifth of each image's that the model is least sure of, both after
the same fit. And the field of view that the model sees where nobody tells it: the median over the
images of the degrees by which it is off. Prints JSON, the bars last: on both shares, and for each
set of real pictures on how much lower AbsRel is without the least sure fifth. With --strict it
exits with 1 where one is missed.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import matplotlib as mpl
import numpy as np
from bars import Bar, Limit
from numpy.typing import NDArray
from samples import RENDERED, SETS, Readable, SampleSet, scored_pixels, usual_folder

import flexdepth
from flexdepth.evaluation.alignment import Alignment, aligned
from flexdepth.evaluation.metrics import abs_rel
from flexdepth.runtime.depthmap import DepthMap, Intrinsics
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import Photo

DROPPED = 0.2
LOWER_BY = 0.15
"""The part by which AbsRel has to be lower without the least sure."""
GROUPS = 10
HELD_OUT = "held-out scenes"
WANTED = MappingProxyType({"within one spread": (0.68, 0.05), "within two spreads": (0.95, 0.03)})
"""The shares within one and two spreads, and by how much each may miss."""

Reals = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Foretold:
    """Errors of pixels in spreads of their own, those spreads, and each image's factor."""

    ratios: Reals
    spreads: Reals
    factors: Reals


def foretold(model: str, folder: Path, every: int = 7) -> Foretold:
    """Return the errors of every so manyth pixel of the held-out scenes."""
    ratios, spreads, factors = [], [], []
    for file in RENDERED.load(folder):
        pair = file.read()
        camera = pair.truth.intrinsics
        if camera is None:
            raise InputError(f"{pair.name}: has no camera")
        lens = flexdepth.FocalLength(camera.focal_x)
        found = flexdepth.load(model, lens).predict(pair.image)
        if found.spread is None:
            raise InputError(f"{model}: does not say how far off its depth may be")
        known = pair.truth.valid & found.valid & (pair.truth.values < RENDERED.cap)
        known &= np.isfinite(found.spread)
        if not known.any():
            continue
        error = np.log(found.values[known] / pair.truth.values[known]).astype(np.float64)
        factors.append(np.median(error))
        spreads.append(found.spread[known][::every].astype(np.float64))
        ratios.append(np.abs(error - factors[-1])[::every] / spreads[-1])
    return Foretold(np.concatenate(ratios), np.concatenate(spreads), np.array(factors))


def reliability(found: Foretold) -> dict[str, float]:
    """Return the shares within one and two spreads, and how far off the whole map is."""
    return {
        "within one spread": round(float((found.ratios <= 1).mean()), 4),
        "within two spreads": round(float((found.ratios <= 2).mean()), 4),
        "spread factor": round(spread_factor(found.ratios), 2),
        "median spread": round(float(np.median(found.spreads)), 4),
        "scale": round(float(np.quantile(np.abs(found.factors), 0.6827)), 3),
    }


def spread_factor(ratios: Reals) -> float:
    """Return the factor on all spreads that makes both shares miss by as much of what they may."""
    factors = np.geomspace(0.5, 2, 281)
    missed = sum(
        (np.array([(ratios <= count * factor).mean() for factor in factors]) - share) / allowed
        for count, (share, allowed) in enumerate(WANTED.values(), 1)
    )
    return float(factors[np.abs(missed).argmin()])


def draw(found: Foretold, path: Path) -> None:
    """Draw the shares within one and two spreads, for groups of pixels of like spread."""
    mpl.use("Agg")
    from matplotlib import pyplot as plt  # noqa: PLC0415 - after the backend is chosen

    ends = np.quantile(found.spreads, np.linspace(0, 1, GROUPS + 1))
    group = np.clip(np.searchsorted(ends, found.spreads, "right") - 1, 0, GROUPS - 1)
    middle = [np.median(found.spreads[group == k]) for k in range(GROUPS)]
    figure, axes = plt.subplots(figsize=(5, 3.6))
    for count, (name, (level, _)) in enumerate(WANTED.items(), 1):
        share = [(found.ratios[group == k] <= count).mean() for k in range(GROUPS)]
        (line,) = axes.plot(middle, share, "o-", label=name)
        axes.axhline(level, color=line.get_color(), linestyle=":", linewidth=1)
    axes.set(
        xscale="log", ylim=(0, 1), xlabel="predicted spread of depth", ylabel="share of pixels"
    )
    axes.legend(loc="lower right")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def without_the_unsure(
    found: DepthMap, truth: Reals, scored: NDArray[np.bool_], cap: float
) -> tuple[float, float]:
    """Return AbsRel of all pixels, and of those that the model is surer of; sky counts as sure."""
    depth = aligned(found, Alignment.LEAST_SQUARES_DISPARITY, truth, scored, cap)
    if found.spread is None:
        raise InputError("the model does not say how far off its depth may be")
    spread = np.nan_to_num(found.spread, nan=0.0)
    sure = scored & (spread <= np.quantile(spread[scored], 1 - DROPPED))
    return abs_rel(depth, truth, scored), abs_rel(depth, truth, sure)


def field_of_view(camera: Intrinsics, width: int) -> float:
    """Return the degrees from the left edge to the right edge."""
    return float(2 * np.degrees(np.arctan(width / 2 / camera.focal_x)))


def on_real(model: str, sample_set: SampleSet, files: Sequence[Readable]) -> dict[str, float]:
    """Return what dropping the unsure gains on a set, and how far off the field of view is."""
    predictor = flexdepth.load(model)
    pairs, angles = [], []
    for file in files:
        pair = file.read()
        found = predictor.predict(Photo(pair.image, None, ()))
        truth = np.nan_to_num(pair.truth.values.astype(np.float64), nan=0.0, posinf=0.0)
        scored = scored_pixels(truth, sample_set.cap)
        if scored.any():
            pairs.append(without_the_unsure(found, truth, scored, sample_set.cap))
        if found.intrinsics is not None and pair.truth.intrinsics is not None:
            both = found.intrinsics, pair.truth.intrinsics
            seen, true = (field_of_view(camera, truth.shape[1]) for camera in both)
            angles.append(abs(seen - true))
    everything, sure = np.array(pairs).mean(0)
    report = {
        "abs_rel": round(float(everything), 4),
        "without the least sure fifth": round(float(sure), 4),
        "lower by": round(float(1 - sure / everything), 4),
    }
    if angles:
        report["field of view off by, degrees"] = round(float(np.median(angles)), 1)
    return report


def asked(report: Mapping[str, Mapping[str, float]]) -> Iterator[Bar]:
    """Yield the bars of what was measured; a share has one from below and one from above."""
    for name, figures in report.items():
        if name != HELD_OUT:
            what = f"{name}, without the least sure fifth: AbsRel lower by"
            yield Bar(what, figures["lower by"], Limit(">=", LOWER_BY))
            continue
        for what, (share, allowed) in WANTED.items():
            yield Bar(f"{name}: {what}", figures[what], Limit(">=", share - allowed))
            yield Bar(f"{name}: {what}", figures[what], Limit("<=", share + allowed))


def held(samples: Path) -> Iterator[tuple[SampleSet, Sequence[Readable]]]:
    """Give the sets that the folder holds."""
    for sample_set in SETS:
        with suppress(InputError):
            yield sample_set, sample_set.load(samples)


def main() -> int:
    """Measure, print, return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--model", default="compact", metavar="BUNDLE")
    parser.add_argument("--held-out", type=Path, default=Path("renders/heldout"))
    parser.add_argument("--samples", type=Path, default=usual_folder())
    parser.add_argument("--picture", type=Path, metavar="PNG", help="the reliability, drawn")
    parser.add_argument("--strict", action="store_true", help="exit with 1 where a bar is missed")
    options = parser.parse_args()
    report: dict[str, dict[str, float]] = {}
    if options.held_out.is_dir():
        found = foretold(options.model, options.held_out)
        report[HELD_OUT] = reliability(found)
        if options.picture:
            draw(found, options.picture)
    else:
        print(f"skipped {HELD_OUT}: no folder {options.held_out}", file=sys.stderr)
    for each, files in held(options.samples):
        report[each.name] = on_real(options.model, each, files)
    bars = list(asked(report))
    print(json.dumps({**report, "bars": [bar.record() for bar in bars]}, indent=2))
    missed = not bars or not all(bar.met for bar in bars)
    return int(options.strict and missed)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
