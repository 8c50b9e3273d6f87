"""How long scoring takes, and how much memory: predictions of KITTI's size, read from disk.

    python benchmarks/scoring.py [--images 697] [--json]

Makes pictures of 1242 x 375 with laser-like depth in 16-bit PNG, and predictions of them as npz,
16-bit PNG and npy; scores them under `kitti-eigen-garg-bts`, once all of them and once a
quarter, each in a process of its own. CPU time is that of the process, its reading threads
included: what must be under 60 s on two cores takes at most twice as much of it, and on one core as
many seconds as it says. The peak of memory must not depend on how many images there are.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from flexdepth.data.read import opencv_camera
from flexdepth.data.stored import Codes, StoredPair, StoredPairs
from flexdepth.evaluation.catalogue import protocol_named
from flexdepth.evaluation.evaluate import evaluate
from flexdepth.evaluation.predictions import prediction_folder
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.files import SUFFIXES, write_depth

IMAGES, WIDTH, HEIGHT = 697, 1242, 375
FORMATS = ("npz", "png16", "npy")
DIFFERENT = 8
"""So many files are made; the others are links to them, and are read and decoded all the same."""
CAMERA = opencv_camera((721.5377, 721.5377), (609.5593, 172.854))


@dataclass(frozen=True)
class Cost:
    """What scoring took: seconds of CPU time and of the clock, and MB at the peak."""

    images: int
    format: str
    cpu_seconds: float
    seconds: float
    peak_mb: float


def make(folder: Path, images: int) -> None:
    """Write pictures, depth and predictions."""
    generator = np.random.default_rng(0)
    rows = np.arange(HEIGHT)[:, None] + 0.5
    for number in range(images):
        name = f"{number:010d}"
        places = {
            "image": folder / "image" / f"{name}.png",
            "depth": folder / "depth" / f"{name}.png",
            **{kind: folder / kind / f"{name}{SUFFIXES[kind]}" for kind in FORMATS},
        }
        for path in places.values():
            path.parent.mkdir(parents=True, exist_ok=True)
            for source in path.parent.glob(f"{number % DIFFERENT:010d}.*"):
                if number >= DIFFERENT:
                    os.link(source, path.with_suffix(source.suffix))
        if number < DIFFERENT:
            _make_one(places, rows, generator)


def _make_one(places: dict[str, Path], rows: np.ndarray, generator: np.random.Generator) -> None:
    noise = generator.integers(0, 60, (HEIGHT, WIDTH, 3), np.uint8)
    Image.fromarray((rows[..., None] / 2).astype(np.uint8) + noise).save(places["image"])
    depth = 1.65 * 721.5377 / np.maximum(rows - 170 + generator.normal(0, 3, (1, WIDTH)), 15)
    measured = generator.random((HEIGHT, WIDTH)) < 0.2
    Image.fromarray((depth * measured * 256).round().astype(np.uint16)).save(places["depth"])
    said = (depth * generator.normal(1, 0.05, depth.shape)).astype(np.float32)
    for kind in FORMATS:
        write_depth(places[kind], DepthMap(np.maximum(said, 1), Space.METRIC, CAMERA))


def score(folder: Path, kind: str, images: int) -> Cost:
    """Score the first images of a folder, in this process."""
    pairs = StoredPairs(
        tuple(
            StoredPair(path.stem, path, Codes(folder / "depth" / path.name, 256.0), CAMERA)
            for path in sorted((folder / "image").iterdir())[:images]
        )
    )
    cpu, clock = time.process_time(), time.monotonic()
    predictions = prediction_folder(folder / kind)
    evaluate(pairs, predictions, protocol_named("kitti-eigen-garg-bts"), lambda _done: None)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    per_mb = 1e6 if sys.platform == "darwin" else 1e3
    return Cost(images, kind, time.process_time() - cpu, time.monotonic() - clock, peak / per_mb)


def measured(folder: Path, kind: str, images: int) -> Cost:
    """Score in a process of its own, whose memory is nobody else's."""
    command = [sys.executable, __file__, "--score", str(folder), kind, "--images", str(images)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return Cost(**json.loads(done.stdout))


def main() -> int:
    """Measure, print, return the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--images", type=int, default=IMAGES, help=f"default: {IMAGES}")
    parser.add_argument("--json", action="store_true", help="print JSON instead of the table")
    parser.add_argument("--score", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.score:
        folder, kind = options.score
        print(json.dumps(asdict(score(Path(folder), kind, options.images))))
        return 0
    with tempfile.TemporaryDirectory() as made:
        make(Path(made), options.images)
        costs = [
            measured(Path(made), kind, images)
            for kind in FORMATS
            for images in (max(options.images // 4, 1), options.images)
        ]
    if options.json:
        print(json.dumps([asdict(cost) for cost in costs], indent=2))
        return 0
    print(f"{'predictions':<14}{'images':>8}{'CPU s':>8}{'clock s':>9}{'peak MB':>9}")
    for cost in costs:
        numbers = f"{cost.cpu_seconds:>8.1f}{cost.seconds:>9.1f}{cost.peak_mb:>9.0f}"
        print(f"{cost.format:<14}{cost.images:>8}{numbers}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
