"""Fewer weights: two ways to leave out those that matter least by their size.

Section 3.5.2 of the dissertation proposes to prune the EDRB network, "as the network has lots of
parameters", and does not say how.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

from torch import Tensor, nn
from torch.nn.utils import prune

from flexdepth.networks.edrb import EDRBMapsNetwork, EDRBNetwork
from flexdepth.networks.extended import DenseBranch, ExtendedResidualBlock
from flexdepth.runtime.errors import InputError

Extended = TypeVar("Extended", EDRBNetwork, EDRBMapsNetwork)


def _check_share(share: float) -> None:
    if not 0 < share < 1:
        raise InputError(f"pruning leaves out a share between 0 and 1, got {share:g}")


@dataclass(frozen=True)
class SmallestWeights:
    """The smallest weights of all convolutions together become zero.

    The network keeps its shape, and takes as long as before: what shrinks is the file, when it is
    compressed, and the number of weights that learn.

    Attributes:
        share: Of the weights, that become zero.

    Raises:
        InputError: The share is not between 0 and 1.

    References:
        Han, Pool, Tran and Dally, NeurIPS 2015, section 3, with one threshold for all layers.
    """

    share: float = 0.5

    def __post_init__(self) -> None:
        _check_share(self.share)

    def prune(self, network: nn.Module) -> None:
        """Set the weights of a network to zero and hold them there while it learns on."""
        prune.global_unstructured(
            [(conv, "weight") for conv in _convolutions(network)],
            pruning_method=prune.L1Unstructured,
            amount=self.share,
        )

    def settle(self, network: nn.Module) -> None:
        """Make a network that `prune` holds an ordinary one again, with its zeros."""
        for conv in _convolutions(network):
            prune.remove(conv, "weight")  # type: ignore[no-untyped-call]


@dataclass(frozen=True)
class WeakestChannels:
    """The weakest channels between the convolutions of every branch are taken out.

    What is left is a smaller network of the same kind, which takes less time. A channel is as
    strong as what it can add: its scale and offset in the normalisation, times the sum of the
    absolute weights that go out of it.

    Attributes:
        share: Of the channels inside each branch, that are taken out.

    Raises:
        InputError: The share is not between 0 and 1.

    References:
        Li, Kadav, Durdanovic, Samet and Graf, ICLR 2017, who sum the weights that come in; behind
        a normalisation their size says nothing.
    """

    share: float = 0.5

    def __post_init__(self) -> None:
        _check_share(self.share)

    def pruned(self, network: Extended) -> Extended:
        """Return a smaller network; the one given stays as it is.

        Raises:
            InputError: Its blocks are not of `DenseBranch`, or a branch has no channel left.
        """
        settings = network.settings
        branch = settings.rows.block.branch
        if not isinstance(branch, DenseBranch):
            raise InputError(
                f"channels are taken out of dense branches, but this network is made of {branch}"
            )
        narrower = settings.rows.made_of(DenseBranch(branch.share * (1 - self.share)))
        smaller = replace(settings, rows=narrower).build()
        weights, wanted = network.state_dict(), smaller.state_dict()
        for place in _branches(network):
            _narrow(weights, place, len(wanted[f"{place}.0.weight"]))
        smaller.load_state_dict(weights)
        return smaller


def _convolutions(network: nn.Module) -> list[nn.Conv2d]:
    return [module for module in network.modules() if isinstance(module, nn.Conv2d)]


def _branches(network: nn.Module) -> Iterator[str]:
    for name, block in network.named_modules():
        if isinstance(block, ExtendedResidualBlock):
            yield f"{name}.refine"
            yield from (f"{name}.again.{number}" for number in range(len(block.again)))


def _narrow(weights: dict[str, Tensor], branch: str, width: int) -> None:
    """Leave the `width` strongest channels between the convolutions of a branch."""
    scale, offset, outgoing = (weights[f"{branch}.{x}"] for x in ("1.weight", "1.bias", "3.weight"))
    strength = (scale.abs() + offset.abs()) * outgoing.abs().sum((0, 2, 3))
    kept = strength.topk(width).indices.sort().values
    inner = ("0.weight", "0.bias", "1.weight", "1.bias", "1.running_mean", "1.running_var")
    for name in inner:
        weights[f"{branch}.{name}"] = weights[f"{branch}.{name}"][kept]
    weights[f"{branch}.3.weight"] = outgoing[:, kept]
