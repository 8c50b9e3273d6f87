import json
from dataclasses import replace
from pathlib import Path

import pytest

from flexdepth.data import Folder, Kitti, NyuFolders, NyuLabelled
from flexdepth.data.nyu import NyuDepth
from flexdepth.data.read import Split
from flexdepth.data.recipes import KittiCrop, NyuCrop
from flexdepth.data.transforms import Crop
from flexdepth.evaluation.alignment import Alignment
from flexdepth.experiments.experiment import CODEC, Experiment
from flexdepth.networks import AGA, Compact
from flexdepth.networks.merge import VARIANTS
from flexdepth.runtime.errors import InputError
from flexdepth.training.optimiser import AdamWCosine


def with_recipe(recipe):
    loop = Experiment().loop
    return Experiment(loop=replace(loop, batches=replace(loop.batches, crop=recipe)))


@pytest.mark.parametrize("recipe", [Crop(0.4, 1.2), NyuCrop((1.0, 0.5)), KittiCrop((1.0,), 30)])
def test_every_recipe_survives_a_file(recipe):
    text = json.dumps(CODEC.plain(with_recipe(recipe)))
    assert CODEC.restored(Experiment, json.loads(text), "file") == with_recipe(recipe)


def test_a_checkpoint_from_before_there_were_recipes_is_still_read():
    values = CODEC.plain(with_recipe(Crop(0.4, 1.2)))
    values["loop"]["batches"]["crop"] = {"smallest": 0.4, "stretch": 1.2}
    assert CODEC.restored(Experiment, values, "file") == with_recipe(Crop(0.4, 1.2))


@pytest.mark.parametrize("name", VARIANTS)
def test_a_network_with_any_merge_survives_a_file(name):
    experiment = Experiment(network=AGA().merged_by(VARIANTS[name]))
    text = json.dumps(CODEC.plain(experiment))
    assert CODEC.restored(Experiment, json.loads(text), "file") == experiment


def test_a_checkpoint_from_before_there_were_other_networks_is_still_read():
    values = CODEC.plain(Experiment())
    del values["network"]["_type"]
    values["network"]["coefficient"] = {
        "_type": "SpatialPlusChannelAttention",
        "ratio": 4,
        "channel": {"ratio": 8},
    }
    values["network"]["encoder"] = {"name": "tf_efficientnet_lite0"}
    assert CODEC.restored(Experiment, values, "file").network == Compact()


@pytest.mark.parametrize(
    "data",
    [
        Folder(Path("own")),
        NyuLabelled(Path("nyu"), Split.TEST, NyuDepth.RAW),
        NyuFolders(Path("nyu"), Split.TEST, Path("frames.txt")),
        Kitti(Path("kitti"), Path("/elsewhere/raw"), frames=Path("frames.txt")),
    ],
)
def test_every_data_set_survives_a_file(data):
    experiment = Experiment(data=data, held_out=data)
    text = json.dumps(CODEC.plain(experiment))
    assert CODEC.restored(Experiment, json.loads(text), "file") == experiment


def test_a_checkpoint_from_before_there_were_other_data_sets_and_optimisers_is_still_read():
    values = CODEC.plain(Experiment())
    values["data"], values["held_out"] = {"root": "own/train"}, {"root": "own/heldout"}
    values["loop"]["optimiser"] = {
        "rate": 3e-4,
        "encoder_share": 0.3,
        "weight_decay": 0.02,
        "warm_up": 100,
        "largest_gradient": 1.0,
    }
    del values["loop"]["alignment"]
    found = CODEC.restored(Experiment, values, "file")
    assert (found.data, found.held_out) == (Folder(Path("own/train")), Folder(Path("own/heldout")))
    assert found.loop.optimiser == AdamWCosine(rate=3e-4, warm_up=100)
    assert found.loop.alignment == Alignment.LEAST_SQUARES_DISPARITY


def test_a_data_set_that_is_not_known_is_refused():
    values = CODEC.plain(Experiment())
    values["data"] = {"_type": "Cityscapes", "root": "x"}
    with pytest.raises(InputError, match="data"):
        CODEC.restored(Experiment, values, "file")
