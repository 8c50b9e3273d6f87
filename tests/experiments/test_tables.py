import json
from dataclasses import replace

import pytest
import torch

from flexdepth.data.folder import Folder
from flexdepth.experiments import tables
from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.experiment import Untrained
from flexdepth.experiments.published_tables import TABLES
from flexdepth.experiments.run import LATEST, LOG
from flexdepth.experiments.tables import Plan, run_table, smoothed
from flexdepth.networks.blocks import Pyramid
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.heads import BinnedDepth
from flexdepth.runtime.errors import InputError
from flexdepth.synth.generate import SynthSettings, write_images
from flexdepth.training.checkpoint import load
from flexdepth.training.objective import DivergedError


@pytest.fixture(scope="module")
def experiment(tmp_path_factory):
    folder = tmp_path_factory.mktemp("renders")
    list(write_images(SynthSettings(seed=5, width=64, height=64), 2, folder, 1))
    small = CATALOGUE["chapter3-short"]
    bins = replace(small.network.head.bins, count=4)
    network = replace(
        small.network,
        encoder=Encoder("test_resnet", 16),
        laterals=(8, 8, 8, 8),
        top=8,
        widths=(8, 8, 8, 8, 8),
        pyramid=Pyramid(width=4),
        head=BinnedDepth(bins),
    )
    batches = replace(small.loop.batches, size=2, shapes=((32, 32),))
    loop = replace(small.loop, iterations=2, save_every=1, batches=batches)
    data = Folder(folder)
    return replace(small, network=network, data=data, held_out=data, loop=loop, start=Untrained())


@pytest.fixture(scope="module")
def plan(experiment):
    rows = tuple(row for row in TABLES["3.4"].rows if row.name in {"S1", "S7"})
    return Plan(replace(TABLES["3.4"], rows=rows), experiment, 2)


@pytest.fixture(scope="module")
def made(plan, tmp_path_factory):
    folder, said = tmp_path_factory.mktemp("table"), []
    return folder, run_table(plan, folder, 0, said.append), said


def test_every_row_is_trained_once_for_each_seed(made):
    folder, outcomes, said = made
    names = ["S1-seed0", "S7-seed0", "S1-seed1", "S7-seed1"]
    assert sorted(path.name for path in folder.iterdir()) == sorted(names)
    assert [f"{o.row}-seed{o.seed}" for o in outcomes] == names
    assert said[0] == "4 runs, 0 of them finished before"
    assert len({outcome.scores["abs_rel"] for outcome in outcomes}) == 4


def test_a_run_is_scored_by_the_mean_of_its_last_evaluations(made):
    lines = [json.loads(line) for line in (made[0] / "S1-seed0" / LOG).read_text().splitlines()]
    errors = [line["held_out_rmse"] for line in lines if "held_out_rmse" in line]
    assert len(errors) == 2
    assert made[1][0].scores["rmse"] == pytest.approx(sum(errors) / 2)


def test_the_moving_average_covers_fifteen_evaluations():
    """Of 0 to 19 the last 15 are 5 to 19, whose mean is 12."""
    assert smoothed([{"rmse": float(n)} for n in range(20)]) == {"rmse": 12.0}
    assert smoothed([{"rmse": 1.0}, {"rmse": 2.0}]) == {"rmse": 1.5}


def test_rows_with_the_same_seed_begin_alike_and_see_the_same_crops(plan):
    runs = {run.name: run.experiment for run in plan.runs()}
    one, other = runs["S1-seed1"], runs["S7-seed1"]
    assert one.loop == other.loop
    assert one.seed == other.seed == 1
    assert runs["S1-seed0"].loop.batches.seed != one.loop.batches.seed


def test_finished_runs_are_skipped_and_give_the_same_outcomes(plan, made, monkeypatch):
    monkeypatch.setattr(tables, "run_experiment", None)
    said = []
    assert run_table(plan, made[0], 0, said.append) == made[1]
    assert said == ["4 runs, 4 of them finished before"]


def test_an_interrupted_table_ends_as_if_it_had_not_been(plan, made, tmp_path, monkeypatch):
    """Stopped in the second run, after its first checkpoint."""
    short = replace(plan, seeds=1)
    whole, count = tables.run_experiment, 0

    def stopping(experiment, folder, processes, show):
        def heard(line):
            if count == 2 and line.startswith("2/2  held-out"):
                raise KeyboardInterrupt
            show(line)

        nonlocal count
        count += 1
        whole(experiment, folder, processes, heard)

    monkeypatch.setattr(tables, "run_experiment", stopping)
    with pytest.raises(KeyboardInterrupt):
        run_table(short, tmp_path, 0, lambda _line: None)
    said = []
    assert run_table(short, tmp_path, 0, said.append) == made[1][:2]
    assert said[0] == "2 runs, 1 of them finished before"
    assert any(line.startswith("resuming at iteration 1 of 2") for line in said)
    here, there = (load(folder / "S7-seed0" / LATEST) for folder in (tmp_path, made[0]))
    assert all(torch.equal(here.tensors[name], value) for name, value in there.tensors.items())


def test_a_folder_of_another_table_is_refused(plan, made):
    longer = replace(plan.experiment, loop=replace(plan.experiment.loop, iterations=3))
    with pytest.raises(
        InputError, match=r"S1-seed0: is a run of other .*loop\.iterations: 2 there"
    ):
        run_table(replace(plan, experiment=longer), made[0], 0, print)


def test_a_run_that_diverges_does_not_stop_the_others(plan, tmp_path, monkeypatch):
    whole = tables.run_experiment

    def diverging(experiment, folder, processes, show):
        if folder.name == "S7-seed0":
            raise DivergedError("the objective is not finite after 1 iterations")
        whole(experiment, folder, processes, show)

    monkeypatch.setattr(tables, "run_experiment", diverging)
    outcomes = run_table(replace(plan, seeds=1), tmp_path, 0, lambda _line: None)
    assert [outcome.scores is None for outcome in outcomes] == [False, True]
    said = []
    assert run_table(replace(plan, seeds=1), tmp_path, 0, said.append) == outcomes
    assert said == ["2 runs, 2 of them finished before"]


def test_a_table_of_nothing_is_refused(plan):
    with pytest.raises(InputError, match="at least 1 seed, got 0"):
        replace(plan, seeds=0)


def test_an_experiment_that_the_rows_do_not_suit_is_refused_before_anything_is_trained():
    with pytest.raises(InputError, match="no term 'squared' to drop"):
        Plan(TABLES["3.4"], CATALOGUE["compact"], 3)
