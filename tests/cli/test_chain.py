"""From nothing to a user's own model: synth, train, export, predict, as a person types them."""

import json

import cv2
import numpy as np
import pytest

from flexdepth.cli.main import main


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("chain")
    renders, run = str(folder / "renders"), str(folder / "run")
    assert main(["synth", "-o", renders, "--count", "4", "--width", "64", "--height", "64"]) == 0
    train = ["train", "compact", "--start", "bundled", "-o", run]
    train += ["--data.root", renders, "--held-out.root", renders]
    train += ["--loop.iterations", "1", "--loop.batches.size", "2", "--processes", "0"]
    assert main([*train, "--loop.batches.shapes", "64", "64"]) == 0
    bundle = str(folder / "own.onnx")
    assert main(["export", f"{run}/latest.safetensors", "-o", bundle, "--name", "own"]) == 0
    return folder


def test_a_model_of_ones_own_predicts(folder, tmp_path, capsys):
    photo = tmp_path / "photo.png"
    cv2.imwrite(str(photo), np.full((48, 64, 3), 128, np.uint8))
    arguments = ["predict", str(photo), "-o", str(tmp_path / "out"), "--json"]
    assert main([*arguments, "--model", str(folder / "own.onnx")]) == 0
    assert json.loads(capsys.readouterr().out)["model"]["name"] == "own"


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["train", "compacct"], "no experiment 'compacct'; did you mean 'compact'?"),
        (["train", "compact", "--lop.iterations", "3"], "did you mean --loop.iterations INT?"),
        (["train", "compact", "--start", "best"], "--start: wanted bundled, imagenet, a .onnx"),
        (["train"], "name an experiment first, of ["),
        (["train", "--seed", "3"], "name an experiment first, of ["),
        (["train", "compact", "--data.root", "nowhere"], "nowhere/image: no such folder"),
        (["export", "nothing.safetensors", "-o", "x.onnx"], "nothing.safetensors: no such check"),
        (["synth", "-o", "x", "--width", "3"], "width and height >= 32"),
        (["synth", "-o", "x", "--count", "0"], "--count is a whole number >= 1"),
    ],
)
def test_a_mistake_is_one_line(arguments, complaint, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert complaint in said.replace("\\", "/")
    assert said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
