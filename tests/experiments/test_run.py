from dataclasses import replace

import pytest
import torch
from safetensors.torch import save_file
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from torch import nn
from torch.nn.functional import avg_pool2d, interpolate

from flexdepth.data.folder import Folder
from flexdepth.experiments import run
from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.experiment import CODEC, Experiment, ImageNet, Trained
from flexdepth.experiments.run import BEST, LATEST, run_experiment, trained_network
from flexdepth.networks import AGA
from flexdepth.networks.compact import Compact
from flexdepth.networks.pretrained import imagenet_weights
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction
from flexdepth.synth.generate import SynthSettings, write_images
from flexdepth.training import loop
from flexdepth.training.batches import BatchSettings
from flexdepth.training.checkpoint import load, source
from flexdepth.training.loop import LoopSettings
from flexdepth.training.optimiser import SGDPolynomial
from flexdepth.training.validation import SCORES


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
    assert {path.name for path in folder.iterdir()} == {LATEST, BEST, "log.jsonl", "tensorboard"}
    assert sum("held-out AbsRel" in line for line in lines) == 2


def test_a_checkpoint_is_enough_to_build_the_network(finished, experiment):
    network = trained_network(finished[0] / BEST)
    assert network.settings == experiment.network
    assert not network.training
    weights = load(finished[0] / BEST).part("average")
    assert torch.equal(network.head.conv.weight, weights["head.conv.weight"])


def test_a_run_starts_from_imagenet_and_moves_away_from_it(finished):
    start = imagenet_weights("tf_efficientnet_lite0")["conv_stem.weight"]
    stem = load(finished[0] / LATEST).part("network")["encoder.trunk.conv_stem.weight"]
    assert 0 < (stem - start).abs().max() < 0.01


def test_the_same_settings_go_on_and_others_are_refused(finished, experiment):
    lines = []
    run_experiment(experiment, finished[0], 0, lines.append)
    assert [line.partition(" with ")[0] for line in lines] == ["resuming at iteration 2 of 2"]
    longer = replace(experiment, loop=replace(experiment.loop, iterations=3))
    with pytest.raises(InputError, match=r"other settings.*\(loop\.iterations: 2 there, 3 here\)"):
        run_experiment(longer, finished[0], 0, lines.append)
    with pytest.raises(InputError, match=r"\(network: Compact there, AGA here\)"):
        run_experiment(replace(experiment, network=AGA()), finished[0], 0, lines.append)


def test_a_run_that_lost_patience_says_so_and_stays_ended(experiment, tmp_path, monkeypatch):
    monkeypatch.setattr(loop, "validate", lambda *_: dict.fromkeys(SCORES, 0.25))
    patient = replace(experiment, loop=replace(experiment.loop, iterations=9, patience=2))
    said = (
        "ended early, at iteration 3 of 9: loop.patience is 2, and so many validations in a row "
        "did not lower the held-out AbsRel, 0.2500 at best; with more patience or iterations it "
        "goes on"
    )
    lines = []
    run_experiment(patient, tmp_path, 0, lines.append)
    assert lines[-1] == said
    assert load(tmp_path / LATEST).iteration == 3
    again = []
    run_experiment(patient, tmp_path, 0, again.append)
    assert again == [said]


def test_a_run_that_lost_patience_goes_on_with_more_as_if_it_had_had_it_from_the_start(
    experiment, tmp_path, monkeypatch
):
    monkeypatch.setattr(loop, "validate", lambda *_: dict.fromkeys(SCORES, 0.25))
    few, more = (
        replace(experiment, loop=replace(experiment.loop, iterations=5, patience=patience))
        for patience in (1, 3)
    )
    lines = []
    run_experiment(few, tmp_path / "run", 0, print)
    run_experiment(more, tmp_path / "run", 0, lines.append)
    run_experiment(more, tmp_path / "straight", 0, print)
    assert lines[0].startswith("resuming at iteration 2 of 5 ")
    assert lines[-1].startswith("ended early, at iteration 4 of 5: loop.patience is 3")
    went_on, straight = (load(tmp_path / name / LATEST) for name in ("run", "straight"))
    assert went_on.errors == straight.errors
    assert all(torch.equal(each, straight.tensors[k]) for k, each in went_on.tensors.items())


def test_a_run_that_lost_patience_may_be_given_more_iterations_and_counts_anew(
    experiment, tmp_path, monkeypatch
):
    monkeypatch.setattr(loop, "validate", lambda *_: dict.fromkeys(SCORES, 0.25))
    few, more = (
        replace(experiment, loop=replace(experiment.loop, iterations=iterations, patience=1))
        for iterations in (3, 6)
    )
    other = replace(few, loop=replace(few.loop, patience=9, average_decay=0.5))
    run_experiment(few, tmp_path, 0, print)
    with pytest.raises(InputError, match=r"\(loop\.average_decay: 0\.998 there, 0\.5 here\)"):
        run_experiment(other, tmp_path, 0, print)
    run_experiment(more, tmp_path, 0, print)
    assert load(tmp_path / LATEST).iteration == 4
    with pytest.raises(InputError, match=r"\(loop\.iterations: 6 there, 3 here\)"):
        run_experiment(few, tmp_path, 0, print)


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


def test_a_checkpoint_of_another_network_stops_a_run_before_it_begins(
    finished, experiment, tmp_path
):
    wider = replace(
        experiment,
        network=replace(experiment.network, widths=(32, 32, 32, 16)),
        start=Trained(finished[0] / BEST),
    )
    with pytest.raises(InputError) as stopped:
        run_experiment(wider, tmp_path / "run", 0, print)
    assert "best.safetensors: holds the weights of another network; missing []" in str(
        stopped.value
    )
    assert "of another shape ['head.conv.weight', 'levels.3." in str(stopped.value)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("part", ["data", "held_out"])
def test_a_data_root_that_is_missing_stops_a_run_before_it_begins(experiment, tmp_path, part):
    nowhere = replace(experiment, **{part: Folder(tmp_path / "nowhere")})
    with pytest.raises(InputError, match=r"nowhere.image: no such folder; a data folder holds"):
        run_experiment(nowhere, tmp_path / "run", 0, print)
    assert not (tmp_path / "run").exists()


class Halved(nn.Module):
    """Five times, and doubled again; a network as it is, without the checks of its annotations."""

    def forward(self, image):
        return Prediction(image[:, 0] + grown(image), None)


class Shrunk(nn.Module):
    """The same without what it would not fit, so that odd sizes come out smaller."""

    def forward(self, image):
        return Prediction(grown(image), None)


def grown(image):
    return interpolate(avg_pool2d(image, 32), scale_factor=32.0)[:, 0]


@pytest.mark.parametrize("kind", [Halved, Shrunk])
def test_shapes_that_the_network_does_not_take_stop_a_run_before_it_begins(
    kind, experiment, tmp_path, monkeypatch
):
    monkeypatch.setattr(Compact, "build", lambda _: kind())
    monkeypatch.setattr(run, "give_weights", lambda *_: None)
    batches = replace(experiment.loop.batches, shapes=((64, 96), (100, 64)))
    steps = SGDPolynomial()
    odd = replace(experiment, loop=replace(experiment.loop, batches=batches, optimiser=steps))
    with pytest.raises(
        InputError, match=r"Compact does not take images of 100x64; multiples of 32"
    ):
        run_experiment(odd, tmp_path / "run", 0, print)
    assert not (tmp_path / "run").exists()


def test_out_of_memory_is_told_in_one_line(experiment, tmp_path, monkeypatch):
    def greedy(*_):
        torch.empty(10**15)

    monkeypatch.setattr(run, "pictures", greedy)
    with pytest.raises(InputError, match="out of memory with batches of 2 images of up to 64x64"):
        run_experiment(experiment, tmp_path / "run", 0, lambda _line: None)


def test_a_folder_that_cannot_be_made_stops_a_run_before_it_begins(experiment, tmp_path):
    (tmp_path / "file").write_text("")
    said = []
    with pytest.raises(InputError, match="is no folder; choose another --output-dir"):
        run_experiment(experiment, tmp_path / "file" / "run", 0, said.append)
    assert said == []


def test_a_run_says_what_it_has_and_where_it_computes(finished):
    assert finished[1][0].startswith("starting at iteration 0 of 2 with 4 images, 4 held out, on 1")


def test_a_run_leaves_curves_and_pictures(finished):
    events = EventAccumulator(str(finished[0] / "tensorboard"))
    events.Reload()
    terms = {"term/total", "term/silog", "term/gradient", "term/sky", "term/spread", "term/focal"}
    scores = {f"held_out_{name}" for name in SCORES}
    assert set(events.Tags()["scalars"]) == {"rate", *scores, *terms}
    assert events.Tags()["images"] == ["000000", "000001", "000002"]
    assert [event.step for event in events.Images("000002")] == [1, 2]


def test_a_checkpoint_of_a_run_names_the_code(finished):
    assert load(finished[0] / LATEST).source == source()
