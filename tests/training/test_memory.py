import pytest
import torch

from flexdepth.runtime.errors import InputError
from flexdepth.training.batches import BatchSettings
from flexdepth.training.loop import LoopSettings
from flexdepth.training.memory import memory_told

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
