import json
from dataclasses import replace

import pytest

from flexdepth.data.recipes import KittiCrop, NyuCrop
from flexdepth.data.transforms import Crop
from flexdepth.experiments.experiment import CODEC, Experiment
from flexdepth.networks import AGA, Compact
from flexdepth.networks.merge import VARIANTS


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
