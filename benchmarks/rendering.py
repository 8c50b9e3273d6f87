"""CPU seconds that `flexdepth synth` takes for an image of each kind of world.

    .venv/bin/python benchmarks/rendering.py [--scenes 4] [--strict]

The clock counts the process's own time, so that other work on the machine matters little. A scene
is built once and seen from `VIEWS` viewpoints, as the command does it. The mean over the kinds, by
their shares in a world, stands beside what is asked of it (bars.py).
"""

import argparse
import os
import sys
import time

# Before numpy is loaded: one image is one core's work.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from bars import IMAGE_SECONDS, Bar, written
from verdict import verdict

from flexdepth.synth.generate import VIEWS, SynthSettings, taken
from flexdepth.synth.library import Library
from flexdepth.synth.render import worth_taking
from flexdepth.synth.stage import Stage
from flexdepth.synth.viewpoints import viewpoint
from flexdepth.synth.worlds import INDOORS, OUTDOORS, Make

SIZE = 256, 192
"""Pixels of an image, width and height."""

_ATTEMPTS = 40


def image_seconds(make: Make, library: Library, scenes: int) -> tuple[float, float, float]:
    """Return CPU seconds an image: the scene's share, viewpoints and picture; and triangles."""
    building, taking, triangles, images = 0.0, 0.0, 0, 0
    aspect = SIZE[0] / SIZE[1]
    for number in range(scenes):
        rng = np.random.default_rng([1, number])
        start = time.process_time()
        stage = Stage.built(rng, make(rng), library)
        built = time.process_time()
        building += built - start
        triangles += len(stage.uv)
        for _ in range(VIEWS):
            for _ in range(_ATTEMPTS):
                view = viewpoint(rng, stage.scene, aspect)
                if worth_taking(stage, view, aspect):
                    taken(rng, stage, view, SIZE)
                    images += 1
                    break
        taking += time.process_time() - built
    return building / max(images, 1), taking / max(images, 1), triangles / scenes


def main() -> int:
    """Print a row for each kind, and the mean over a world with the default shares."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=4, help="scenes of each kind")
    parser.add_argument("--strict", action="store_true", help="exit with 1 where the bar is missed")
    options = parser.parse_args()
    library = Library.made(np.random.default_rng(0), 4)
    print(f"CPU seconds an image of {SIZE[0]}x{SIZE[1]}, {options.scenes} scenes of a kind\n")
    print("| kind | scene | picture | together | triangles |\n|---|---|---|---|---|")
    outdoor = SynthSettings().outdoor_share
    mean = 0.0
    for table, part in ((INDOORS, 1 - outdoor), (OUTDOORS, outdoor)):
        total = sum(share for share, _ in table)
        for share, make in table:
            scene, picture, triangles = image_seconds(make, library, options.scenes)
            mean += part * share / total * (scene + picture)
            numbers = f"{scene:.2f} | {picture:.2f} | {scene + picture:.2f} | {triangles:.0f}"
            print(f"| {make.__name__} | {numbers} |", flush=True)
    bar = Bar("CPU seconds an image, mean by the kinds' shares", mean, IMAGE_SECONDS)
    print(f"\n{bar.name}  asked {bar.limit}  measured {written(mean)}  {verdict(bar.met)}")
    return int(options.strict and not bar.met)


if __name__ == "__main__":
    sys.exit(main())
