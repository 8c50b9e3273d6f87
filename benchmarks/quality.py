"""How good models are on real pictures with measured depth, beside those who never look.

    python benchmarks/quality.py --samples DIR [--model NAME ...] [--markdown | --json]
    python benchmarks/quality.py --rendered DIR [...]

Pixels with 1 mm < truth < cap are scored (10 m indoors, 80 m on the road), AbsRel and delta1 per
image, then averaged over the set; three times: fitted in disparity to 1/truth by ordinary least
squares, clipped so that depth <= cap; scaled by the ratio of the medians; and as metres, with the
true focal length and nothing fitted. Beside them stand the best constant in hindsight, a ramp and
the ground plane; how many times too large the metres come out; and, where the truth is dense, how
sharp the edges are. Last come the bars that the first model has to reach (bars.py). A model is
named as everywhere (docs/models.md); what its numbers do not allow, such as metres of affine
disparity, is left out, and a bar on it is missed. With --rendered a folder of `flexdepth
synth` is scored instead; edges need images larger than the network's 384x288, where the ceiling
is 1. docs/samples.md says where the pictures come from.
"""

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
from bars import asked, beside_the_blind
from boundaries import boundaries
from numpy.typing import NDArray
from PIL import Image
from samples import RENDERED, SETS, Readable, SampleSet, scored_pixels, usual_folder
from scores import Fit, Predict, Result, Seen, fitted, looked_at, score_set
from tables import markdown, text, verdicts

import flexdepth
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.picture import limits, panels, preview

BUNDLED = "compact"


def found(
    samples: Path, only: Sequence[str] = ()
) -> Iterator[tuple[SampleSet, Sequence[Readable]]]:
    """Yield the sets that the folder holds; say on stderr which it lacks and why.

    Args:
        samples: The folder.
        only: The names of those that are wanted; all without any.

    Raises:
        InputError: There is no set of such a name.
    """
    unknown = set(only) - {each.name for each in SETS}
    if unknown:
        names = ", ".join(each.name for each in SETS)
        raise InputError(f"--only: no set {min(unknown)!r}; choose some of {names}")
    for sample_set in SETS:
        if only and sample_set.name not in only:
            continue
        try:
            yield sample_set, sample_set.load(samples)
        except InputError as error:
            print(f"skipped {sample_set.name}: {error}", file=sys.stderr)


def sheet_of(seen: Seen, cap: float) -> NDArray[np.uint8]:
    """Return input | prediction of the first model, fitted in disparity | truth."""
    truth = np.nan_to_num(seen.pair.truth.values.astype(np.float64), nan=0.0, posinf=0.0)
    valid = scored_pixels(truth, cap)
    depth = fitted(next(iter(seen.maps.values())), Fit.DISPARITY, truth, valid, cap)
    maps = [
        DepthMap(metres.astype(np.float32), Space.METRIC)
        for metres in (depth, np.where(valid, truth, np.nan))
    ]
    shown = limits(maps[1])
    pictures = [seen.pair.image, *(preview(depth_map, shown) for depth_map in maps)]
    return panels(pictures, [seen.pair.name, "prediction, fitted", "truth"])


def arguments() -> argparse.Namespace:
    """Return what the command line says."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    samples = usual_folder()
    parser.add_argument("--samples", type=Path, default=samples, help=f"default: {samples}")
    parser.add_argument(
        "--model",
        action="append",
        metavar="NAME",
        help=f"may be repeated; the first must reach the bars; default: {BUNDLED}",
    )
    parser.add_argument(
        "--only", action="append", default=[], metavar="SET", help="score this set; may be repeated"
    )
    parser.add_argument(
        "--rendered", type=Path, metavar="DIR", help="score this folder of flexdepth synth instead"
    )
    parser.add_argument("--json", action="store_true", help="print JSON instead of the tables")
    parser.add_argument("--markdown", action="store_true", help="print one Markdown table")
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="write a few side by side")
    parser.add_argument("--strict", action="store_true", help="exit with 1 where a bar is missed")
    return parser.parse_args()


def predictor(model: str) -> Predict:
    """Return the way from a picture to its depth."""
    return flexdepth.load(model).predict


def scored(
    sample_set: SampleSet, files: Sequence[Readable], models: dict[str, Predict], sheets: Path
) -> tuple[Result, dict[str, float]]:
    """Return the scores of a set, and the mean boundary F1 where its truth is dense.

    The first, the middle and the last picture of a set become sheets, unless `sheets` is empty.
    """
    network = flexdepth.load().model.description
    drawn = {0, len(files) // 2, len(files) - 1} if sheets.name else set()
    edges: list[dict[str, float]] = []

    def watched() -> Iterator[Seen]:
        for number, seen in enumerate(looked_at(files, models)):
            if number in drawn:
                sheets.mkdir(parents=True, exist_ok=True)
                path = sheets / f"{sample_set.name}-{seen.pair.name}.png"
                Image.fromarray(sheet_of(seen, sample_set.cap)).save(path)
            if sample_set.dense and (said := boundaries(seen, sample_set.cap, network)):
                edges.append(dict(said))
            yield seen

    result = score_set(sample_set, watched())
    whos = edges[0] if edges else {}
    return result, {who: float(np.mean([each[who] for each in edges])) for who in whos}


def main() -> int:
    """Score what the folder holds, print it, return the exit code."""
    options = arguments()
    if options.rendered is not None:
        sets = [(RENDERED, RENDERED.load(options.rendered))]
    else:
        sets = list(found(options.samples, options.only))
    if not sets:
        print(f"skipped: {options.samples} holds none of the sets of docs/samples.md")
        return int(options.strict)
    models = {name: predictor(name) for name in options.model or [BUNDLED]}
    results: dict[str, Result] = {}
    edges: dict[str, dict[str, float]] = {}
    for sample_set, files in sets:
        started = time.process_time()
        name, sheets = sample_set.name, options.pictures or Path()
        results[name], sharp = scored(sample_set, files, models, sheets)
        edges |= {name: sharp} if sharp else {}
        seconds = time.process_time() - started
        print(f"{name}: {len(files)} frames in {seconds:.0f} s of CPU time", file=sys.stderr)
    first = next(iter(models))
    own, blind = list(asked(results, edges, first)), list(beside_the_blind(results, first))
    if options.json:
        record = {name: asdict(result) for name, result in results.items()}
        bars = [each.record() for each in (*own, *blind)]
        print(json.dumps({"sets": record, "boundary_f1": edges, "bars": bars}, indent=2))
    elif options.markdown:
        print(markdown(results, edges, list(models)))
    else:
        print(text(results, edges, list(models)), verdicts(own, blind, first), sep="\n\n")
    missed = not all(each.met for each in (*own, *blind))
    return 1 if options.strict and missed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
