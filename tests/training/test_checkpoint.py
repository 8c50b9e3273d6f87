import json
import os
import subprocess
from pathlib import Path

import pytest
import torch
from safetensors import safe_open
from safetensors.torch import save_file
from torch import nn
from torch.testing import assert_close

from flexdepth.experiments.experiment import CODEC, Experiment
from flexdepth.losses import Silog
from flexdepth.runtime.errors import InputError
from flexdepth.training import checkpoint
from flexdepth.training.checkpoint import Checkpoint, load, progress, restore, save, source
from flexdepth.training.loop import LoopSettings, Run
from flexdepth.training.objective import Term
from flexdepth.training.optimiser import AdamWCosine

RECORDED = {
    "first.safetensors": "",
    "with_source.safetensors": ("flexdepth 0.1.0, commit 64456552f2cfec54c51b013ece8bb51b0e64004e"),
}
"""Files that were left by runs of two iterations, and the code that they name."""


def test_a_checkpoint_comes_back_to_the_bit(tmp_path):
    path = tmp_path / "a.safetensors"
    weights = {"network.x": torch.randn(3, 2), "average.x": torch.randn(1)}
    save(path, Checkpoint(7, {"seed": 1}, weights, errors=(0.1, 1 / 3)))
    found = load(path)
    assert (found.iteration, found.settings) == (7, {"seed": 1})
    assert list(found.errors) == [0.1, 1 / 3]
    assert torch.equal(found.part("network")["x"], weights["network.x"])
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(os.name == "nt", reason="Windows has other permissions")
def test_a_checkpoint_may_be_read_by_whoever_may_read_other_files(tmp_path):
    ordinary = tmp_path / "ordinary"
    ordinary.touch()
    save(tmp_path / "a.safetensors", Checkpoint(1, {}, {"network.x": torch.zeros(1)}))
    assert (tmp_path / "a.safetensors").stat().st_mode == ordinary.stat().st_mode


@pytest.mark.parametrize("content", [b"", b"garbage", b"\x80\x04\x95pickle", b"\xff" * 64])
def test_a_file_that_is_no_checkpoint_is_refused(tmp_path, content):
    path = tmp_path / "a.safetensors"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.safetensors: not a readable safetensors file"):
        load(path)


@pytest.mark.parametrize(
    "words",
    [
        {"iteration": "soon"},
        {"settings": "{"},
        {"settings": "[1]"},
        {"errors": "x"},
        {"errors": "3"},
        {"errors": '[["a"]]'},
    ],
    ids=str,
)
def test_a_checkpoint_whose_words_are_damaged_is_refused(tmp_path, words):
    path = tmp_path / "a.safetensors"
    save(path, Checkpoint(1, {}, {"network.x": torch.zeros(1)}))
    with safe_open(path, "pt") as file:
        whole = file.metadata()
    save_file({"network.x": torch.zeros(1)}, path, metadata={**whole, **words})
    with pytest.raises(InputError, match=r"a\.safetensors: "):
        load(path)
    if "errors" not in words:
        with pytest.raises(InputError, match=r"a\.safetensors: "):
            progress(path)


def test_a_missing_checkpoint_is_named(tmp_path):
    with pytest.raises(InputError, match="no such checkpoint"):
        load(tmp_path / "none.safetensors")


def test_weights_of_another_network_are_refused_with_the_names_that_differ():
    weights = {"weight": torch.zeros(2, 2), "extra": torch.zeros(1)}
    with pytest.raises(InputError, match=r"missing \['bias'\], unknown \['extra'\].*\['weight'\]"):
        restore(nn.Linear(3, 1), weights, "run")


def test_of_many_names_that_differ_the_first_are_said_and_the_others_counted():
    weights = {f"weight{number}": torch.zeros(1) for number in range(8)}
    with pytest.raises(InputError, match=r"unknown \['weight0', 'weight1', 'weight2'\] and 5 more"):
        restore(nn.Linear(3, 1), weights, "run")


@pytest.fixture(params=RECORDED)
def recorded(request):
    return Path(__file__).parent / "recorded" / request.param


def said(plain, file):
    """Return whether the settings say all that a file says, whatever else they have come to say."""
    if isinstance(file, dict):
        return all(name in plain and said(plain[name], value) for name, value in file.items())
    return plain == file


def test_a_checkpoint_of_an_older_version_is_read(recorded):
    found = load(recorded)
    assert (found.iteration, found.source) == (2, RECORDED[recorded.name])
    experiment = CODEC.restored(Experiment, found.settings, "file")
    assert said(json.loads(json.dumps(CODEC.plain(experiment))), found.settings)
    assert experiment.seed == 3
    assert experiment.loop.optimiser == AdamWCosine(0.1, 0.3, 0.02, 2, 1.0)
    assert experiment.terms["silog"] == Term(Silog(0.85), 1.0)
    assert (experiment.loop.accumulate, experiment.loop.precision) == (1, "float32")


def test_a_run_of_an_older_version_goes_on(recorded, network):
    run = Run.started(network, LoopSettings())
    run.resume(load(recorded), recorded.name)
    assert (run.iteration, run.errors) == (2, [])
    weight = torch.tensor([-0.4147762, -0.2319033, -0.3872071])
    assert_close(run.network.decoder.weight.flatten(), weight, atol=1e-7, rtol=0)
    mean = torch.tensor([0.00968045, -0.08057499, 0.02248224])
    assert_close(run.average.norm.running_mean, mean, atol=1e-8, rtol=0)
    state = run.optimiser.state[run.network.encoder.weight]
    squares = torch.tensor([9.39391e-05, 1.19259e-05])
    assert_close(state["exp_avg_sq"].flatten()[:2], squares, atol=1e-10, rtol=0)


def test_a_checkpoint_names_the_code_it_comes_from(tmp_path):
    save(tmp_path / "a.safetensors", Checkpoint(1, {}, {}, "flexdepth 7, commit abc"))
    assert load(tmp_path / "a.safetensors").source == "flexdepth 7, commit abc"


@pytest.fixture
def root(tmp_path, monkeypatch):
    """The root of a checkout, or of what is none, for all that `source` knows."""
    monkeypatch.setattr(checkpoint, "__file__", str(tmp_path / "src/flexdepth/training/x.py"))
    return tmp_path


def test_in_a_checkout_the_commit_is_named(root, monkeypatch):
    for setting in ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE"):
        monkeypatch.delenv(setting, raising=False)
    git = ["git", "-C", str(root), "-c", "user.name=a", "-c", "user.email=a@b"]
    subprocess.run([*git, "init", "--quiet"], check=True)
    (root / "a").write_text("a")
    subprocess.run([*git, "add", "a"], check=True)
    subprocess.run([*git, "commit", "--quiet", "--message", "a"], check=True)
    named = subprocess.run([*git, "rev-parse", "HEAD"], check=True, capture_output=True, text=True)
    assert source().endswith(f", commit {named.stdout.strip()}")
    (root / "a").write_text("b")
    assert source().endswith(f", commit {named.stdout.strip()}-dirty")


def test_outside_a_checkout_the_version_must_do(root):
    assert source() == f"flexdepth {checkpoint.version('flexdepth')}"
    (root / ".git").write_text("gitdir: nowhere")
    assert source() == f"flexdepth {checkpoint.version('flexdepth')}"


def test_the_state_of_the_optimiser_is_laid_in_memory_as_its_weights_are(tmp_path):
    """Else a resumed run adds the same numbers in another order, and the last bits differ."""
    first = nn.Conv2d(4, 4, 3).to(memory_format=torch.channels_last)
    run = Run.started(first, LoopSettings())
    first(torch.ones(1, 4, 5, 5)).sum().backward()
    run.optimiser.step()
    again = Run.started(nn.Conv2d(4, 4, 3).to(memory_format=torch.channels_last), LoopSettings())
    save(tmp_path / "a.safetensors", run.checkpoint({}))
    again.resume(load(tmp_path / "a.safetensors"), "a")
    before, after = (each.optimiser.state[each.network.weight] for each in (run, again))
    assert before["exp_avg"].stride() == after["exp_avg"].stride() != (36, 9, 3, 1)
    assert torch.equal(before["exp_avg"], after["exp_avg"])
