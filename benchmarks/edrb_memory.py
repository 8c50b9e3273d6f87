"""Memory of one training step of the EDRB network: forward, losses, backward, SGD with momentum.

    python benchmarks/edrb_memory.py [--kept] [--rows N] [--height N] [--width N] [--batch N]

Prints JSON. By default the five rows of the description, 133,638,806 parameters, on two images of
385 x 513, with the activations of every block made again for the backward pass; `--kept` keeps
them. `peak_megabytes` is the most that the whole process ever held, weights, gradients and torch
itself included; the bar is 16,000. POSIX only, for the peak is read with getrusage.
"""

import argparse
import json
import resource
import sys
import time

import torch

from flexdepth.losses.cross_entropy import weighted_cross_entropy
from flexdepth.networks.edrb import EDRB, EDRBNetwork, Rows
from flexdepth.networks.extended import Activations

BAR = 16000.0
"""Megabytes."""


def peak_megabytes() -> float:
    """Return the most memory that this process has held so far."""
    scale = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale / 1e6


def step(network: EDRBNetwork, image: torch.Tensor) -> dict[str, float]:
    """Take a training step, and return what it took."""
    optimiser = torch.optim.SGD(network.parameters(), 1e-5, momentum=0.9, weight_decay=5e-4)
    start = time.perf_counter()
    prediction = network(image)
    valid = torch.ones_like(prediction.depth, dtype=torch.bool)
    labels = torch.full_like(prediction.depth, 70, dtype=torch.long)
    loss = weighted_cross_entropy(prediction.logits, labels, valid, 0.2)
    loss = loss + 25 * (prediction.depth - 0.3).square().mean()
    del prediction, labels, valid
    forward = time.perf_counter() - start
    loss.backward()
    optimiser.step()
    seconds = time.perf_counter() - start
    return {"forward_seconds": round(forward, 1), "seconds": round(seconds, 1)}


def main() -> int:
    """Print the measurement, and return 1 if it is beyond the bar."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--kept", action="store_true", help="keep the activations")
    parser.add_argument("--rows", type=int, default=5)
    parser.add_argument("--height", type=int, default=385)
    parser.add_argument("--width", type=int, default=513)
    parser.add_argument("--batch", type=int, default=2)
    asked = parser.parse_args()
    rows = Rows(widths=(256, *[512] * (asked.rows - 1)))
    activations = Activations.KEPT if asked.kept else Activations.RECOMPUTED
    network = EDRB(rows=rows.with_activations(activations)).build().train()
    before = peak_megabytes()
    took = step(network, torch.rand(asked.batch, 3, asked.height, asked.width))
    peak = peak_megabytes()
    said = {
        "parameters": sum(p.numel() for p in network.parameters()),
        "activations": activations.value,
        **vars(asked),
        "before_megabytes": round(before),
        "peak_megabytes": round(peak),
        **took,
        "threads": torch.get_num_threads(),
        "bar": BAR,
    }
    print(json.dumps(said))
    return int(peak > BAR)


if __name__ == "__main__":
    sys.exit(main())
