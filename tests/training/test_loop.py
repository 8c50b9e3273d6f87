"""The loop on a network of one convolution: small enough to be killed and resumed in a test."""

import json
from dataclasses import replace

import pytest
import torch
from torch import nn

from flexdepth.losses import Silog
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction
from flexdepth.training.averaging import follow
from flexdepth.training.batches import BatchSettings, whole
from flexdepth.training.checkpoint import Checkpoint, load, restore, save
from flexdepth.training.loop import LoopSettings, Run, Sources, train
from flexdepth.training.objective import Term, objective
from flexdepth.training.optimiser import OptimiserSettings
from flexdepth.training.record import Record

TERMS = {"silog": Term(Silog(0.5))}
SETTINGS = LoopSettings(
    iterations=6,
    save_every=2,
    batches=BatchSettings(size=2, shapes=((32, 32),)),
    optimiser=OptimiserSettings(rate=0.1, warm_up=2),
)


class OneConvolution(nn.Module):
    def __init__(self):
        super().__init__()
        self.encoder = nn.Conv2d(3, 3, 1)
        self.norm = nn.BatchNorm2d(3)
        self.decoder = nn.Conv2d(3, 1, 1)

    def forward(self, image):
        features = self.norm(self.encoder(image))
        return Prediction(self.decoder(features)[:, 0].exp(), canonical_focal=0.8)


def network():
    torch.manual_seed(0)
    return OneConvolution()


def trained(pairs, folder, run, settings=SETTINGS, keep=lambda _run, _score: None):
    record = Record(folder / "log.jsonl", settings.iterations, lambda _line: None)
    train(run, settings, TERMS, Sources(pairs, pairs[:2], 0), record, keep)
    return run


def test_training_lowers_the_held_out_error(pairs, tmp_path):
    scores = []
    settings = replace(SETTINGS, iterations=60, save_every=20, average_decay=0.9)
    trained(
        pairs, tmp_path, Run.started(network(), settings), settings, lambda _, s: scores.append(s)
    )
    assert len(scores) == 3
    assert scores[-1] < scores[0]


def test_a_run_killed_and_resumed_ends_with_the_same_bits(pairs, tmp_path):
    straight = trained(pairs, tmp_path, Run.started(network(), SETTINGS))

    class KilledError(Exception):
        pass

    def save_and_die(run, _score):
        save(tmp_path / "latest.safetensors", run.checkpoint({}))
        raise KilledError

    with pytest.raises(KilledError):
        trained(pairs, tmp_path, Run.started(network(), SETTINGS), keep=save_and_die)
    resumed = Run.started(OneConvolution(), SETTINGS)
    resumed.resume(load(tmp_path / "latest.safetensors"), "latest.safetensors")
    assert resumed.iteration == 2
    trained(pairs, tmp_path, resumed)
    for part in ("network", "average"):
        wanted = getattr(straight, part).state_dict()
        for name, value in getattr(resumed, part).state_dict().items():
            assert torch.equal(value, wanted[name]), (part, name)


def test_the_log_holds_every_validation(pairs, tmp_path):
    trained(pairs, tmp_path, Run.started(network(), SETTINGS))
    lines = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert [line["iteration"] for line in lines if "held_out_abs_rel" in line] == [2, 4, 6]


def test_an_objective_that_is_not_finite_names_its_terms(pairs):
    sample = whole(pairs, [0])
    depth = torch.full((1, 48, 64), torch.nan)
    with pytest.raises(FloatingPointError, match="silog nan"):
        objective(TERMS, Prediction(depth, 0.8), sample)


def test_the_objective_is_the_weighted_sum_of_its_terms(pairs):
    sample = whole(pairs, [0, 1])
    prediction = Prediction(torch.full((2, 48, 64), 2.0), 0.8)
    terms = {"a": Term(Silog(0.5), 2.0), "b": Term(Silog(0.0), 3.0)}
    total, parts = objective(terms, prediction, sample)
    assert float(total) == pytest.approx(2 * float(parts["a"]) + 3 * float(parts["b"]))


def test_the_average_moves_by_the_share_that_does_not_stay():
    average, target = nn.Linear(1, 1, bias=False), nn.Linear(1, 1, bias=False)
    nn.init.constant_(average.weight, 0.0)
    nn.init.constant_(target.weight, 1.0)
    follow(average, target, 0, 0.998)
    assert average.weight.item() == pytest.approx(0.9)
    nn.init.constant_(average.weight, 0.0)
    follow(average, target, 10**6, 0.998)
    assert average.weight.item() == pytest.approx(0.002, rel=1e-3)


def test_the_rate_rises_then_falls_to_nothing():
    settings = OptimiserSettings(rate=1.0, warm_up=10)
    assert settings.rate_at(0, 110) == pytest.approx(0.1)
    assert settings.rate_at(9, 110) == pytest.approx(1.0)
    assert settings.rate_at(60, 110) == pytest.approx(0.5)
    assert settings.rate_at(110, 110) == pytest.approx(0.0)


def test_the_encoder_learns_more_slowly_and_biases_do_not_decay():
    optimiser = OptimiserSettings(rate=1.0, encoder_share=0.3, weight_decay=0.1).build(network())
    shares = sorted(
        (g["share"], g["weight_decay"], len(g["params"])) for g in optimiser.param_groups
    )
    assert shares == [(0.3, 0.0, 1), (0.3, 0.1, 1), (1.0, 0.0, 3), (1.0, 0.1, 1)]


def test_a_checkpoint_comes_back_to_the_bit(tmp_path):
    path = tmp_path / "a.safetensors"
    weights = {"network.x": torch.randn(3, 2), "average.x": torch.randn(1)}
    save(path, Checkpoint(7, {"seed": 1}, weights))
    found = load(path)
    assert (found.iteration, found.settings) == (7, {"seed": 1})
    assert torch.equal(found.part("network")["x"], weights["network.x"])
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("content", [b"", b"garbage", b"\x80\x04\x95pickle", b"\xff" * 64])
def test_a_file_that_is_no_checkpoint_is_refused(tmp_path, content):
    path = tmp_path / "a.safetensors"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.safetensors: not a readable safetensors file"):
        load(path)


def test_a_missing_checkpoint_is_named(tmp_path):
    with pytest.raises(InputError, match="no such checkpoint"):
        load(tmp_path / "none.safetensors")


def test_weights_of_another_network_are_refused_with_the_names_that_differ():
    weights = {"weight": torch.zeros(2, 2), "extra": torch.zeros(1)}
    with pytest.raises(InputError, match=r"missing \['bias'\], unknown \['extra'\].*\['weight'\]"):
        restore(nn.Linear(3, 1), weights, "run")
