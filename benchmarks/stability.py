"""Whether depth stays when the picture hardly changes, and is flat where the world is.

    python benchmarks/stability.py [--photos DIR] [--rendered DIR] [--model NAME] [--json]

*Stable*: every photo of a folder, and every sixth rendered image, is brought to 640 pixels along
its longer side and shown again (changes.py): begun 1 and 8 pixels farther right and down,
mirrored, .9 times as large, 10 % brighter, with noise of sigma 2/255, as JPEG of quality 75. Both
depths are compared pixel by pixel: by how many percent the second is off, at the median of the
pixels, after one factor. What either calls sky is left out; --json says how many pixels changed
from the one to the other, what nine tenths of the rest stay within, and the factor.

*Flat*: on all images of a folder of `flexdepth synth` that were not trained on, where the truth is
planar over 32 x 32 pixels (flatness.py): how far the prediction is from its own plane, and that
plane from the true one, in percent of depth; the mean over images. *Sharp* is boundary F1, which
`quality.py --rendered` prints. A smooth map is flat and stable for nothing: the three go together.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from changes import CHANGES, Pixels, Reals, at_first
from flatness import Flatness, flatness, mean_over_images
from samples import RENDERED, scored_pixels, usual_folder
from scores import Predict

import flexdepth
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import Photo, photos_in, read_photo
from flexdepth.runtime.sizes import resized

LONG_SIDE = 640
EVERY = 6
"""Of rendered images, every so manyth is shown again."""


@dataclass(frozen=True)
class Moved:
    """How far depth is from what it was, the one factor of the map apart.

    Attributes:
        median: Over the pixels, a share of depth.
        most: What nine tenths of the pixels stay within.
        factor: How many times farther the whole map is.
        sky: The share of the pixels that are sky in one of the two alone.
    """

    median: float
    most: float
    factor: float
    sky: float


Stable = Mapping[str, Mapping[str, Moved]]
"""By picture, then by change."""


def moved(first: Reals, again: Reals) -> Moved:
    """Return how far depth is from what it was.

    Args:
        first: Depth, +inf in the sky.
        again: The same; NaN where it was not seen again.

    Raises:
        InputError: No pixel has depth in both.
    """
    both = np.isfinite(first) & np.isfinite(again)
    if not both.any():
        raise InputError("no pixel has depth in both: the picture is all sky")
    ratio = (again[both] / first[both]).astype(np.float64)
    factor = float(np.median(ratio))
    off = np.abs(ratio / factor - 1)
    seen = ~np.isnan(again)
    sky = np.isinf(first[seen]) != np.isinf(again[seen])
    return Moved(float(np.median(off)), float(np.quantile(off, 0.9)), factor, float(sky.mean()))


def shown_again(predict: Predict, picture: Pixels) -> Mapping[str, Moved]:
    """Return how far depth is from itself after each of `CHANGES`."""

    def depth(pixels: Pixels) -> Reals:
        return predict(Photo(np.ascontiguousarray(pixels), None, ())).values

    first = depth(at_first(picture))
    return {
        name: moved(first, each.back(depth(each.shown(picture)), first.shape))
        for name, each in CHANGES.items()
    }


def at_long_side(picture: Pixels) -> Pixels:
    """Return a picture whose longer side is `LONG_SIDE`."""
    height, width = picture.shape[:2]
    times = LONG_SIDE / max(height, width)
    return resized(picture, (round(times * width), round(times * height)))


def photos(folder: Path) -> Iterator[tuple[str, Pixels]]:
    """Yield the photos of a folder with their names.

    Raises:
        InputError: There is none.
    """
    for path in photos_in(folder, "*"):
        yield path.stem, read_photo(path).pixels


def rendered(predict: Predict, folder: Path) -> tuple[Stable, Sequence[Flatness]]:
    """Return how stable and how flat depth is on rendered images."""
    stable, flat = {}, []
    for number, file in enumerate(RENDERED.load(folder)):
        pair = file.read()
        truth = np.nan_to_num(pair.truth.values.astype(np.float64), nan=0.0, posinf=0.0)
        depth = predict(Photo(pair.image, None, ())).values.astype(np.float64)
        found = flatness(depth, truth, scored_pixels(truth, RENDERED.cap))
        flat += [found] if found else []
        if number % EVERY == 0:
            stable[pair.name] = shown_again(predict, at_long_side(pair.image))
    return stable, flat


def means(stable: Stable) -> Mapping[str, float]:
    """Return the mean over the pictures of each change's median."""
    return {name: float(np.mean([of[name].median for of in stable.values()])) for name in CHANGES}


def table(title: str, rows: Mapping[str, Mapping[str, float]]) -> str:
    """Return percents as a Markdown table: pictures down, changes across."""
    lines = [[title, *CHANGES], ["---"] * (1 + len(CHANGES))]
    lines += [[name, *(f"{100 * of[each]:.1f}" for each in CHANGES)] for name, of in rows.items()]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def text(sets: Mapping[str, Stable], flat: Sequence[Flatness]) -> str:
    """Return the tables: each photo and their mean, rendered images as their mean alone."""
    blocks = []
    for title, stable in sets.items():
        own = {name: {n: m.median for n, m in of.items()} for name, of in stable.items()}
        shown = {} if title == RENDERED.name else own
        blocks.append(table(title, {**shown, f"mean of {len(stable)}": means(stable)}))
    if flat:
        said = mean_over_images(flat)
        blocks.append(
            f"flat, {said['windows']} planar windows of {said['images']} images: "
            f"{100 * said['bent']:.2f} % off its own plane, which is {100 * said['tilted']:.2f} % "
            f"off the true one (one depth everywhere: {100 * said['level']:.2f} %)"
        )
    return "\n\n".join(blocks)


def main() -> None:
    """Show, compare and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    photographs = usual_folder() / "wild_depth_anything_v2"
    parser.add_argument("--photos", type=Path, default=photographs)
    parser.add_argument("--rendered", type=Path, default=Path("renders/sharp"), metavar="DIR")
    parser.add_argument("--model", default="compact", metavar="NAME")
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")
    options = parser.parse_args()
    predict = flexdepth.load(options.model).predict
    sets: dict[str, Stable] = {}
    flat: Sequence[Flatness] = ()
    if options.photos.is_dir():
        sets["photos"] = {
            name: shown_again(predict, at_long_side(picture))
            for name, picture in photos(options.photos)
        }
    if options.rendered.is_dir():
        sets[RENDERED.name], flat = rendered(predict, options.rendered)
    for name, folder in (("photos", options.photos), (RENDERED.name, options.rendered)):
        if name not in sets:
            print(f"skipped {name}: no folder {folder}", file=sys.stderr)
    if options.json:
        of_sets = {
            name: {each: {n: asdict(m) for n, m in of.items()} for each, of in stable.items()}
            for name, stable in sets.items()
        }
        print(json.dumps({"stable": of_sets, "flat": [asdict(each) for each in flat]}, indent=2))
    else:
        print(text(sets, flat))


if __name__ == "__main__":
    try:
        main()
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
