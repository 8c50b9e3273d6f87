import pytest
from torch import nn

from flexdepth.training.averaging import follow


def test_the_average_moves_by_the_share_that_does_not_stay():
    average, target = nn.Linear(1, 1, bias=False), nn.Linear(1, 1, bias=False)
    nn.init.constant_(average.weight, 0.0)
    nn.init.constant_(target.weight, 1.0)
    follow(average, target, 0, 0.998)
    assert average.weight.item() == pytest.approx(0.9)
    nn.init.constant_(average.weight, 0.0)
    follow(average, target, 10**6, 0.998)
    assert average.weight.item() == pytest.approx(0.002, rel=1e-3)
