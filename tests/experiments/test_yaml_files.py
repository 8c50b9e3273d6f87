from dataclasses import replace
from pathlib import Path

import pytest

from flexdepth.data import NyuLabelled
from flexdepth.experiments.catalogue import CATALOGUE, experiment_named
from flexdepth.experiments.experiment import Experiment, Untrained
from flexdepth.experiments.yaml_files import experiment_text
from flexdepth.losses import BerHu
from flexdepth.networks import AGA
from flexdepth.networks.attention import ChannelAttention
from flexdepth.runtime.errors import InputError
from flexdepth.training.objective import Term
from flexdepth.training.optimiser import AdamWCosine


@pytest.fixture
def own(tmp_path):
    """Return a function that reads an experiment from the text of a file."""

    def read(text: str) -> Experiment:
        path = tmp_path / "own.yaml"
        path.write_text(text, encoding="utf-8")
        return experiment_named(str(path))

    return read


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_experiment_survives_a_yaml_file(name, tmp_path):
    path = tmp_path / "whole.yaml"
    path.write_text(experiment_text(CATALOGUE[name]), encoding="utf-8")
    assert experiment_named(str(path)) == CATALOGUE[name]


def test_a_file_says_what_differs_from_a_named_experiment(own):
    text = "like: nyu-small\nloop: {iterations: 7, optimiser: {rate: 1e-4}}\ndata: {root: mine}\n"
    nyu = CATALOGUE["nyu-small"]
    changed = replace(nyu.loop, iterations=7, optimiser=replace(nyu.loop.optimiser, rate=1e-4))
    held_out = replace(nyu.held_out, root=Path("mine"))
    assert own(text) == replace(
        nyu, loop=changed, data=NyuLabelled(Path("mine")), held_out=held_out
    )


def test_another_kind_of_part_is_its_defaults_and_what_the_file_says(own):
    found = own("like: nyu-small\nloop: {optimiser: {_type: AdamWCosine, rate: 1e-4}}\n")
    assert found.loop.optimiser == AdamWCosine(rate=1e-4)
    assert found.loop.iterations == 5000


def test_every_union_can_be_chosen_from(own):
    found = own(
        "network: {_type: AGA}\nstart: {_type: Untrained}\ndata: {_type: NyuLabelled, root: nyu}\n"
    )
    assert (found.network, found.start) == (AGA(), Untrained())
    assert found.data == NyuLabelled(Path("nyu"))
    merged = own("network: {coefficient: {_type: ChannelAttention}}\n")
    assert merged.network == replace(Experiment().network, coefficient=ChannelAttention())


def test_a_term_is_added_changed_or_left_out(own):
    found = own(
        "like: compact\n"
        "terms: {sky: null, silog: {weight: 2}, berhu: {loss: {_type: BerHu}, weight: 3}}\n"
    )
    changed = dict(Experiment().terms)
    del changed["sky"]
    changed["silog"] = replace(changed["silog"], weight=2.0)
    assert found.terms == {**changed, "berhu": Term(BerHu(), 3.0)}


def test_without_like_the_terms_are_those_of_the_file(own):
    assert own("terms: {berhu: {loss: {_type: BerHu}}}\n").terms == {"berhu": Term(BerHu())}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("like: nyu-smal", "like: no experiment 'nyu-smal'; choose one of ['chapter3-s"),
        ("like: [a]", "like: no experiment ['a']; choose one of"),
        ("lop: 3", "Experiment has no field 'lop'; did you mean 'loop'?"),
        ("loop: {iteration: 3}", "loop: LoopSettings has no field 'iteration'; did you mean"),
        ("loop: {iterations: 0}", "loop: iterations, save_every and accumulate are whole numbers"),
        ("loop: {iterations: x}", "loop.iterations: invalid value for type, expected int"),
        ("network: {_type: Aga}", "network: no `_type` 'Aga'; choose one of ['AGA', "),
        ("terms: {a: {loss: {_type: BerH}}}", "terms['a'].loss: no `_type` 'BerH'; choose one of"),
        ("terms: 3", "terms: expected a mapping"),
        ("- a", "wanted the fields of an experiment, got ['a']"),
        ("", "wanted the fields of an experiment, got None"),
        ("a: [", "is not YAML"),
        ("a: !!python/object/apply:os.getcwd []", "is not YAML"),
    ],
)
def test_a_wrong_file_is_told_in_one_line(text, said, own):
    with pytest.raises(InputError) as refused:
        own(text)
    message = str(refused.value)
    assert said in message
    assert "own.yaml: " in message
    assert "\n" not in message


def test_a_missing_file_is_named():
    with pytest.raises(InputError, match=r"none\.yaml: cannot be read as an experiment"):
        experiment_named("none.yaml")
