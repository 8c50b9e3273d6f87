"""Means of weights: of the iterations of one run, and of several runs."""

from collections.abc import Iterable, Mapping, Sequence

import torch
from jaxtyping import Float
from torch import Tensor, nn


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


def mean_of(
    states: Sequence[Mapping[str, Tensor]], shares: Sequence[float]
) -> Mapping[str, Tensor]:
    """Return the mean of the weights of networks that were trained from one another.

    What is no real number, such as a count of batches, is the first one's.

    Args:
        states: At least one, all of the same names and shapes.
        shares: Of each; their sum counts as one.

    References:
        Wortsman et al., Model soups, ICML 2022.
    """
    parts = [share / sum(shares) for share in shares]

    def mean(name: str) -> Tensor:
        if not states[0][name].is_floating_point():
            return states[0][name]
        return torch.stack([p * state[name] for p, state in zip(parts, states, strict=True)]).sum(0)

    return {name: mean(name) for name in states[0]}


@torch.no_grad()
def estimate_statistics(
    network: nn.Module, batches: Iterable[Float[Tensor, "batch channels height width"]]
) -> None:
    """Give the batch normalisations the mean of the statistics of some batches.

    The statistics of a mean of networks are not the mean of theirs.

    Args:
        network: Is left in evaluation mode.
        batches: What the network takes.

    References:
        Izmailov et al., Averaging weights leads to wider optima, UAI 2018, section 3.
    """
    network.eval()
    normalisations = [each for each in network.modules() if isinstance(each, nn.BatchNorm2d)]
    momenta = [each.momentum for each in normalisations]
    for each in normalisations:
        each.reset_running_stats()
        each.momentum = None  # the mean of all batches
        each.train()
    for images in batches:
        network(images)
    for each, momentum in zip(normalisations, momenta, strict=True):
        each.momentum = momentum
        each.eval()
