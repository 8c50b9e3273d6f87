"""Time and memory of the solver against the size of the frames, with a line through the times.

    python benchmarks/solve/speed_of_solving.py [--json FILE] [--strict]

One large pair of the suite with exact flow, resized (its middle rows, where the shape is another).
Each size runs in a process of its own, once uncounted and once counted; the peak of memory is that
of the whole process. CPU time stands beside the wall clock, which means little on a busy machine;
the bars of `suite.yaml` are about wall clock. With --strict it exits with 1 where one is missed.
"""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import inf
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from pairs import HERE, Pair, pair, suite
from rows import ROWS, case, timed

sys.path.insert(0, str(HERE.parent))

from runs import child
from verdict import verdict

SIZES = ((160, 120), (320, 240), (512, 218), (640, 480), (1024, 436))


@dataclass(frozen=True)
class Taken:
    """What one pair took at one size: seconds and bytes."""

    size: tuple[int, int]
    method: str
    seconds: float
    cpu: float
    peak: int | None

    @property
    def pixels(self) -> int:
        """How many."""
        return self.size[0] * self.size[1]

    def meets(self, bar: Mapping[str, float]) -> bool:
        """Return whether a bar is met; a peak that cannot be measured misses none."""
        return self.seconds <= bar["seconds"] and (self.peak or 0) <= bar.get("bytes", inf)


def resized(truth: Pair, size: tuple[int, int]) -> Pair:
    """Return the middle rows of a pair, in the shape of the size, at that size."""
    width, height = size
    high, wide = truth.depth.shape
    rows = min(high, round(wide * height / width))
    band = slice((high - rows) // 2, (high - rows) // 2 + rows)
    ratio = width / wide

    def at_size(values: NDArray[np.generic]) -> NDArray[np.generic]:
        return np.asarray(cv2.resize(values[band], size, interpolation=cv2.INTER_NEAREST))

    return replace(
        truth,
        key=at_size(truth.key),
        target=at_size(truth.target),
        depth=at_size(truth.depth),
        flow=at_size(truth.flow) * ratio,
        occluded=at_size(truth.occluded.astype(np.uint8)).astype(bool),
        kind=at_size(truth.kind),
        focal=np.array(truth.focal * ratio),
    )


def one(method: str, size: tuple[int, int]) -> Taken:
    """Return what a method takes at a size, without the memory."""
    given = case(resized(pair(suite(), "large", 0), size), 0, 0.0)
    timed(ROWS[method], case(resized(pair(suite(), "large", 0), SIZES[0]), 0, 0.0))
    found = timed(ROWS[method], given)
    return Taken(size, method, found.seconds, found.cpu, None)


def measured(method: str, size: tuple[int, int]) -> Taken:
    """Return the same from a process of its own, with its peak."""
    file = HERE.parents[1] / "build" / "speed_of_solving.json"
    file.parent.mkdir(exist_ok=True)
    words = ["--one", method, *map(str, size), "--json", str(file)]
    peak = child([sys.executable, __file__, *words]).peak
    said = json.loads(file.read_text())
    return Taken(size, method, said["seconds"], said["cpu"], peak)


def line(taken: Sequence[Taken]) -> tuple[float, float, float]:
    """Return a and b of seconds = a + b pixels, and the largest share by which one is off it.

    The line is the least squares of relative errors, so that the small sizes count as well.
    """
    pixels, cpu = np.array([[each.pixels, each.cpu] for each in taken]).T
    design = np.stack([np.ones_like(pixels), pixels], 1) / cpu[:, None]
    (start, slope), *_ = np.linalg.lstsq(design, np.ones_like(cpu), rcond=None)
    off = np.abs(start + slope * pixels - cpu) / cpu
    return float(start), float(slope), float(off.max())


def report(bars: Sequence[dict[str, Any]], file: Path | None) -> bool:
    """Measure, print and write; return whether the bars are met."""
    taken: list[Taken] = []
    met: list[bool] = []
    print(f"{'size':>10} {'method':8} {'seconds':>8} {'CPU s':>7} {'peak GB':>8}   bar")
    for method, size in (("regions", SIZES[0]), *(("dense", size) for size in SIZES)):
        each = measured(method, size)
        taken.append(each)
        asked = [
            bar for bar in bars if (tuple(bar["size"]), bar["method"]) == (each.size, each.method)
        ]
        met += [each.meets(bar) for bar in asked]
        bar = ", ".join(f"{_bar(one)}  {verdict(each.meets(one))}" for one in asked)
        peak = "-" if each.peak is None else f"{each.peak / 1e9:.2f}"
        shape = "x".join(map(str, size))
        row = f"{shape:>10} {method:8} {each.seconds:>8.2f} {each.cpu:>7.2f} {peak:>8}   {bar}"
        print(row.rstrip(), flush=True)
    start, slope, off = line([each for each in taken if each.method == "dense"])
    print(f"dense: {start:.2f} s + {1e6 * slope:.1f} s a million pixels of CPU, within {off:.0%}")
    if file is not None:
        said = {"taken": [asdict(each) for each in taken], "line": [start, slope, off]}
        file.write_text(json.dumps(said | {"passed": all(met)}, indent=1) + "\n")
    return all(met)


def _bar(asked: dict[str, float]) -> str:
    most = f", {asked['bytes'] / 1e9:g} GB" if "bytes" in asked else ""
    return f"{asked['seconds']:g} s{most}"


def main() -> int:
    """Measure one size for `measured`, or all of them; 1 where --strict and a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path)
    parser.add_argument("--strict", action="store_true", help="exit with 1 where a bar is missed")
    parser.add_argument("--one", nargs=3, metavar=("ROW", "WIDTH", "HEIGHT"), help="used inside")
    asked = parser.parse_args()
    if asked.one is None:
        passed = report(suite()["speed"], asked.json)
        return int(asked.strict and not passed)
    method, width, height = asked.one
    found = one(method, (int(width), int(height)))
    if asked.json is not None:
        asked.json.write_text(json.dumps({"seconds": found.seconds, "cpu": found.cpu}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
