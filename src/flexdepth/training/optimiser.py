"""How weights move: the optimisers, each with the schedule of its learning rate.

Every optimiser has groups of weights, each with its `share` of the rate; `rate_at` says the rate
of a share of one.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import cos, inf, pi

from torch import nn
from torch.optim import SGD, AdamW, Optimizer


@dataclass(frozen=True)
class AdamWCosine:
    """AdamW with a warm start and a cosine to zero; the pretrained encoder learns more slowly.

    Attributes:
        rate: Highest learning rate of the decoder.
        encoder_share: The encoder's learning rate as a share of it.
        weight_decay: Of weights with more than one dimension.
        warm_up: Iterations over which the rate rises from zero.
        largest_gradient: The gradient's norm is clipped to this.
    """

    rate: float = 1e-3
    encoder_share: float = 0.3
    weight_decay: float = 0.02
    warm_up: int = 200
    largest_gradient: float = 1.0

    def build(self, network: nn.Module) -> AdamW:
        """Return the optimiser of a network whose encoder's weights are named `encoder.*`."""
        named = dict(network.named_parameters())
        encoder = [w for name, w in named.items() if name.startswith("encoder.")]
        decoder = [w for name, w in named.items() if not name.startswith("encoder.")]
        groups = [
            {"params": weights, "share": share, "weight_decay": decay}
            for part, share in ((encoder, self.encoder_share), (decoder, 1.0))
            for weights, decay in _by_shape(part, self.weight_decay)
        ]
        return AdamW(groups, lr=self.rate)

    def rate_at(self, iteration: int, iterations: int) -> float:
        """Return the decoder's learning rate at an iteration of a run."""
        if iteration < self.warm_up:
            return self.rate * (iteration + 1) / self.warm_up
        done = (iteration - self.warm_up) / max(1, iterations - self.warm_up)
        return self.rate * 0.5 * (1 + cos(pi * min(done, 1.0)))


@dataclass(frozen=True)
class SGDPolynomial:
    """SGD with momentum and a power of what is left of the run, one rate for all weights.

    Attributes:
        rate: Learning rate of the first iteration.
        momentum: Share of each step that the next one repeats.
        weight_decay: Of every weight, of biases and normalisations too.
        power: Of the share of iterations that are left; 1 is a straight line to zero.
        largest_gradient: The gradient's norm is clipped to this; `inf` leaves it alone.

    References:
        Yin et al., ICCV 2019, whose code divides the weights into those of the encoder and the
        rest and gives both the same rate.
    """

    rate: float = 0.003
    momentum: float = 0.9
    weight_decay: float = 5e-4
    power: float = 1.0
    largest_gradient: float = inf

    def build(self, network: nn.Module) -> SGD:
        """Return the optimiser of a network."""
        group = {"params": list(network.parameters()), "share": 1.0}
        return SGD([group], self.rate, self.momentum, weight_decay=self.weight_decay)

    def rate_at(self, iteration: int, iterations: int) -> float:
        """Return `rate · (1 − iteration / iterations) ** power`."""
        left = max(0.0, 1 - iteration / iterations)
        return float(self.rate * left**self.power)


Optimiser = AdamWCosine | SGDPolynomial
"""The settings of any optimiser here."""


def _by_shape(
    weights: Iterable[nn.Parameter], decay: float
) -> tuple[tuple[list[nn.Parameter], float], tuple[list[nn.Parameter], float]]:
    weights = list(weights)
    flat = [w for w in weights if w.ndim <= 1]
    return (([w for w in weights if w.ndim > 1], decay), (flat, 0.0))


def set_rate(optimiser: Optimizer, rate: float) -> None:
    """Give every group its share of the learning rate."""
    for group in optimiser.param_groups:
        group["lr"] = rate * group["share"]
