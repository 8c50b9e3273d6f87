from importlib import import_module
from pathlib import Path

import pytest
import torch
from torch.utils.flop_counter import FlopCounterMode

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def network(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    with torch.device("meta"):
        return import_module("midas_small").MidasSmall().eval()


def test_its_arithmetic_is_the_published_one(network):
    with torch.no_grad(), FlopCounterMode(display=False) as counter:
        disparity = network(torch.zeros(1, 3, 256, 256, device="meta"))
    assert disparity.shape == (1, 256, 256)
    # 4.6 GMAC; an operation of the counter is half a multiply-accumulate.
    assert counter.get_total_flops() / 2 == pytest.approx(4.6e9, rel=0.05)


def test_its_weights_are_those_of_the_published_conversion(network):
    # 33 MB in half precision.
    assert sum(each.numel() for each in network.parameters()) * 2 == pytest.approx(33e6, rel=0.02)


def test_its_layers_are_those_of_the_published_conversion(network):
    convolutions = [each for each in network.modules() if isinstance(each, torch.nn.Conv2d)]
    assert sum(each.groups == 1 for each in convolutions) == 73
    assert sum(each.groups == each.in_channels for each in convolutions) == 24
