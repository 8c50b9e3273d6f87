import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.training.averaging import estimate_statistics, follow, mean_of


def test_the_average_moves_by_the_share_that_does_not_stay():
    average, target = nn.Linear(1, 1, bias=False), nn.Linear(1, 1, bias=False)
    nn.init.constant_(average.weight, 0.0)
    nn.init.constant_(target.weight, 1.0)
    follow(average, target, 0, 0.998)
    assert average.weight.item() == pytest.approx(0.9)
    nn.init.constant_(average.weight, 0.0)
    follow(average, target, 10**6, 0.998)
    assert average.weight.item() == pytest.approx(0.002, rel=1e-3)


def test_the_mean_of_two_networks_is_by_their_shares():
    one = {"weight": torch.tensor([1.0, 2.0]), "count": torch.tensor(7)}
    other = {"weight": torch.tensor([5.0, 6.0]), "count": torch.tensor(9)}
    found = mean_of([one, other], [3.0, 1.0])
    assert_close(found["weight"], torch.tensor([2.0, 3.0]))
    assert found["count"] == 7


def test_statistics_are_those_of_the_batches():
    """One channel in batches of 0 and 2, and of 4 and 4: means 1 and 4, variances 2 and 0."""
    network = nn.Sequential(nn.BatchNorm2d(1))
    network[0].running_mean.fill_(99)
    batches = [torch.tensor([[[[0.0, 2.0]]]]), torch.tensor([[[[4.0, 4.0]]]])]
    estimate_statistics(network, batches)
    assert_close(network[0].running_mean, torch.tensor([2.5]))
    assert_close(network[0].running_var, torch.tensor([1.0]))
    assert not network[0].training
    assert network[0].momentum == 0.1


def test_weights_stay_where_statistics_are_estimated():
    network = nn.Sequential(nn.Conv2d(3, 2, 1), nn.BatchNorm2d(2))
    before = {name: value.clone() for name, value in network.named_parameters()}
    estimate_statistics(network, [torch.rand(2, 3, 4, 4)])
    assert all(torch.equal(value, before[name]) for name, value in network.named_parameters())
