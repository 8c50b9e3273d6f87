from pathlib import Path

from flexdepth.cli import train
from flexdepth.experiments.experiment import ImageNet


def test_encoder_weights_are_where_the_run_starts(monkeypatch):
    started = []
    monkeypatch.setattr(train, "run_experiment", lambda experiment, *_: started.append(experiment))
    assert train.run(["compact", "--encoder-weights", "timm.safetensors"]) == 0
    assert started[0].start == ImageNet(Path("timm.safetensors"))
