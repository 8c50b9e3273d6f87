"""AdamW with a warm start and a cosine to zero; the pretrained encoder learns more slowly."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import cos, pi

from torch import nn
from torch.optim import AdamW


@dataclass(frozen=True)
class OptimiserSettings:
    """How weights move.

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


def _by_shape(
    weights: Iterable[nn.Parameter], decay: float
) -> tuple[tuple[list[nn.Parameter], float], tuple[list[nn.Parameter], float]]:
    weights = list(weights)
    flat = [w for w in weights if w.ndim <= 1]
    return (([w for w in weights if w.ndim > 1], decay), (flat, 0.0))


def set_rate(optimiser: AdamW, rate: float) -> None:
    """Give every group its share of the learning rate."""
    for group in optimiser.param_groups:
        group["lr"] = rate * group["share"]
