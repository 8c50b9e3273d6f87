from dataclasses import replace

import pytest

from flexdepth.experiments.ablations import as_edrb, changed, merged_by, seeded, without
from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.experiment import Experiment, Untrained
from flexdepth.networks import AGA, EDRB, PCA, Compact
from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.conventional import DotProductPlusChannelAttention
from flexdepth.networks.edrb import Rows
from flexdepth.networks.merge import VARIANTS, SpatialAttention, SpatialPlusChannelAttention
from flexdepth.runtime.errors import InputError

SMALL = CATALOGUE["chapter3-small"]


@pytest.mark.parametrize("variant", VARIANTS)
def test_at_full_size_a_change_of_merges_gives_the_published_variant(variant):
    published = AGA().merged_by(VARIANTS[variant])
    assert merged_by(variant)(Experiment(network=AGA())).network == published


def test_a_small_network_keeps_its_bottlenecks_in_every_variant():
    """The small network's are a quarter and an eighth, where the published ones are 1/16."""
    four, eight = 4, ChannelAttention(8)
    expected = {
        "S1": eight,
        "S3": SpatialAttention(four),
        "S7": SpatialPlusChannelAttention(four, eight),
        "DS7": DotProductPlusChannelAttention(four, eight),
    }
    for variant, coefficient in expected.items():
        assert merged_by(variant)(SMALL).network.coefficients == (coefficient,) * 4


def test_what_a_merge_does_not_have_cannot_be_kept():
    alone = merged_by("S3")(SMALL)
    assert merged_by("S1")(alone).network.coefficients[0] == ChannelAttention(16)
    assert merged_by("S7")(alone).network.coefficients[0].ratio == 4
    base = merged_by("S1")(SMALL)
    assert merged_by("S7")(base).network.coefficients[0].channel == ChannelAttention(8)
    assert merged_by("S7")(base).network.coefficients[0].ratio == 16


@pytest.mark.parametrize("network", [Compact(), EDRB(Rows((32, 64)))])
def test_the_merges_of_the_other_networks_can_be_changed_too(network):
    changed_network = merged_by("S1")(Experiment(network=network)).network
    merge = (
        changed_network.coefficient if network == Compact() else changed_network.rows.coefficient
    )
    assert isinstance(merge, ChannelAttention)


def test_a_network_without_merges_is_refused():
    with pytest.raises(InputError, match="the PCA network has no merges"):
        merged_by("S1")(Experiment(network=PCA()))


def test_a_term_can_be_dropped_once():
    less = without("squared")(SMALL)
    assert set(less.terms) == {"cross_entropy", "virtual_normal"}
    with pytest.raises(InputError, match=r"no term 'squared' to drop; .*'virtual_normal'\]"):
        without("squared")(less)


def test_the_edrb_network_of_the_published_one_is_the_published_one():
    published = as_edrb(Experiment(network=AGA()))
    assert published.network == EDRB()
    assert published.start == Untrained()


def test_the_edrb_network_of_a_small_one_is_small():
    network = as_edrb(SMALL).network
    assert network.rows.widths == (32, 64, 64, 64, 64)
    assert network.head == SMALL.network.head
    assert network.rows.coefficient == SMALL.network.coefficients[0]
    with pytest.raises(InputError, match="takes the widths of an AGA network, got Compact"):
        as_edrb(Experiment())


def test_repetitions_differ_in_weights_and_batches_alone():
    again = seeded(2)(SMALL)
    assert (again.seed, again.loop.batches.seed) == (2, 2)
    batches = replace(again.loop.batches, seed=0)
    assert replace(again, seed=0, loop=replace(again.loop, batches=batches)) == SMALL
    assert seeded(0)(SMALL) == SMALL


def test_changes_are_made_in_order():
    last = changed(SMALL, (merged_by("S1"), merged_by("S3"))).network.coefficients[0]
    assert isinstance(last, SpatialAttention)
    assert changed(SMALL, ()) == SMALL
