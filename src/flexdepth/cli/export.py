"""`flexdepth export CHECKPOINT -o BUNDLE`: make a trained network usable without torch."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.experiments.run import trained_network
from flexdepth.export import export
from flexdepth.networks.compact import CompactNetwork
from flexdepth.runtime.bundle import Description
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.fields import is_positive


@dataclass(frozen=True)
class Export:
    """Write a checkpoint's averaged network as an ONNX bundle for `flexdepth predict --model`.

    The bundle's depth is compared with the network's before the file appears.
    """

    checkpoint: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="CHECKPOINT")]
    """A .safetensors file that `flexdepth train` wrote."""
    output: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="BUNDLE")]
    """The .onnx file to write; one that is there is replaced."""
    name: str = "compact"
    """What depth files made with the bundle say of their model."""
    version: str = "0.1.0"
    """Of the weights."""
    licence: str = "MIT"
    """Of the weights, as an SPDX identifier."""
    source: str = "trained with flexdepth"
    """How the weights were made, in one line."""
    scale_spread: float | None = None
    """Relative standard deviation of metres by one factor for a whole map, as
    `benchmarks/certainty.py` measures it."""
    depth_factor: float = 1.0
    """What every pixel's depth is multiplied by, where metres come out too small or too large."""
    spread_factor: float = 1.0
    """What every pixel's spread is multiplied by, as `benchmarks/certainty.py` measures it."""
    area: tuple[int, int] = (384, 288)
    """Width and height whose product is the number of pixels that the network runs at."""


def run(arguments: Sequence[str]) -> int:
    """Export the checkpoint that `arguments` name."""
    with told_in_one_line("flexdepth export"):
        settings = tyro.cli(Export, args=arguments, prog="flexdepth export")
    for name, factor in (
        ("--depth-factor", settings.depth_factor),
        ("--spread-factor", settings.spread_factor),
    ):
        if not is_positive(factor):
            raise InputError(f"{name}: a number above 0 was wanted, got {factor:g}")
    network = trained_network(settings.checkpoint)
    if not isinstance(network, CompactNetwork):
        raise InputError(
            f"{settings.checkpoint}: a bundle is made of the network Compact, "
            f"this is {type(network.settings).__name__}"
        )
    network.head.stretch(settings.depth_factor)
    network.spread.widen(settings.spread_factor)
    description = Description(
        name=settings.name,
        version=settings.version,
        licence=settings.licence,
        space=Space.METRIC,
        area=settings.area,
        multiple=32,
        canonical_focal=network.settings.canonical_focal,
        source=settings.source,
        scale_spread=settings.scale_spread,
    )
    parity = export(network, description, settings.output)
    megabytes = settings.output.stat().st_size / 1e6
    sys.stdout.write(
        f"{settings.output}: {megabytes:.1f} MB; depth differs from the network's by "
        f"{parity.median:.2%} at the median, {parity.high:.2%} at the 99th percentile\n"
    )
    return 0
