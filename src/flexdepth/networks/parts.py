"""What a network is made of: the parameters and the multiplications of its parts."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import torch
from torch import nn
from torch.utils.flop_counter import FlopCounterMode

from flexdepth.networks import EDRB, Network
from flexdepth.networks.aga import Stage
from flexdepth.networks.edrb import RowsNetwork
from flexdepth.networks.encoders import FeatureEncoder
from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class Part:
    """A part of a network.

    Attributes:
        name: Where it is, with dots; empty for the whole network. `encoder.layer1` is a part of
            `encoder`.
        parameters: What can be learnt in it.
        multiplications: Of its convolutions and matrix products, for one image, each with an
            addition (MACs).
    """

    name: str
    parameters: int
    multiplications: int


def parts(settings: Network, width: int, height: int) -> tuple[Part, ...]:
    """Return the whole network and then its parts, each before the parts of its own.

    The network is built and run without memory: nothing is computed but shapes.

    Args:
        settings: Of the network.
        width: Of the image, in pixels.
        height: Of the image, in pixels.

    Raises:
        InputError: The network cannot be built, or its encoder takes no image of this size.
    """
    counter = FlopCounterMode(display=False)
    with torch.device("meta"), torch.no_grad():
        network = settings.build().eval()
        image = torch.empty(1, 3, height, width)
        try:
            with counter:
                network(image)
        except (AssertionError, RuntimeError) as error:
            name = type(settings).__name__ if isinstance(settings, EDRB) else settings.encoder.name
            raise InputError(
                f"{name} takes no image of {width} x {height} pixels ({error})"
            ) from error
    root, counts = type(network).__name__, counter.get_flop_counts()
    counted = {name.removeprefix(f"{root}."): sum(c.values()) // 2 for name, c in counts.items()}
    counted[""] = counted[root]
    return tuple(
        Part(
            name.replace(".trunk", ""),
            sum(p.numel() for p in module.parameters()),
            _multiplications(name, module, counted),
        )
        for name, module in _opened("", network)
        if not name.endswith(".trunk") and any(True for _ in module.parameters())
    )


def _multiplications(name: str, module: nn.Module, counted: Mapping[str, int]) -> int:
    """Return what was counted while the module ran; a list of modules does not run itself."""
    if name in counted:
        return counted[name]
    children = module.named_children()
    return sum(_multiplications(f"{name}.{child}", part, counted) for child, part in children)


def _opened(name: str, module: nn.Module) -> Iterator[tuple[str, nn.Module]]:
    yield name, module
    holds_parts = isinstance(module, nn.ModuleList | FeatureEncoder | Stage | RowsNetwork)
    if not name or name.endswith(".trunk") or holds_parts:
        for child, part in module.named_children():
            yield from _opened(f"{name}.{child}".lstrip("."), part)
