"""CPU seconds that `flexdepth synth` takes for an image of each kind of world.

    .venv/bin/python benchmarks/rendering.py [--scenes 4] [--width 256] [--height 192]

The clock counts the process's own time, so that other work on the machine matters little. A scene
is built once and seen from `VIEWS` viewpoints, as the command does it.
"""

import argparse
import os
import sys
import time

# Before numpy is loaded: one image is one core's work.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from flexdepth.synth.generate import VIEWS, SynthSettings
from flexdepth.synth.lens import photograph
from flexdepth.synth.library import Library
from flexdepth.synth.render import render, worth_taking
from flexdepth.synth.stage import Stage
from flexdepth.synth.viewpoints import viewpoint
from flexdepth.synth.worlds import INDOORS, OUTDOORS, Make

_ATTEMPTS = 40


def image_seconds(
    make: Make, library: Library, scenes: int, size: tuple[int, int]
) -> tuple[float, float, float]:
    """Return CPU seconds an image: the scene's share, viewpoints and picture; and triangles."""
    building, taking, triangles, images = 0.0, 0.0, 0, 0
    width, height = size
    for number in range(scenes):
        rng = np.random.default_rng([1, number])
        start = time.process_time()
        stage = Stage.built(rng, make(rng), library)
        built = time.process_time()
        building += built - start
        triangles += len(stage.uv)
        for _ in range(VIEWS):
            for _ in range(_ATTEMPTS):
                view = viewpoint(rng, stage.scene, width / height)
                if worth_taking(stage, view, width / height):
                    seen = render(rng, stage, view, width, height)
                    photograph(rng, seen.light, seen.depth, seen.focal)
                    images += 1
                    break
        taking += time.process_time() - built
    return building / max(images, 1), taking / max(images, 1), triangles / scenes


def main() -> int:
    """Print a row for each kind, and the mean over a world with the default shares."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=4, help="scenes of each kind")
    parser.add_argument("--width", type=int, default=256)
    parser.add_argument("--height", type=int, default=192)
    asked = parser.parse_args()
    library = Library.made(np.random.default_rng(0), 4)
    write = sys.stdout.write
    write(
        f"CPU seconds an image of {asked.width}x{asked.height}, {asked.scenes} scenes of a kind\n\n"
    )
    write("| kind | scene | picture | together | triangles |\n|---|---|---|---|---|\n")
    outdoor = SynthSettings().outdoor_share
    mean = 0.0
    for table, part in ((INDOORS, 1 - outdoor), (OUTDOORS, outdoor)):
        total = sum(share for share, _ in table)
        for share, make in table:
            scene, picture, triangles = image_seconds(
                make, library, asked.scenes, (asked.width, asked.height)
            )
            mean += part * share / total * (scene + picture)
            write(
                f"| {make.__name__} | {scene:.2f} | {picture:.2f} | {scene + picture:.2f} "
                f"| {triangles:.0f} |\n"
            )
            sys.stdout.flush()
    write(f"| a world with the default shares | | | {mean:.2f} | |\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
