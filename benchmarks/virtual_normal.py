"""What the virtual normal loss takes beside its own random gathers; prints JSON.

    python benchmarks/virtual_normal.py [--pairs N] [--batch N] [--size N] [--threads N]

Both draw ⌊0.15 · size²⌋ triangles. One is the loss, forward and backward; the other reads the true
depth, the validity and the predicted depth at the triangles' corners, and scatters a gradient of
the last back to the image, by torch's fastest gather. They run in turn, A B A B; the bar is on the
median of the pairs' ratio of CPU time, which a busy machine changes less than wall clock.
"""

import argparse
import json
from collections.abc import Callable, Sequence
from statistics import median

import torch
from runs import Run, in_turn
from torch import Tensor
from verdict import verdict

from flexdepth.losses.virtual_normal import Triangles, central_camera, drawn, virtual_normal

BAR = 3.0


def scene(batch: int, size: int) -> tuple[Tensor, Tensor, Tensor]:
    """Return a wavy true depth, a noisy prediction of it and what is valid."""
    generator = torch.Generator().manual_seed(0)
    down, across = torch.meshgrid(*[torch.linspace(0, 1, size)] * 2, indexing="ij")
    one = 0.3 + 0.2 * across + 0.1 * (6 * down).sin() + 0.05 * (9 * across).cos()
    truth = one.expand(batch, size, size).contiguous()
    depth = truth * (1 + 0.05 * torch.randn(truth.shape, generator=generator))
    return depth.requires_grad_(True), truth, torch.rand(truth.shape, generator=generator) < 0.95


def works(batch: int, size: int) -> tuple[Callable[[], object], Callable[[], object]]:
    """Return the loss and its gathers."""
    depth, truth, valid = scene(batch, size)
    generator, triangles = torch.Generator().manual_seed(1), Triangles()
    camera = central_camera(519.0, depth)

    def loss() -> object:
        corners = drawn(size, size, triangles.share, generator)
        value = virtual_normal(depth, truth, valid, camera, corners, triangles)
        return torch.autograd.grad(value, depth)

    gradient = torch.rand(batch, 3 * int(triangles.share * size**2))

    def gathers() -> object:
        places = drawn(size, size, triangles.share, generator).flatten().expand(batch, -1)
        _, _, z = (x.flatten(1).gather(1, places) for x in (truth, valid, depth))
        return torch.autograd.grad(z, depth, gradient)

    return loss, gathers


def milliseconds(runs: Sequence[Run]) -> dict[str, float]:
    """Return the median wall clock and CPU time."""
    cpu = median(run.cpu or 0.0 for run in runs)
    return {
        "wall_ms": round(1e3 * median(run.wall for run in runs), 3),
        "cpu_ms": round(1e3 * cpu, 3),
    }


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    for name, default in (("pairs", 30), ("batch", 4), ("size", 384), ("threads", 1)):
        parser.add_argument(f"--{name}", type=int, default=default)
    asked = parser.parse_args()
    torch.set_num_threads(asked.threads)
    losses, gathers = in_turn(*works(asked.batch, asked.size), asked.pairs)
    both = list(zip(losses, gathers, strict=True))
    ratio = median((a.cpu or 0.0) / (b.cpu or 1.0) for a, b in both)
    found = {
        "batch": asked.batch,
        "size": asked.size,
        "threads": asked.threads,
        "loss": milliseconds(losses),
        "gathers": milliseconds(gathers),
        "cpu_ratio": round(ratio, 2),
        "wall_ratio": round(median(a.wall / b.wall for a, b in both), 2),
        "bar": BAR,
        "verdict": verdict(ratio <= BAR),
    }
    print(json.dumps(found, indent=2))


if __name__ == "__main__":
    main()
