"""A run that is killed with SIGKILL ends with the bits of one that is not."""

import json

import pytest
import torch

from flexdepth.training.checkpoint import load


@pytest.fixture(params=["files", "random"])
def killed(forked, request):
    folder, deaths = forked
    assert deaths[request.param] >= 2
    return folder / request.param


@pytest.mark.parametrize("name", ["latest.safetensors", "best.safetensors"])
def test_a_killed_run_ends_with_the_same_bits(forked, killed, name):
    wanted, found = load(forked[0] / "straight" / name), load(killed / name)
    assert found.iteration == wanted.iteration
    assert found.settings == wanted.settings
    assert found.errors == wanted.errors
    assert len(found.errors) == found.iteration // 2
    assert found.tensors.keys() == wanted.tensors.keys()
    assert any(name.startswith("optimiser.") for name in found.tensors)
    for tensor, value in wanted.tensors.items():
        assert torch.equal(found.tensors[tensor], value), tensor


def test_a_killed_run_logs_every_validation_once(forked, killed):
    logs = [
        [json.loads(line) for line in (folder / "log.jsonl").read_text().splitlines()]
        for folder in (forked[0] / "straight", killed)
    ]
    wanted, found = ([entry for entry in log if "held_out_abs_rel" in entry] for log in logs)
    assert found == wanted
    assert [entry["iteration"] for entry in found] == [2, 4, 6]
    numbers = [entry["iteration"] for entry in logs[1]]
    assert numbers == sorted(numbers)
    assert numbers[-2:] == [6, 6]


def test_a_killed_run_leaves_no_unfinished_files(killed):
    names = {path.name for path in killed.iterdir()}
    assert names == {"latest.safetensors", "best.safetensors", "log.jsonl", "tensorboard"}
