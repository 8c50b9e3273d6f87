"""`flexdepth show WHAT`: what a network or an experiment is made of."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from types import MappingProxyType
from typing import Annotated, Literal

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.experiments.catalogue import experiment_named
from flexdepth.experiments.yaml_files import experiment_text
from flexdepth.geometry.depth import NYU_BINS
from flexdepth.networks import AGA, EDRB, PCA, Compact, Network
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

    def text(self) -> str:
        """Return the table of the network, with the base and the main variant below it."""
        network = AGA(
            encoder=Encoder(self.encoder, self.output_stride),
            head=BinnedDepth(replace(NYU_BINS, count=self.bins)),
        )
        named = {self.variant: "", "S1": " (base)", "S7": " (AGA)"}
        networks = {f"{v}{what}": network.merged_by(VARIANTS[v]) for v, what in named.items()}
        return _table(networks, self.size)


@dataclass(frozen=True)
class ShowCompact:
    """The network of the bundled model: parts, parameters, multiplications (MACs)."""

    encoder: Annotated[str, tyro.conf.arg(metavar="NAME")] = "tf_efficientnet_lite0"
    """A network of timm."""
    size: tuple[int, int] = (384, 288)
    """Width and height of the image that is counted for, multiples of 32."""

    def text(self) -> str:
        """Return the table of the network."""
        return _table({"compact": Compact(encoder=Encoder(self.encoder))}, self.size)


@dataclass(frozen=True)
class ShowEDRB:
    """The network of section 3.5.2: parts, parameters, multiplications (MACs)."""

    size: tuple[int, int] = (384, 384)
    """Width and height of the image that is counted for."""

    def text(self) -> str:
        """Return the table of the network."""
        return _table({"edrb": EDRB()}, self.size)


@dataclass(frozen=True)
class ShowPCA:
    """The network of section 3.5.1: parts, parameters, multiplications (MACs)."""

    size: tuple[int, int] = (384, 384)
    """Width and height of the image that is counted for, multiples of 32."""

    def text(self) -> str:
        """Return the table of the network."""
        return _table({"pca": PCA()}, self.size)


@dataclass(frozen=True)
class ShowExperiment:
    """An experiment with every field, as a .yaml file that `flexdepth train` takes."""

    name: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="EXPERIMENT")]
    """One that `flexdepth train --help` lists, or a .yaml file."""

    def text(self) -> str:
        """Return the YAML."""
        return experiment_text(experiment_named(self.name))


SHOWN: Mapping[str, type] = MappingProxyType(
    {
        "aga": ShowAGA,
        "compact": ShowCompact,
        "edrb": ShowEDRB,
        "pca": ShowPCA,
        "experiment": ShowExperiment,
    }
)
"""What can be shown, by name."""


def run(arguments: Sequence[str]) -> int:
    """Show what `arguments` name."""
    if not arguments:
        raise InputError(f"name what to show, one of {list(SHOWN)}")
    name = arguments[0]
    if name not in SHOWN and not name.startswith("-"):
        near = get_close_matches(name.lower(), SHOWN, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"choose one of {list(SHOWN)}"
        raise InputError(f"{name!r} cannot be shown; {hint}")
    with told_in_one_line("flexdepth show"):
        shown = tyro.extras.subcommand_cli_from_dict(
            dict(SHOWN), args=arguments, prog="flexdepth show"
        )
    sys.stdout.write(shown.text())
    return 0


def _table(networks: Mapping[str, Network], size: tuple[int, int]) -> str:
    """Return the parts of the first network, and the totals of all."""
    width, height = size
    if width < 1 or height < 1:
        raise InputError(f"--size is a width and a height in pixels, got {width} {height}")
    tables = {name: parts(network, width, height) for name, network in networks.items()}
    wholes = [replace(table[0], name=f"total {name}") for name, table in tables.items()]
    rows = [*next(iter(tables.values()))[1:], *wholes]
    heading = f"{'part':<22}{'parameters':>14}{'GMAC at ' + f'{width} x {height}':>24}\n"
    return heading + "".join(map(_line, rows))


def _line(part: Part) -> str:
    indent = "  " * part.name.count(".")
    return f"{indent + part.name:<22}{part.parameters:>14,}{part.multiplications / 1e9:>24,.3f}\n"
