from pathlib import Path

import pytest

from flexdepth.cli import train
from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.experiment import Bundled, ImageNet, Trained


@pytest.mark.parametrize(
    ("arguments", "start"),
    [
        (["--encoder-weights", "timm.safetensors"], ImageNet(Path("timm.safetensors"))),
        (["--start", "imagenet"], ImageNet()),
        (["--start", "bundled"], Bundled()),
        (["--start", "own.onnx"], Bundled(Path("own.onnx"))),
        (["--start", "runs/mine/best.safetensors"], Trained(Path("runs/mine/best.safetensors"))),
    ],
)
def test_a_run_starts_from_the_weights_that_are_named(arguments, start, monkeypatch):
    started = []
    monkeypatch.setattr(train, "run_experiment", lambda experiment, *_: started.append(experiment))
    assert train.run(["compact", *arguments]) == 0
    assert started[0].start == start


@pytest.mark.parametrize(
    ("named", "root"),
    [
        ([], "mine"),
        (["--held-out.root", "renders/heldout"], "renders/heldout"),
        (["--held_out.root", "renders/heldout"], "renders/heldout"),
    ],
)
def test_what_is_named_to_be_held_out_is_even_if_it_is_the_default(named, root, monkeypatch):
    started = []
    monkeypatch.setattr(train, "run_experiment", lambda experiment, *_: started.append(experiment))
    assert train.run(["compact", "--data.root", "mine", *named]) == 0
    assert started[0].held_out.root == Path(root)


def test_a_file_names_the_run_and_the_command_line_has_the_last_word(monkeypatch, tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("like: compact\nseed: 3\nloop: {iterations: 7, save_every: 2}\n")
    started = []
    monkeypatch.setattr(train, "run_experiment", lambda *given: started.append(given))
    assert train.run([str(file), "--loop.iterations", "9"]) == 0
    experiment, folder, *_ = started[0]
    assert (experiment.seed, experiment.loop.iterations, experiment.loop.save_every) == (3, 9, 2)
    assert folder == Path("runs/mine")


@pytest.mark.parametrize(("given", "patience"), [([], None), (["--loop.patience", "3"], 3)])
def test_a_run_has_no_end_but_its_last_iteration_unless_patience_is_given(
    given, patience, monkeypatch
):
    started = []
    monkeypatch.setattr(train, "run_experiment", lambda experiment, *_: started.append(experiment))
    assert train.run(["compact", *given]) == 0
    assert started[0].loop.patience == patience


def test_the_help_of_an_experiment_says_what_patience_does(capsys):
    with pytest.raises(SystemExit):
        train.run(["compact", "--help"])
    page = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "--loop.patience {None}|INT Validations in a row without a lower held-out error" in page


@pytest.mark.parametrize("asked", ["--help", "-h"])
def test_the_help_lists_the_experiments(asked, capsys):
    assert train.run([asked]) == 0
    page = capsys.readouterr().out
    assert "flexdepth train EXPERIMENT" in page
    assert all(f"  {name}\n" in page for name in CATALOGUE)
