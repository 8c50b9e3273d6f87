import platform
import subprocess
import sys

import pytest
import torch

from flexdepth.runtime.errors import InputError
from flexdepth.training.batches import BatchSettings
from flexdepth.training.loop import LoopSettings
from flexdepth.training.memory import keep_freed_memory, memory_told

SETTINGS = LoopSettings(batches=BatchSettings(size=16, shapes=((64, 32), (512, 384))), accumulate=2)


def asked_of_torch():
    torch.empty(10**15)


def asked_of_a_gpu():
    raise torch.cuda.OutOfMemoryError("CUDA out of memory. Tried to allocate 20.00 MiB.")


def asked_of_python():
    bytearray(2**62)


def asked_of_numpy_elsewhere():
    raise RuntimeError(
        "Caught MemoryError in DataLoader worker process 0.\nUnable to allocate 9 GiB"
    )


@pytest.mark.parametrize(
    "work", [asked_of_torch, asked_of_a_gpu, asked_of_python, asked_of_numpy_elsewhere]
)
def test_out_of_memory_says_what_to_lower(work):
    with pytest.raises(InputError) as stopped, memory_told(SETTINGS):
        work()
    said = str(stopped.value)
    assert said.startswith("out of memory with batches of 16 images of up to 512x384 in 2 parts")
    for field in ("--loop.batches.size", "--loop.batches.shapes", "--loop.accumulate"):
        assert field in said
    assert "\n" not in said


@pytest.mark.parametrize(
    "message",
    [
        "DataLoader worker (pid 7) is killed by signal: Killed. ",
        "DataLoader worker (pid(s) 7, 8) exited unexpectedly",
    ],
)
def test_a_loading_process_that_was_killed_is_told(message):
    with (
        pytest.raises(InputError, match="take fewer of them with --processes"),
        memory_told(SETTINGS),
    ):
        raise RuntimeError(message)


def test_other_errors_stay_what_they_are():
    with pytest.raises(RuntimeError, match=r"^sizes differ$"), memory_told(SETTINGS):
        raise RuntimeError("sizes differ")


FAULTS = """
import resource
import numpy as np
from flexdepth.training.memory import keep_freed_memory

def faults():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    np.ones(2**24)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

faults()
given_back = faults()
keep_freed_memory()
faults()
print(given_back, faults())
"""
"""An array of 128 MiB, again and again: how many of its pages are fresh."""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another allocator than glibc's")
def test_what_was_freed_is_used_again_without_fresh_pages():
    told = subprocess.run([sys.executable, "-c", FAULTS], capture_output=True, text=True).stdout
    given_back, kept = map(int, told.split())
    assert given_back > 50  # 32,768 pages of 4 KiB, or 64 of 2 MiB
    assert kept <= 5


def test_another_allocator_is_left_alone(monkeypatch):
    monkeypatch.setattr(platform, "libc_ver", lambda: ("", ""))
    assert not keep_freed_memory()
