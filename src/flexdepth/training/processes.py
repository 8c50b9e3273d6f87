"""The processes that train one network together, and the device of each.

`torchrun --nproc-per-node N -m flexdepth train ...` starts N of them and says to each, in its
environment, which one it is. What is global, torch's process group, is opened and closed here.
"""

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import timedelta

import torch
from torch import Tensor, distributed

from flexdepth.runtime.errors import InputError

PATIENCE = timedelta(hours=2)
"""How long a process waits for the others; torchrun ends all of them as soon as one has failed."""


@dataclass(frozen=True)
class Place:
    """One process among those that train together.

    Attributes:
        rank: Its number; the first writes and speaks for all.
        count: How many there are.
        device: Where it computes, as torch names it.
    """

    rank: int = 0
    count: int = 1
    device: str = "cpu"

    @property
    def first(self) -> bool:
        """Whether this one writes and speaks."""
        return self.rank == 0

    def average(self, tensors: Iterable[Tensor]) -> None:
        """Give each tensor the mean of what it is in all processes, the same bits in each.

        Args:
            tensors: Of one dtype, of the same shapes in the same order in every process.
        """
        if self.count == 1:
            return
        each = list(tensors)
        together = torch.cat([tensor.detach().flatten() for tensor in each])
        distributed.all_reduce(together)
        means = torch.split(together / self.count, [tensor.numel() for tensor in each])
        with torch.no_grad():
            for tensor, mean in zip(each, means, strict=True):
                tensor.copy_(mean.view(tensor.shape))

    def summed(self, numbers: Sequence[float]) -> list[float]:
        """Return the sum over all processes of each number."""
        if self.count == 1:
            return list(numbers)
        together = torch.tensor(numbers, dtype=torch.float64, device=self.device)
        distributed.all_reduce(together)
        sums: list[float] = together.tolist()
        return sums


ALONE = Place()
"""The only process, on the CPU."""


@contextmanager
def joined() -> Iterator[Place]:
    """Give this process's place among those that torchrun has started; alone without torchrun.

    Each computes on a GPU of its own where there are GPUs, and speaks NCCL; else on the CPU, and
    speaks gloo.

    Raises:
        InputError: There are GPUs, but fewer than processes.
    """
    count = int(os.environ.get("WORLD_SIZE", "1"))
    device = _device(int(os.environ.get("LOCAL_RANK", "0")))
    if count == 1:
        yield Place(device=device)
        return
    distributed.init_process_group("gloo" if device == "cpu" else "nccl", timeout=PATIENCE)
    try:
        yield Place(distributed.get_rank(), count, device)
    finally:
        distributed.destroy_process_group()


def _device(number: int) -> str:
    if not torch.cuda.is_available():
        return "cpu"
    if number >= torch.cuda.device_count():
        raise InputError(
            f"one GPU for each process of a machine was wanted, got {torch.cuda.device_count()} "
            f"GPUs for process {number}; start fewer with --nproc-per-node"
        )
    torch.cuda.set_device(number)
    return f"cuda:{number}"
