import json
from dataclasses import dataclass

import pytest
import torch
from torch import nn

from flexdepth.codec import Codec
from flexdepth.training.checkpoint import optimiser_tensors, restore_optimiser
from flexdepth.training.optimiser import AdamWCosine, Optimiser, SGDPolynomial, set_rate


class Tiny(nn.Module):
    def __init__(self):
        super().__init__()
        self.encoder = nn.Linear(1, 1)
        self.norm = nn.BatchNorm1d(1)


@pytest.mark.parametrize(
    ("power", "iteration", "rate"),
    [
        (1.0, 0, 0.003),
        (1.0, 24_825, 0.00225),
        (1.0, 49_650, 0.0015),
        (1.0, 99_299, 0.003 / 99_300),
        (0.9, 0, 0.003),
        (0.9, 49_650, 0.00160766),
        (0.9, 89_370, 0.00037768),
        (2.0, 49_650, 0.00075),
    ],
)
def test_the_rate_falls_to_nothing_as_a_power_of_what_is_left(power, iteration, rate):
    """2 ** -0.9 is 0.535887, 10 ** -0.9 is 0.125893."""
    settings = SGDPolynomial(rate=0.003, power=power)
    assert settings.rate_at(iteration, 99_300) == pytest.approx(rate, rel=1e-5)


def test_encoder_and_decoder_learn_alike_and_everything_decays():
    network = Tiny()
    (group,) = SGDPolynomial(weight_decay=0.1).build(network).param_groups
    assert len(group["params"]) == 4
    assert (group["share"], group["weight_decay"]) == (1.0, 0.1)


def test_two_steps_of_momentum_worked_by_hand():
    """From 2 with gradients 1 and 0: v = 1 + .1 · 2 = 1.2, w = 2 − .5 · 1.2 = 1.4; then
    v = .9 · 1.2 + .1 · 1.4 = 1.22, w = 1.4 − .25 · 1.22 = 1.095."""
    network = nn.Linear(1, 1, bias=False)
    nn.init.constant_(network.weight, 2.0)
    settings = SGDPolynomial(rate=0.5, momentum=0.9, weight_decay=0.1)
    optimiser = settings.build(network)
    for iteration, gradient, weight in ((0, 1.0, 1.4), (1, 0.0, 1.095)):
        set_rate(optimiser, settings.rate_at(iteration, 2))
        network.weight.grad = torch.full((1, 1), gradient)
        nn.utils.clip_grad_norm_(network.parameters(), settings.largest_gradient)
        optimiser.step()
        assert network.weight.item() == pytest.approx(weight)


def test_as_published_no_gradient_is_too_large():
    weight = nn.Parameter(torch.zeros(2))
    weight.grad = torch.tensor([3e8, -4e8])
    nn.utils.clip_grad_norm_([weight], SGDPolynomial().largest_gradient)
    assert weight.grad.tolist() == [3e8, -4e8]


@pytest.mark.parametrize("settings", [AdamWCosine(), SGDPolynomial()])
def test_a_resumed_optimiser_goes_on_to_the_bit(settings):
    def stepped(network, optimiser, steps):
        for step in steps:
            torch.manual_seed(step)
            for weight in network.parameters():
                weight.grad = torch.randn_like(weight)
            optimiser.step()

    torch.manual_seed(0)
    straight, resumed = Tiny(), Tiny()
    first, second = settings.build(straight), settings.build(resumed)
    stepped(straight, first, (1, 2))
    resumed.load_state_dict(straight.state_dict())
    stored = {name: value.clone() for name, value in optimiser_tensors(first).items()}
    restore_optimiser(second, stored)
    for network, optimiser in ((straight, first), (resumed, second)):
        stepped(network, optimiser, (3, 4))
    for name, value in straight.state_dict().items():
        assert torch.equal(value, resumed.state_dict()[name]), name


@dataclass(frozen=True)
class Holder:
    optimiser: Optimiser


@pytest.mark.parametrize("settings", [AdamWCosine(2e-3), SGDPolynomial(0.01, power=0.9)])
def test_every_optimiser_survives_a_file(settings):
    codec = Codec((Optimiser,))
    values = json.loads(json.dumps(codec.plain(Holder(settings))))
    assert codec.restored(Holder, values, "file") == Holder(settings)
