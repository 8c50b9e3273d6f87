"""Memory of attention from every pixel to every pixel, forward and backward.

    python benchmarks/nonlocal_memory.py [--rows N] [--side N] [--width N] [--batch N]

Prints JSON. By default the merge NS7 at a quarter of 384 x 384: 9,216 positions of 256 channels,
whose matrix of similarities alone has 340 MB. `extra_megabytes` is how far the peak of the process
rises above what it held with the features, their gradients and the module in place; the bar is
2,000. POSIX only, for the peak is read with getrusage.
"""

import argparse
import json
import resource
import sys
import time

import torch

from flexdepth.networks.conventional import NonLocalPlusChannelAttention
from flexdepth.networks.merge import Merge

BAR = 2000.0
"""Megabytes."""


def peak_megabytes() -> float:
    """Return the most memory that this process has held so far."""
    scale = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale / 1e6


def measured(merge: Merge, batch: int, width: int, side: int) -> dict[str, float]:
    """Return the memory and the time of one forward and backward pass."""
    lateral, decoder = (torch.randn(batch, width, side, side, requires_grad=True) for _ in range(2))
    for features in (lateral, decoder):
        features.grad = torch.ones_like(features)
    before, start = peak_megabytes(), time.perf_counter()
    merged, _ = merge(lateral, decoder)
    merged.square().mean().backward()
    seconds = time.perf_counter() - start
    return {"extra_megabytes": round(peak_megabytes() - before, 1), "seconds": round(seconds, 1)}


def main() -> int:
    """Print the measurement, and return 1 if it is beyond the bar."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--rows", type=int, default=NonLocalPlusChannelAttention().rows)
    parser.add_argument("--side", type=int, default=96)
    parser.add_argument("--width", type=int, default=256)
    parser.add_argument("--batch", type=int, default=1)
    asked = parser.parse_args()
    merge = Merge(NonLocalPlusChannelAttention(rows=asked.rows), asked.width, asked.width)
    measured(merge, 2, asked.width, 4)
    found = measured(merge, asked.batch, asked.width, asked.side)
    print(json.dumps({"positions": asked.side**2, **vars(asked), **found, "bar": BAR}))
    return int(found["extra_megabytes"] > BAR)


if __name__ == "__main__":
    sys.exit(main())
