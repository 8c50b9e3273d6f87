"""What an experiment may be made of survives a file, and the networks without ImageNet start."""

import json
from typing import get_args

import pytest

from flexdepth.experiments.experiment import CODEC, Experiment, ImageNet, Untrained
from flexdepth.experiments.start import give_weights
from flexdepth.losses import BerHu, BinCentres, Ordinal
from flexdepth.networks import AGA, EDRB, PCA
from flexdepth.networks.edrb import Rows
from flexdepth.networks.extended import Activations, GroupedBranch
from flexdepth.networks.heads import DepthHead
from flexdepth.runtime.errors import InputError
from flexdepth.training.objective import Term

NETWORKS = [
    EDRB(),
    EDRB(Rows().made_of(GroupedBranch(16)).with_activations(Activations.RECOMPUTED)),
    PCA(),
    *(AGA(head=head()) for head in get_args(DepthHead)),
    *(EDRB(head=head()) for head in get_args(DepthHead)),
]


@pytest.mark.parametrize("network", NETWORKS)
def test_every_network_survives_a_file_with_every_head(network):
    terms = {"a": Term(Ordinal()), "b": Term(BerHu(0.3)), "c": Term(BinCentres())}
    experiment = Experiment(network=network, terms=terms, start=Untrained())
    text = json.dumps(CODEC.plain(experiment))
    assert CODEC.restored(Experiment, json.loads(text), "file") == experiment


def test_a_checkpoint_from_before_there_were_other_heads_is_still_read():
    values = CODEC.plain(Experiment(network=AGA()))
    del values["network"]["head"]["_type"]
    assert CODEC.restored(Experiment, values, "file").network == AGA()


def test_the_edrb_network_starts_untrained():
    network = EDRB(Rows(widths=(32, 32))).build()
    before = {name: value.clone() for name, value in network.state_dict().items()}
    give_weights(network, Untrained())
    assert all((network.state_dict()[name] == value).all() for name, value in before.items())
    with pytest.raises(InputError, match="start it untrained"):
        give_weights(network, ImageNet())
