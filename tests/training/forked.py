"""Trains in processes of its own: two together, and one that is killed; `forked` starts it.

It is a script, for it forks: a process that has computed with threads must not. What it leaves in
its folder, conftest.py says.
"""

import json
import os
import random
import signal
import socket
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
import torch._dynamo  # As the first step of an optimiser does, but once for all processes.
from PIL import Image
from torch import nn

from flexdepth.data.folder import Folder
from flexdepth.experiments.experiment import Experiment, Trained
from flexdepth.experiments.run import run_experiment
from flexdepth.losses import Silog
from flexdepth.networks.compact import Compact
from flexdepth.networks.encoders import Encoder
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.files import write_depth
from flexdepth.sample import Prediction
from flexdepth.training.batches import BatchSettings
from flexdepth.training.checkpoint import save
from flexdepth.training.loop import LoopSettings, Run, Sources, train
from flexdepth.training.objective import Term
from flexdepth.training.optimiser import AdamWCosine, SGDPolynomial
from flexdepth.training.processes import joined
from flexdepth.training.record import Silence

TOGETHER = LoopSettings(
    iterations=6,
    save_every=3,
    batches=BatchSettings(size=4, shapes=((32, 32), (64, 32))),
    # Plain steps: those of AdamW do not see the gradient's length.
    optimiser=SGDPolynomial(rate=0.1, weight_decay=0.0),
)
STILL = replace(
    TOGETHER, iterations=12, patience=1, optimiser=SGDPolynomial(rate=0.0, weight_decay=0.0)
)
INTERRUPTED = Experiment(
    network=Compact(encoder=Encoder("test_efficientnet"), widths=(8, 8, 8, 8)),
    loop=LoopSettings(
        iterations=6,
        save_every=2,
        batches=BatchSettings(size=2, shapes=((64, 32), (64, 64))),
        optimiser=AdamWCosine(rate=0.01, warm_up=2),
    ),
)


class TwoConvolutions(nn.Module):
    """Without a normalisation, which would see the share of a process alone."""

    def __init__(self):
        super().__init__()
        self.encoder = nn.Conv2d(3, 4, 3)
        self.decoder = nn.Conv2d(4, 1, 3)

    def forward(self, image):
        features = self.encoder(nn.functional.pad(image, (2, 2, 2, 2))).relu()
        return Prediction(self.decoder(features)[:, 0].exp(), canonical_focal=0.8)


def forked(environment, work, *arguments):
    """Return the number of a new process that does some work."""
    number = os.fork()
    if number:
        return number
    os.environ.update(environment)
    work(*arguments)
    os._exit(0)


def ended(number):
    _, status = os.waitpid(number, 0)
    return os.waitstatus_to_exitcode(status)


def in_two_processes(work, *arguments):
    with socket.socket() as free:
        free.bind(("localhost", 0))
        address = {"MASTER_ADDR": "localhost", "MASTER_PORT": str(free.getsockname()[1])}
    places = [{"WORLD_SIZE": "2", "RANK": rank, "LOCAL_RANK": rank, **address} for rank in "01"]
    both = [forked(place, work, *arguments) for place in places]
    if [ended(number) for number in both] != [0, 0]:
        raise SystemExit(1)


def write_pairs(root):
    (root / "image").mkdir(parents=True)
    camera = Intrinsics.centred(64, 48, 56.0, FocalSource.GIVEN)
    for number in range(4):
        image = np.random.default_rng(number).integers(0, 255, (48, 64, 3), np.uint8)
        Image.fromarray(image).save(root / "image" / f"{number}.png")
        depth = (1 + number + 0.01 * image.mean(2)).astype(np.float32)
        write_depth(root / "depth" / f"{number}.npz", DepthMap(depth, Space.METRIC, camera), None)


def train_two_convolutions(folder, settings=TOGETHER, name=""):
    pairs, scores, seen = Folder(folder / "pairs").load(), [], []
    torch.manual_seed(0)
    with joined() as place:
        run = Run.started(TwoConvolutions(), settings, place)
        run.network.register_forward_pre_hook(lambda _, images: seen.append(len(images[0])))
        terms = {"silog": Term(Silog(0.5))}
        sources = Sources(pairs, pairs, 0)
        train(run, settings, terms, sources, Silence(), lambda _, score: scores.append(score))
        places = [place.rank, place.count]
        found = run.checkpoint({"scores": scores, "places": places, "seen": seen})
        save(folder / f"{name}{place.count}-{place.rank}.safetensors", found)


def train_and_say(experiment, folder):
    with (folder / f"said-{os.environ['RANK']}.txt").open("w") as file:
        run_experiment(experiment, folder / "spoken", 0, lambda line: file.write(line + "\n"))


def train_to_death(experiment, folder, dies_at=0, after=False):
    """Train, and die before or after the file of this number, counted from 1, gets its name."""
    written, rename = [], os.replace

    def deadly(*paths):
        written.append(paths)
        if len(written) == dies_at and not after:
            os.kill(os.getpid(), signal.SIGKILL)
        rename(*paths)
        if len(written) == dies_at:
            os.kill(os.getpid(), signal.SIGKILL)

    os.replace = deadly
    run_experiment(experiment, folder, 0, lambda _line: None)


def killed_at_files(experiment, folder):
    """Train in processes that die at the first, the second, the third file; return how many."""
    deaths = 0
    for number in (1, 2, 3):
        for after in (False, True):
            deaths += ended(forked({}, train_to_death, experiment, folder, number, after)) < 0
    if ended(forked({}, train_to_death, experiment, folder)):
        raise SystemExit(1)
    return deaths


def killed_at_random(experiment, folder, seconds):
    """Train in processes killed long before `seconds`, which is enough for all; return how many."""
    deaths, rng = 0, random.Random(0)
    for _ in range(5):
        number = forked({}, train_to_death, experiment, folder)
        time.sleep(rng.uniform(0, seconds / 3))
        os.kill(number, signal.SIGKILL)
        deaths += ended(number) < 0
    if ended(forked({}, train_to_death, experiment, folder)):
        raise SystemExit(1)
    return deaths


def main():
    folder = Path(sys.argv[1])
    write_pairs(folder / "pairs")
    in_two_processes(train_two_convolutions, folder)
    in_two_processes(train_two_convolutions, folder, STILL, "still-")
    train_two_convolutions(folder)

    pairs, start = Folder(folder / "pairs"), folder / "start.safetensors"
    experiment = replace(INTERRUPTED, data=pairs, held_out=pairs, start=Trained(start))
    save(start, Run.started(experiment.network.build(), experiment.loop).checkpoint({}))
    short = replace(experiment, loop=replace(experiment.loop, iterations=2))
    in_two_processes(train_and_say, short, folder)
    begin = time.monotonic()
    train_to_death(experiment, folder / "straight")
    seconds = time.monotonic() - begin
    deaths = {
        "files": killed_at_files(experiment, folder / "files"),
        "random": killed_at_random(experiment, folder / "random", seconds),
    }
    sys.stdout.write(json.dumps(deaths))


if __name__ == "__main__":
    main()
