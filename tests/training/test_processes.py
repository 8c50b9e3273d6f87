"""Two processes that speak gloo, as torchrun would have started them."""

import json

import pytest
import torch

from flexdepth.runtime.errors import InputError
from flexdepth.training import processes
from flexdepth.training.batches import BatchSettings
from flexdepth.training.checkpoint import load
from flexdepth.training.loop import LoopSettings, check_shares
from flexdepth.training.processes import ALONE, Place, joined


@pytest.fixture(scope="module")
def ends(forked):
    """Where one process alone and each of two have ended."""
    folder, _ = forked
    return [load(folder / f"{name}.safetensors") for name in ("1-0", "2-0", "2-1")]


def test_two_processes_end_with_the_weights_of_one(ends):
    alone, first, _ = ends
    assert first.settings["places"] == [0, 2]
    for part in ("network", "average"):
        wanted = alone.part(part)
        for name, value in first.part(part).items():
            torch.testing.assert_close(value, wanted[name], atol=1e-5, rtol=0)


def test_each_process_sees_its_share_of_a_batch(ends):
    assert [end.settings["seen"] for end in ends] == [[4] * 6, [2] * 6, [2] * 6]


def test_each_process_has_the_same_bits(ends):
    _, first, second = ends
    assert second.settings["places"] == [1, 2]
    for name, value in first.tensors.items():
        assert torch.equal(value, second.tensors[name]), name


def test_processes_that_share_the_judging_find_one_score(ends):
    alone, first, second = (end.settings["scores"] for end in ends)
    assert len(alone) == 2
    assert first == second == pytest.approx(alone, abs=1e-5)


def test_two_processes_lose_patience_together(forked):
    folder, _ = forked
    for rank in (0, 1):
        end = load(folder / f"still-2-{rank}.safetensors")
        assert end.iteration == 6
        assert len(end.errors) == 2
        assert end.errors[0] == end.errors[1]


def test_only_the_first_of_two_processes_speaks_and_writes(forked):
    folder, _ = forked
    said = [(folder / f"said-{rank}.txt").read_text().splitlines() for rank in (0, 1)]
    assert said[1] == []
    assert [line.split()[0] for line in said[0]] == ["starting", "2/2", "2/2"]
    assert said[0][0].endswith("4 images, 4 held out, on 2 x cpu")
    log = (folder / "spoken" / "log.jsonl").read_text().splitlines()
    entries = [json.loads(line) for line in log]
    assert [entry["iteration"] for entry in entries] == [2, 2]
    assert len(list((folder / "spoken" / "tensorboard").iterdir())) == 1


def test_without_torchrun_a_process_is_alone(monkeypatch):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with joined() as place:
        assert place == ALONE
    tensor = torch.tensor([1.0, 2.0])
    place.average([tensor])
    assert tensor.tolist() == [1.0, 2.0]
    assert place.summed([3.0]) == [3.0]


def test_each_process_takes_a_gpu_and_too_few_are_refused(monkeypatch):
    taken = []
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 2)
    monkeypatch.setattr(torch.cuda, "set_device", taken.append)
    assert [processes._device(number) for number in (0, 1)] == ["cuda:0", "cuda:1"]
    assert taken == [0, 1]
    with pytest.raises(InputError, match="got 2 GPUs for process 2"):
        processes._device(2)


def test_a_batch_that_does_not_divide_is_refused():
    settings = LoopSettings(batches=BatchSettings(size=6), accumulate=2)
    check_shares(settings, Place(2, 3))
    with pytest.raises(InputError, match=r"a batch of 6 does not divide into 4 .* multiple of 4"):
        check_shares(settings, Place(0, 2))
