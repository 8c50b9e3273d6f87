"""The moving average of the weights: steadier than the weights of any one iteration."""

import torch
from torch import nn


def follow(average: nn.Module, network: nn.Module, iteration: int, decay: float) -> None:
    """Move the average's weights and statistics towards the network's.

    The share that stays is `min(decay, (1 + i) / (10 + i))`, so that the first iterations, where
    everything still changes, are soon forgotten.
    """
    stays = min(decay, (1 + iteration) / (10 + iteration))
    with torch.no_grad():
        state = network.state_dict()
        for name, value in average.state_dict().items():
            if value.is_floating_point():
                value.lerp_(state[name], 1 - stays)
            else:
                value.copy_(state[name])
