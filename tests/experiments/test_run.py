from dataclasses import replace

import pytest
import torch
from safetensors.torch import save_file

from flexdepth.data.folder import Folder
from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.experiment import CODEC, Experiment, ImageNet, Trained
from flexdepth.experiments.run import BEST, LATEST, run_experiment, trained_network
from flexdepth.networks.compact import Compact
from flexdepth.networks.pretrained import imagenet_weights
from flexdepth.runtime.errors import InputError
from flexdepth.synth.generate import SynthSettings, write_images
from flexdepth.training.batches import BatchSettings
from flexdepth.training.checkpoint import load
from flexdepth.training.loop import LoopSettings


@pytest.fixture(scope="module")
def rendered(tmp_path_factory):
    folder = tmp_path_factory.mktemp("renders")
    list(write_images(SynthSettings(seed=5, width=64, height=64), 4, folder, 1))
    return folder


@pytest.fixture(scope="module")
def experiment(rendered):
    return Experiment(
        network=Compact(widths=(32, 32, 32, 32)),
        data=Folder(rendered),
        held_out=Folder(rendered),
        loop=LoopSettings(
            iterations=2, save_every=1, batches=BatchSettings(size=2, shapes=((64, 64),))
        ),
    )


@pytest.fixture(scope="module")
def finished(experiment, tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    lines = []
    run_experiment(experiment, folder, 0, lines.append)
    return folder, lines


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_experiment_survives_a_file(name):
    assert CODEC.restored(Experiment, CODEC.plain(CATALOGUE[name]), name) == CATALOGUE[name]


def test_a_run_leaves_its_latest_and_its_best_weights(finished):
    folder, lines = finished
    assert {path.name for path in folder.iterdir()} == {LATEST, BEST, "log.jsonl"}
    assert sum("held-out AbsRel" in line for line in lines) == 2


def test_a_checkpoint_is_enough_to_build_the_network(finished, experiment):
    network = trained_network(finished[0] / BEST)
    assert network.settings == experiment.network
    assert not network.training
    weights = load(finished[0] / BEST).part("average")
    assert torch.equal(network.head.conv.weight, weights["head.conv.weight"])


def test_a_run_starts_from_imagenet_and_moves_away_from_it(finished):
    start = imagenet_weights()["conv_stem.weight"]
    stem = load(finished[0] / LATEST).part("network")["encoder.trunk.conv_stem.weight"]
    assert 0 < (stem - start).abs().max() < 0.01


def test_the_same_settings_go_on_and_others_are_refused(finished, experiment):
    lines = []
    run_experiment(experiment, finished[0], 0, lines.append)
    assert lines == ["resuming at iteration 2"]
    with pytest.raises(InputError, match="belongs to a run of other settings"):
        run_experiment(replace(experiment, seed=1), finished[0], 0, lines.append)


def test_the_same_seed_gives_the_same_weights(finished, experiment, tmp_path):
    run_experiment(experiment, tmp_path, 0, lambda _line: None)
    first, second = (load(folder / LATEST).tensors for folder in (finished[0], tmp_path))
    assert all(torch.equal(first[name], second[name]) for name in first)


def test_a_run_can_start_from_another_run(finished, experiment, tmp_path):
    start = Trained(finished[0] / BEST)
    still = replace(experiment.loop, optimiser=replace(experiment.loop.optimiser, rate=0.0))
    run_experiment(replace(experiment, start=start, loop=still), tmp_path, 0, lambda _line: None)
    before, after = load(start.checkpoint), load(tmp_path / LATEST)
    name = "encoder.trunk.conv_stem.weight"
    assert torch.equal(before.part("average")[name], after.part("network")[name])


def test_encoder_weights_of_another_network_stop_a_run_before_it_begins(experiment, tmp_path):
    save_file({"stem.weight": torch.ones(1)}, tmp_path / "other.safetensors")
    named = replace(experiment, start=ImageNet(tmp_path / "other.safetensors"))
    with pytest.raises(InputError, match=r"not the weights of tf_efficientnet_lite0.*stem\.weight"):
        run_experiment(named, tmp_path / "run", 0, print)
    assert not (tmp_path / "run").exists()
