"""What to do where memory is short, and how not to wait for it."""

import ctypes
import platform
from collections.abc import Iterator
from contextlib import contextmanager
from math import prod

import torch

from flexdepth.runtime.errors import InputError
from flexdepth.training.loop import LoopSettings

_SHORT = ("can't allocate memory", "Unable to allocate")
"""What torch's CPU allocator and NumPy say; of a GPU's memory torch has an exception."""

_KILLED = ("is killed by signal", "exited unexpectedly")
"""What torch says of a loading process that the system has ended."""


_TRIM_THRESHOLD, _TOP_PAD, _MMAP_MAX = -1, -2, -4
"""What glibc's `mallopt` calls its settings, from malloc.h."""

_NEVER = -1
_AT_A_TIME = 2**28
"""Bytes that the heap grows by at least."""


def keep_freed_memory() -> bool:
    """Let this process keep what it frees for its next iteration; return whether it will.

    glibc gives a freed block of 32 MiB and more back to the system at once, and takes the next one
    as fresh pages, each of which the system clears first: on a CPU that is up to a third of the
    time of an iteration. Memory stays at its peak instead, which the next iteration reaches anyhow.
    With another C library nothing is changed.
    """
    if platform.libc_ver()[0] != "glibc":
        return False
    mallopt = ctypes.CDLL(None).mallopt
    settings = ((_MMAP_MAX, 0), (_TOP_PAD, _AT_A_TIME), (_TRIM_THRESHOLD, _NEVER))
    return all(mallopt(name, value) == 1 for name, value in settings)


@contextmanager
def memory_told(settings: LoopSettings) -> Iterator[None]:
    """Say what to lower where the block runs out of memory.

    Raises:
        InputError: There was too little of it.
    """
    try:
        yield
    except (RuntimeError, MemoryError) as error:
        short = isinstance(error, torch.OutOfMemoryError | MemoryError)
        if short or any(sign in str(error) for sign in _SHORT):
            raise InputError(_advice(settings)) from error
        if any(sign in str(error) for sign in _KILLED):
            raise InputError(
                "a process that loads images has died, as a rule because memory is short; "
                "take fewer of them with --processes, or a smaller --loop.batches.size"
            ) from error
        raise


def _advice(settings: LoopSettings) -> str:
    batches, parts = settings.batches, settings.accumulate
    width, height = max(batches.shapes, key=prod)
    divided = f"{parts} part{'s' if parts > 1 else ''}"
    return (
        f"out of memory with batches of {batches.size} images of up to {width}x{height} in "
        f"{divided}; lower --loop.batches.size or --loop.batches.shapes, or raise "
        f"--loop.accumulate, which divides the same batch into more parts"
    )
