"""`flexdepth show NETWORK`: what a network is made of."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.geometry.depth import NYU_BINS
from flexdepth.networks import AGA, Compact, Network
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.heads import BinnedDepth
from flexdepth.networks.merge import VARIANTS
from flexdepth.networks.parts import Part, parts
from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class ShowAGA:
    """The network of chapter 3, its base among it: parts, parameters, multiplications (MACs)."""

    encoder: Annotated[str, tyro.conf.arg(metavar="NAME")] = "resnext101_32x4d"
    """A network of timm."""
    output_stride: Annotated[int, tyro.conf.arg(metavar="N")] = 16
    """Image pixels per step of the encoder's coarsest features; not every encoder has a choice."""
    variant: Literal["S1", "S2", "S3", "S4", "S5", "S6", "S7", "DS7", "NS7"] = "S7"
    """How decoder and encoder are merged."""
    bins: Annotated[int, tyro.conf.arg(metavar="N")] = NYU_BINS.count
    """Into how many bins depth is divided."""
    size: tuple[int, int] = (384, 384)
    """Width and height of the image that is counted for."""

    def networks(self) -> dict[str, Network]:
        """Return the network, the base and the main variant, by name."""
        network = AGA(
            encoder=Encoder(self.encoder, self.output_stride),
            head=BinnedDepth(replace(NYU_BINS, count=self.bins)),
        )
        named = {self.variant: "", "S1": " (base)", "S7": " (AGA)"}
        return {f"{v}{what}": network.merged_by(VARIANTS[v]) for v, what in named.items()}


@dataclass(frozen=True)
class ShowCompact:
    """The network of the bundled model: parts, parameters, multiplications (MACs)."""

    encoder: Annotated[str, tyro.conf.arg(metavar="NAME")] = "tf_efficientnet_lite0"
    """A network of timm."""
    size: tuple[int, int] = (384, 288)
    """Width and height of the image that is counted for, multiples of 32."""

    def networks(self) -> dict[str, Network]:
        """Return the network by name."""
        return {"compact": Compact(encoder=Encoder(self.encoder))}


def run(arguments: Sequence[str]) -> int:
    """Show the network that `arguments` name."""
    with told_in_one_line("flexdepth show"):
        shown = tyro.extras.subcommand_cli_from_dict(
            {"aga": ShowAGA, "compact": ShowCompact}, args=arguments, prog="flexdepth show"
        )
    width, height = shown.size
    if width < 1 or height < 1:
        raise InputError(f"--size is a width and a height in pixels, got {width} {height}")
    tables = {name: parts(network, width, height) for name, network in shown.networks().items()}
    wholes = [replace(table[0], name=f"total {name}") for name, table in tables.items()]
    rows = [*next(iter(tables.values()))[1:], *wholes]
    heading = f"{'part':<22}{'parameters':>14}{'GMAC at ' + f'{width} x {height}':>24}\n"
    sys.stdout.write(heading + "".join(map(_line, rows)))
    return 0


def _line(part: Part) -> str:
    indent = "  " * part.name.count(".")
    return f"{indent + part.name:<22}{part.parameters:>14,}{part.multiplications / 1e9:>24,.3f}\n"
