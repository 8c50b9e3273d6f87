"""The mean of two small networks, as `flexdepth average` writes it."""

import numpy as np
import pytest
import torch

from flexdepth.cli.main import main
from flexdepth.data.folder import Pair
from flexdepth.experiments.average import averaged
from flexdepth.experiments.experiment import CODEC, Experiment
from flexdepth.experiments.run import trained_network
from flexdepth.networks.compact import Compact
from flexdepth.networks.encoders import Encoder
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.training.checkpoint import Checkpoint, load, save

SMALL = Compact(encoder=Encoder("mobilenetv3_small_050"), widths=(16, 16, 8, 8))
CAMERA = Intrinsics.centred(128, 96, 100.0, FocalSource.GIVEN)
FLAT = DepthMap(np.ones((96, 128), np.float32), Space.METRIC, CAMERA)
PAIRS = [Pair(str(n), np.full((96, 128, 3), 60 * n, np.uint8), FLAT) for n in range(1, 4)]


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    """Two checkpoints of one network, with the weights 1 and 4."""
    folder = tmp_path_factory.mktemp("two")
    settings = CODEC.plain(Experiment(network=SMALL))
    for value in (1, 4):
        state = SMALL.build().state_dict()
        named = {
            f"average.{name}": torch.full_like(each, value) if each.is_floating_point() else each
            for name, each in state.items()
        }
        save(folder / f"{value}.safetensors", Checkpoint(5, settings, named))
    return folder / "1.safetensors", folder / "4.safetensors"


def test_weights_are_the_mean_by_shares_and_statistics_those_of_the_images(two, tmp_path):
    output = tmp_path / "mean.safetensors"
    averaged(two, (2.0, 1.0), PAIRS, 1, output)
    for name, value in load(output).part("average").items():
        if "running" in name:
            assert not torch.equal(value, torch.full_like(value, 2)), name
        elif value.is_floating_point():
            torch.testing.assert_close(value, torch.full_like(value, 2))
    assert trained_network(output).settings == SMALL


@pytest.mark.parametrize("shares", [(1.0,), (1.0, 0.0), (1.0, float("nan")), (1.0, 1.0, 1.0)])
def test_shares_that_do_not_fit_are_refused(shares, two, tmp_path):
    with pytest.raises(InputError, match="--shares: wanted 2 numbers > 0"):
        averaged(two, shares, PAIRS, 1, tmp_path / "mean.safetensors")
    assert not list(tmp_path.iterdir())


def test_a_mistake_on_the_command_line_is_one_line(two, tmp_path, capsys):
    missing = tmp_path / "none"
    command = ["average", *map(str, two), "-o", str(tmp_path / "m.safetensors")]
    assert main([*command, "--data", str(missing)]) == 2
    assert str(missing) in capsys.readouterr().err
    assert main(["average", "-o", "m.safetensors"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
