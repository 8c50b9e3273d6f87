"""Size and speed of the EDRB network and of the ways to make it smaller.

    python benchmarks/edrb_variants.py [--height N] [--width N] [--runs N] [--share N]

Prints JSON: for the network as described, with grouped branches, with the smallest weights of all
set to zero and with the weakest channels of every branch taken out, the parameters, how many are
not zero, the multiplications for one image and the seconds of one prediction. The networks are
not trained: this is about what they cost, not about what they see. The time is the least of
several runs, which take turns.
"""

import argparse
import json
import sys
import time

import torch
from torch import nn

from flexdepth.networks.edrb import EDRB, EDRBNetwork, Rows
from flexdepth.networks.extended import GroupedBranch
from flexdepth.networks.parts import parts
from flexdepth.networks.pruning import SmallestWeights, WeakestChannels


def variants(share: float) -> dict[str, EDRBNetwork]:
    """Return the networks by name; pruning leaves out `share`."""
    dense = EDRB().build().eval()
    zeros = EDRB().build().eval()
    weights = SmallestWeights(share)
    weights.prune(zeros)
    weights.settle(zeros)
    return {
        "as described": dense,
        "grouped (ResNeXt)": EDRB(rows=Rows().made_of(GroupedBranch())).build().eval(),
        f"smallest {share:.0%} of weights zero": zeros,
        f"weakest {share:.0%} of channels out": WeakestChannels(share).pruned(dense).eval(),
    }


def seconds(network: nn.Module, image: torch.Tensor) -> float:
    """Return how long one prediction takes."""
    start = time.perf_counter()
    with torch.no_grad():
        network(image)
    return time.perf_counter() - start


def main() -> int:
    """Print the measurements."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--height", type=int, default=193)
    parser.add_argument("--width", type=int, default=257)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--share", type=float, default=0.5)
    asked = parser.parse_args()
    networks = variants(asked.share)
    image = torch.rand(1, 3, asked.height, asked.width)
    times: dict[str, list[float]] = {name: [] for name in networks}
    for _ in range(asked.runs):
        for name, network in networks.items():
            times[name].append(seconds(network, image))
    found = {
        name: {
            "parameters": sum(p.numel() for p in network.parameters()),
            "not_zero": sum(int(p.count_nonzero()) for p in network.parameters()),
            "gigamacs": round(
                parts(network.settings, asked.width, asked.height)[0].multiplications / 1e9, 1
            ),
            "seconds": round(min(times[name]), 2),
        }
        for name, network in networks.items()
    }
    print(json.dumps({**vars(asked), "threads": torch.get_num_threads(), "networks": found}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
