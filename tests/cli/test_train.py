from pathlib import Path

import pytest

from flexdepth.cli import train
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
