"""How good the model is on real pictures with measured depth, beside blind baselines.

    python benchmarks/quality.py --samples DIR [--model BUNDLE] [--json] [--pictures DIR]

Protocol: pixels with 1 mm < truth < cap are scored (10 m indoors, 80 m on the road). Disparity
is fitted to 1/truth per image by ordinary least squares and clipped so that depth <= cap. AbsRel
and delta1 are taken per image, then averaged over the set. Beside them stands how large the
world comes out in metres when the focal length is known, without any fit: the geometric mean
over the images of median(depth / truth). docs/samples.md says where the pictures come from.
"""

import argparse
import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from samples import SETS, Frame, SampleSet, Score, frames, read_truth, scored_pixels

import flexdepth
from flexdepth.evaluation.alignment import Alignment, aligned
from flexdepth.evaluation.metrics import abs_rel, delta1
from flexdepth.runtime.depthmap import DepthMap, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.picture import limits, panels, preview

BESIDE_THE_REPOSITORY = Path(__file__).parents[2] / "shared" / "data"
CAMERA_HEIGHT = 1.65
"""Metres above the road, KITTI's. The fit leaves it no say but through the ground's cap."""
GROUND_CAP = 40.0
"""Metres: the ground plane goes no farther, and stands for everything above the horizon."""


@dataclass(frozen=True)
class Result:
    """The mean scores of one set by predictor; `unscored` frames have no depth in range.

    `enlarged` is how many times too large the model's metres are, None for a model without.
    """

    frames: int
    unscored: int
    bar: Score
    passed: bool
    scores: dict[str, Score]
    enlarged: float | None


Predict = Callable[[Path], DepthMap]
MODEL = "model"


def blind(shape: tuple[int, ...], camera: Intrinsics) -> dict[str, DepthMap]:
    """Return the predictions of those who never look at the picture."""
    height, width = shape
    rows = np.arange(height) + 0.5
    road = (rows - camera.centre_y) / (camera.focal_y * CAMERA_HEIGHT)
    nearness = {
        "constant": np.ones(height),
        "vertical ramp": rows / height,
        "ground plane": np.maximum(road, 1 / GROUND_CAP),
    }
    return {
        name: DepthMap(
            np.tile(column[:, None], (1, width)).astype(np.float32), Space.AFFINE_DISPARITY
        )
        for name, column in nearness.items()
    }


def fit(
    prediction: DepthMap, truth: NDArray[np.float64], valid: NDArray[np.bool_], cap: float
) -> NDArray[np.float64]:
    """Return the prediction as the benchmark scores it."""
    return aligned(prediction, Alignment.LEAST_SQUARES_DISPARITY, truth, valid, cap)


def score_frame(
    truth: NDArray[np.float64], sample_set: SampleSet, prediction: DepthMap
) -> dict[str, Score]:
    """Return the scores of the model and of the blind; none where no truth is in range."""
    valid = scored_pixels(truth, sample_set.cap)
    if not valid.any():
        return {}
    scores = {}
    maps = {MODEL: prediction} | blind(truth.shape, sample_set.camera)
    for name, depth_map in maps.items():
        depth = fit(depth_map, truth, valid, sample_set.cap)
        scores[name] = Score(abs_rel(depth, truth, valid), delta1(depth, truth, valid))
    return scores


def enlarged(
    truth: NDArray[np.float64], sample_set: SampleSet, prediction: DepthMap
) -> float | None:
    """Return median(depth / truth) with the set's focal length; None where there are no metres."""
    valid = scored_pixels(truth, sample_set.cap) & prediction.valid
    camera = prediction.intrinsics
    if prediction.space not in (Space.METRIC, Space.SCALE) or camera is None or not valid.any():
        return None
    longer = sample_set.camera.focal_x / camera.focal_x
    return float(np.median(prediction.depth[valid] / truth[valid])) * longer


def mean(scores: list[Score]) -> Score:
    """Return the mean over frames: each counts the same, however many pixels it has."""
    return Score(
        float(np.mean([score.abs_rel for score in scores])),
        float(np.mean([score.delta1 for score in scores])),
    )


def score_set(sample_set: SampleSet, samples: list[Frame], predict: Predict) -> Result:
    """Score the model and the blind predictors on every frame of a set."""
    scored, sizes = [], []
    for frame in samples:
        truth = read_truth(frame.truth, sample_set.steps_per_metre)
        prediction = predict(frame.image)
        if scores := score_frame(truth, sample_set, prediction):
            scored.append(scores)
        if (size := enlarged(truth, sample_set, prediction)) is not None:
            sizes.append(size)
    if not scored:
        raise InputError(f"{sample_set.name}: no frame has measured depth below the cap")
    means = {name: mean([scores[name] for scores in scored]) for name in scored[0]}
    return Result(
        frames=len(samples),
        unscored=len(samples) - len(scored),
        bar=sample_set.bar,
        passed=means[MODEL].reaches(sample_set.bar),
        scores=means,
        enlarged=float(np.exp(np.log(sizes).mean())) if sizes else None,
    )


def found(samples: Path) -> Iterator[tuple[SampleSet, list[Frame]]]:
    """Yield the sets that the folder holds; say on stderr which it lacks and why."""
    for sample_set in SETS:
        try:
            yield sample_set, frames(samples, sample_set)
        except InputError as error:
            print(f"skipped {sample_set.name}: {error}", file=sys.stderr)


def table(results: Mapping[str, Result]) -> str:
    """Return the scores as text: predictors down, sets across, and whether the bars are reached."""
    of = results.values()
    rows = [
        ["AbsRel/delta1", *results],
        ["frames scored", *(f"{result.frames - result.unscored}/{result.frames}" for result in of)],
        *([name, *(str(r.scores[name]) for r in of)] for name in next(iter(of)).scores),
        ["bar", *(str(result.bar) for result in of)],
        ["", *("pass" if result.passed else "MISS" for result in of)],
        ["metres x", *(f"{r.enlarged:.2f}" if r.enlarged else "-" for r in of)],
    ]
    return "\n".join("".join(f"{cell:<15}" for cell in row).rstrip() for row in rows)


def write_pictures(
    folder: Path, sample_set: SampleSet, samples: list[Frame], predict: Predict
) -> None:
    """Write input | prediction, fitted | truth for the set's first, middle and last frame."""
    folder.mkdir(parents=True, exist_ok=True)
    for frame in (samples[0], samples[len(samples) // 2], samples[-1]):
        truth = read_truth(frame.truth, sample_set.steps_per_metre)
        valid = scored_pixels(truth, sample_set.cap)
        depth = fit(predict(frame.image), truth, valid, sample_set.cap)
        maps = [
            DepthMap(metres.astype(np.float32), Space.METRIC)
            for metres in (depth, np.where(valid, truth, np.nan))
        ]
        shown = limits(maps[1])
        with Image.open(frame.image) as picture:
            pictures = [np.asarray(picture.convert("RGB"))]
        pictures += [preview(depth_map, shown) for depth_map in maps]
        sheet = panels(pictures, [frame.image.name, "prediction, fitted", "truth"])
        Image.fromarray(sheet).save(folder / f"{sample_set.name}-{frame.image.stem}.png")


def arguments() -> argparse.Namespace:
    """Return what the command line says."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    samples = Path(os.environ.get("FLEXDEPTH_SAMPLES") or BESIDE_THE_REPOSITORY)
    parser.add_argument("--samples", type=Path, default=samples, help=f"default: {samples}")
    parser.add_argument("--model", default="compact", metavar="BUNDLE", help="default: compact")
    parser.add_argument("--json", action="store_true", help="print JSON instead of the table")
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="write a few side by side")
    parser.add_argument("--strict", action="store_true", help="exit with 1 where a bar is missed")
    return parser.parse_args()


def predictor(bundle: str) -> Predict:
    """Return the way from a picture to its depth."""
    return flexdepth.load(bundle).predict


def main() -> int:
    """Score what the folder holds, print it, return the exit code."""
    options = arguments()
    sets = list(found(options.samples))
    if not sets:
        print(f"skipped: {options.samples} holds none of the sets of docs/samples.md")
        return 0
    predict = predictor(options.model)
    results = {}
    for sample_set, samples in sets:
        started = time.perf_counter()
        results[sample_set.name] = score_set(sample_set, samples, predict)
        seconds = time.perf_counter() - started
        print(f"{sample_set.name}: {len(samples)} frames in {seconds:.0f} s", file=sys.stderr)
        if options.pictures:
            write_pictures(options.pictures, sample_set, samples, predict)
    if options.json:
        print(json.dumps({name: asdict(result) for name, result in results.items()}, indent=2))
    else:
        print(table(results))
    missed = not all(result.passed for result in results.values())
    return 1 if options.strict and missed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
