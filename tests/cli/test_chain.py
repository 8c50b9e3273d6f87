"""From pictures to a model of one's own: data, train, export, predict, as a person types them."""

import json
import shlex
from pathlib import Path

import cv2
import numpy as np
import pytest

from flexdepth.cli.main import main
from flexdepth.runtime.files import read_depth, read_meaning

PAGE = Path(__file__).parents[2] / "docs" / "own_model.md"
QUICKLY = [
    *("--loop.iterations", "1", "--loop.batches.size", "2", "--loop.batches.shapes", "64", "64"),
    *("--processes", "0"),
]


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """The current folder, with pictures and depth in millimetres, as other programs write it."""
    monkeypatch.chdir(tmp_path)
    render = ["synth", "-o", "renders", "--count", "4", "--width", "64", "--height", "64"]
    assert main(render) == 0
    Path("renders/image").rename("mine")
    Path("mine/image").mkdir()
    Path("mine/depth").mkdir()
    for picture in list(Path("mine").glob("*.*")):
        depth = read_depth(Path("renders/depth") / f"{picture.stem}.npz")
        millimetres = np.where(depth.valid, depth.values * 1000, 0).clip(0, 65535)
        cv2.imwrite(f"mine/depth/{picture.stem}.png", millimetres.astype(np.uint16))
        picture.rename(Path("mine/image") / picture.name)
    cv2.imwrite("photo.jpg", np.full((48, 64, 3), 128, np.uint8))


@pytest.mark.usefixtures("mine")
def test_the_page_about_a_model_of_ones_own_works_as_it_is_typed():
    commands = [shlex.split(line)[1:] for line in PAGE.read_text().splitlines() if is_typed(line)]
    assert [command[0] for command in commands] == ["data", "train", "export", "predict"]
    for command in commands:
        assert main([*command, *(QUICKLY if command[0] == "train" else ())]) == 0, command
    found = read_meaning(Path("depth/photo.npz"))
    assert str(found["model"]).startswith("own ")
    lines = Path("runs/mine/log.jsonl").read_text().splitlines()
    assert "held_out_abs_rel" in json.loads(lines[-1])


def is_typed(line):
    return line.startswith("flexdepth ") and "--help" not in line


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
        (
            ["export", "nothing.safetensors", "-o", "x.onnx", "--depth-factor", "-1"],
            "--depth-factor: a number above 0 was wanted, got -1",
        ),
        (
            ["export", "nothing.safetensors", "-o", "x.onnx", "--spread-factor", "0"],
            "--spread-factor: a number above 0 was wanted, got 0",
        ),
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
