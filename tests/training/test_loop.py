"""The loop on networks of one or two convolutions."""

import copy
from dataclasses import replace

import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.losses import Silog
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction
from flexdepth.training import loop
from flexdepth.training.batches import Batches, BatchSettings
from flexdepth.training.checkpoint import load, save
from flexdepth.training.loop import LoopSettings, Run, Sources, learn, train
from flexdepth.training.objective import Term, objective
from flexdepth.training.optimiser import AdamWCosine, SGDPolynomial
from flexdepth.training.processes import Place
from flexdepth.training.record import Silence

TERMS = {"silog": Term(Silog(0.5))}
SETTINGS = LoopSettings(
    iterations=6,
    save_every=2,
    batches=BatchSettings(size=2, shapes=((32, 32),)),
    optimiser=AdamWCosine(rate=0.1, warm_up=2),
)


def trained(pairs, run, settings=SETTINGS, keep=lambda _run, _score: None, terms=TERMS):
    train(run, settings, terms, Sources(pairs, pairs[:2], 0), Silence(), keep)
    return run


@pytest.mark.parametrize("precision", ["float32", "bfloat16"])
def test_training_lowers_the_held_out_error(pairs, network, precision):
    scores = []
    settings = replace(
        SETTINGS, iterations=60, save_every=20, average_decay=0.9, precision=precision
    )
    run = Run.started(network, settings)
    trained(pairs, run, settings, lambda _, score: scores.append(score))
    assert len(scores) == 3
    assert scores[-1] < scores[0]
    assert {weight.dtype for weight in run.network.parameters()} == {torch.float32}


def test_an_interrupted_run_ends_with_the_same_bits(pairs, network, tmp_path):
    interrupted = Run.started(copy.deepcopy(network), SETTINGS)
    straight = trained(pairs, Run.started(network, SETTINGS))

    def save_and_stop(run, _score):
        save(tmp_path / "latest.safetensors", run.checkpoint({}))
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        trained(pairs, interrupted, keep=save_and_stop)
    resumed = Run.started(type(network)(), SETTINGS)
    resumed.resume(load(tmp_path / "latest.safetensors"), "latest.safetensors")
    assert resumed.iteration == 2
    trained(pairs, resumed)
    for part in ("network", "average"):
        wanted = getattr(straight, part).state_dict()
        for name, value in getattr(resumed, part).state_dict().items():
            assert torch.equal(value, wanted[name]), (part, name)


PATIENT = replace(SETTINGS, iterations=12, save_every=1, patience=2)


@pytest.fixture
def found(monkeypatch):
    """Return a function that says which errors the next validations find."""

    def say(errors):
        coming = iter(errors)
        monkeypatch.setattr(loop, "validate", lambda *_: {"abs_rel": next(coming)})

    return say


@pytest.mark.parametrize(
    ("errors", "patience", "ended"),
    [
        ([5.0, 4.0, 4.5, 4.2], 2, 4),
        ([3.0, 3.0], 1, 2),
        ([3.0, 2.0, 2.0, 2.0], 2, 4),
        ([5.0, 6.0, 4.0, 4.5, 3.0, 7.0, 3.5, 3.1], 3, 8),
        ([float("nan"), 5.0, 6.0, float("nan")], 2, 4),
    ],
)
def test_a_run_ends_after_so_many_validations_without_a_lower_error(
    pairs, network, found, errors, patience, ended
):
    settings, saved = replace(PATIENT, patience=patience), []
    found(errors)
    run = trained(
        pairs, Run.started(network, settings), settings, lambda run, _: saved.append(run.iteration)
    )
    assert run.iteration == ended
    assert saved == list(range(1, ended + 1))


@pytest.mark.parametrize(
    ("errors", "patience"), [([1.0] * 12, None), ([5.0, 6.0, 4.0, 5.0, 3.0, 4.0] + [2.0] * 6, 6)]
)
def test_a_run_without_patience_or_with_enough_of_it_has_all_its_iterations(
    pairs, network, found, errors, patience
):
    settings = replace(PATIENT, patience=patience)
    found(errors)
    assert trained(pairs, Run.started(network, settings), settings).iteration == 12


@pytest.mark.parametrize("stop", [1, 2, 3, 4])
def test_an_interrupted_run_is_as_patient_as_one_that_is_not(pairs, network, found, tmp_path, stop):
    errors, latest = [5.0, 4.0, 4.5, 4.2], tmp_path / "latest.safetensors"
    interrupted = Run.started(copy.deepcopy(network), PATIENT)
    found(errors)
    straight = trained(pairs, Run.started(network, PATIENT), PATIENT)

    def save_and_stop(run, _score):
        save(latest, run.checkpoint({}))
        if run.iteration == stop:
            raise KeyboardInterrupt

    found(errors)
    with pytest.raises(KeyboardInterrupt):
        trained(pairs, interrupted, PATIENT, save_and_stop)
    resumed = Run.started(type(network)(), PATIENT)
    resumed.resume(load(latest), latest.name)
    trained(pairs, resumed, PATIENT)
    assert resumed.iteration == straight.iteration == 4
    assert resumed.errors == straight.errors == errors
    assert torch.equal(weights(resumed), weights(straight))


def test_only_the_named_parts_learn(pairs):
    network = nn.ModuleDict({"body": nn.BatchNorm2d(3), "head": nn.Conv2d(3, 1, 1)})
    network.forward = lambda image: Prediction(
        network["head"](network["body"](image))[:, 0].exp(), None
    )
    settings = replace(SETTINGS, learns=("head",))
    before = copy.deepcopy(network.state_dict())
    after = trained(pairs, Run.started(network, settings), settings).network.state_dict()
    changed = {name for name, value in after.items() if not torch.equal(value, before[name])}
    assert changed == {"head.weight", "head.bias"}


def test_a_part_that_the_network_lacks_cannot_learn(network):
    with pytest.raises(InputError, match=r"loop\.learns: the network has no 'tail', but "):
        Run.started(network, replace(SETTINGS, learns=("tail",)))


def test_parts_that_no_term_depends_on_cannot_learn(pairs):
    network = TwoConvolutions()
    network.unused = nn.Conv2d(3, 1, 1)
    settings = replace(SETTINGS, learns=("unused",))
    with pytest.raises(InputError, match="none of the terms silog depends on unused"):
        trained(pairs, Run.started(network, settings), settings)


class TwoConvolutions(nn.Module):
    """Without a normalisation, which would see a part of a batch alone."""

    def __init__(self):
        super().__init__()
        torch.manual_seed(0)
        self.encoder = nn.Conv2d(3, 4, 3, padding=1)
        self.decoder = nn.Conv2d(4, 1, 3, padding=1)

    def forward(self, image):
        depth = self.decoder(self.encoder(image).relu())[:, 0].exp()
        return Prediction(depth, canonical_focal=0.8, sky_logit=depth)


def weights(run):
    return torch.cat([weight.detach().flatten() for weight in run.network.parameters()])


@pytest.mark.parametrize("parts", [2, 4])
def test_a_batch_in_parts_teaches_what_the_whole_batch_teaches(pairs, parts):
    """With plain steps: those of AdamW do not see the gradient's length."""
    steps = SGDPolynomial(rate=0.1, weight_decay=0.0)
    settings = replace(SETTINGS, batches=replace(SETTINGS.batches, size=4), optimiser=steps)
    whole = trained(pairs, Run.started(TwoConvolutions(), settings), settings)
    divided = replace(settings, accumulate=parts)
    run = trained(pairs, Run.started(TwoConvolutions(), settings), divided)
    assert (weights(whole) - weights(Run.started(TwoConvolutions(), settings))).abs().max() > 0.1
    assert_close(weights(run), weights(whole), atol=1e-5, rtol=0)


def test_the_terms_of_a_batch_in_parts_are_those_of_the_whole(pairs):
    batch = Batches(pairs, replace(SETTINGS.batches, size=4), 1)[0]
    terms = {"silog": Term(Silog(0.5), 2.0)}
    whole = learn(TwoConvolutions(), SETTINGS, terms, batch)
    divided = learn(TwoConvolutions(), replace(SETTINGS, accumulate=2), terms, batch)
    assert whole["total"].item() == pytest.approx(2 * whole["silog"].item())
    assert_close(divided, whole, atol=1e-6, rtol=0)


def test_bfloat16_computes_the_network_alone(pairs, monkeypatch):
    network, seen = TwoConvolutions(), []
    network.decoder.register_forward_hook(lambda *said: seen.append(said[2].dtype))

    def told(terms, prediction, sample):
        seen.extend([prediction.depth.dtype, prediction.sky_logit.dtype])
        return objective(terms, prediction, sample)

    monkeypatch.setattr(loop, "objective", told)
    batch = Batches(pairs, SETTINGS.batches, 1)[0]
    rounded = learn(network, replace(SETTINGS, precision="bfloat16"), TERMS, batch)
    assert seen == [torch.bfloat16, torch.float32, torch.float32]
    found = [weight.grad for weight in network.parameters()]
    exact = learn(network, SETTINGS, TERMS, batch)
    assert seen[3:] == [torch.float32] * 3
    assert {gradient.dtype for gradient in found} == {torch.float32}
    assert rounded["total"] != exact["total"]
    assert_close(rounded["total"], exact["total"], atol=0, rtol=0.05)
    for gradient, weight in zip(found, network.parameters(), strict=True):
        largest = weight.grad.abs().max().item()
        assert_close(gradient, weight.grad, atol=0.1 * largest, rtol=0)


def test_processes_average_gradients_statistics_and_terms(pairs, network, monkeypatch):
    """The statistics' mean and variance, the gradients of six weights, a term and the sum."""
    averaged = []
    monkeypatch.setattr(Place, "average", lambda _, tensors: averaged.append(list(tensors)))
    trained(pairs, Run.started(network, SETTINGS), replace(SETTINGS, iterations=1))
    (tensors,) = averaged
    norm = network.norm
    assert any(tensor is norm.running_mean for tensor in tensors)
    assert any(tensor is norm.running_var for tensor in tensors)
    for weight in network.parameters():
        assert any(tensor is weight.grad for tensor in tensors)
    assert len(tensors) == 2 + 6 + 2


def test_an_objective_that_is_not_finite_stops_the_run_before_the_step(pairs, network):
    run = Run.started(network, SETTINGS)
    nn.init.constant_(network.decoder.bias, 200.0)
    before = weights(run)
    with pytest.raises(InputError, match=r"after 0 iterations: total (inf|nan), silog (inf|nan);"):
        trained(pairs, run)
    assert torch.equal(weights(run), before)


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({"iterations": 0}, "whole numbers >= 1, got 0, 250 and 1"),
        ({"save_every": 0}, "whole numbers >= 1"),
        ({"accumulate": -1}, "whole numbers >= 1"),
        ({"patience": 0}, "patience is a whole number >= 1 or none, got 0"),
        ({"average_decay": 1.0}, r"average_decay lies in \[0, 1\), got 1"),
    ],
)
def test_a_run_of_nothing_is_refused(wrong, complaint):
    with pytest.raises(InputError, match=complaint):
        LoopSettings(**wrong)


def test_the_rate_rises_then_falls_to_nothing():
    settings = AdamWCosine(rate=1.0, warm_up=10)
    assert settings.rate_at(0, 110) == pytest.approx(0.1)
    assert settings.rate_at(9, 110) == pytest.approx(1.0)
    assert settings.rate_at(60, 110) == pytest.approx(0.5)
    assert settings.rate_at(110, 110) == pytest.approx(0.0)


def test_the_encoder_learns_more_slowly_and_biases_do_not_decay(network):
    optimiser = AdamWCosine(rate=1.0, encoder_share=0.3, weight_decay=0.1).build(network)
    shares = sorted(
        (g["share"], g["weight_decay"], len(g["params"])) for g in optimiser.param_groups
    )
    assert shares == [(0.3, 0.0, 1), (0.3, 0.1, 1), (1.0, 0.0, 3), (1.0, 0.1, 1)]
