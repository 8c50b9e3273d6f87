"""Whether the network waits for its batches: the share of a run spent in forward, backward, step.

    python benchmarks/loading.py [--iterations N] [--images N] [--processes N] [--threads N]

Renders images with `flexdepth synth` and trains the experiment `compact` on them from random
weights, on the CPU. An iteration lasts from the end of the one before to its own end. Of it count
what lies between the image's entry into the network and the end of the optimiser's step; `waiting`
is what lies before, until there is a batch, and `averaging` what lies after. The first iterations,
in which the loading process starts, are left out. Prints JSON; the bar is on the share.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import torch

from flexdepth.data import Folder
from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.training.loop import Run, Sources, train

BAR = 0.9
LEFT_OUT = 6
"""Iterations; more than a loading process makes in advance."""


@dataclass(eq=False)
class Watch:
    """The moments at which each iteration began to compute, had stepped and ended."""

    began: list[float] = field(default_factory=list)
    stepped: list[float] = field(default_factory=list)
    ended: list[float] = field(default_factory=list)

    def iteration(self, *_: object) -> None:
        """Note the end of an iteration."""
        self.ended.append(time.perf_counter())

    def scores(self, *_: object) -> None:
        """Do nothing: the run is over."""

    def shares(self) -> dict[str, float]:
        """Return what part of the time went where."""
        columns = self.ended[:-1], self.began[1:], self.stepped[1:], self.ended[1:]
        moments = list(zip(*columns, strict=True))[LEFT_OUT:]
        total = moments[-1][3] - moments[0][0]
        return {
            "seconds_per_iteration": round(total / len(moments), 3),
            "share": round(sum(step - begin for _, begin, step, _ in moments) / total, 4),
            "waiting": round(sum(begin - before for before, begin, _, _ in moments) / total, 4),
            "averaging": round(sum(end - step for _, _, step, end in moments) / total, 4),
        }


def watched(root: Path, iterations: int, processes: int) -> dict[str, float]:
    """Return the shares of a run on the pairs in a folder."""
    compact = CATALOGUE["compact"]
    total = iterations + LEFT_OUT + 1
    settings = replace(compact.loop, iterations=total, save_every=total)
    torch.manual_seed(0)
    network = compact.network.build().to(memory_format=torch.channels_last)
    run, watch, pairs = Run.started(network, settings), Watch(), Folder(root).load()
    network.register_forward_pre_hook(lambda *_: watch.began.append(time.perf_counter()))
    run.optimiser.register_step_post_hook(lambda *_: watch.stepped.append(time.perf_counter()))
    train(run, settings, compact.terms, Sources(pairs, pairs, processes), watch, lambda *_: None)
    return watch.shares()


def main() -> int:
    """Print the measurement, and return 1 if it is below the bar."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--iterations", type=int, default=60)
    parser.add_argument("--images", type=int, default=64)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--threads", type=int, default=torch.get_num_threads())
    asked = parser.parse_args()
    torch.set_num_threads(asked.threads)
    with tempfile.TemporaryDirectory() as folder:
        synth = [sys.executable, "-m", "flexdepth", "synth", "-o", folder, "-n", str(asked.images)]
        subprocess.run(synth, check=True, stdout=subprocess.DEVNULL)
        load = os.getloadavg()[0]
        found = watched(Path(folder), asked.iterations, asked.processes)
    cores = {"cores": os.cpu_count(), "load_before": round(load, 1)}
    print(json.dumps({**vars(asked), **cores, **found, "bar": BAR}))
    return int(found["share"] < BAR)


if __name__ == "__main__":
    sys.exit(main())
