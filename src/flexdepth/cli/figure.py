"""`flexdepth figure NAME`: figures of chapter 3, of any photos or data."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import tyro
from PIL import Image

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.cli.weights import start_of
from flexdepth.data.folder import Folder
from flexdepth.data.transforms import as_sample
from flexdepth.experiments.figures import (
    attention_figure,
    edges_figure,
    look,
    strongest,
    truth_beside,
)
from flexdepth.experiments.plots import enough, write_emphasis, write_explained
from flexdepth.experiments.run import network_with
from flexdepth.networks import PCA
from flexdepth.networks.depth_basis import Basis
from flexdepth.runtime.atomic import check_writable, replacing
from flexdepth.runtime.colour import Pixels
from flexdepth.runtime.errors import InputError

_Photos = Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="PHOTO")]
_Weights = Annotated[str, tyro.conf.arg(metavar="WEIGHTS")]
_Folder = Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="DIR")]
_Truth = Annotated[Path | None, tyro.conf.arg(metavar="DIR")]


@dataclass(frozen=True)
class AttentionFigure:
    """Photo, attention map, prediction and, where it is known, truth (Fig. 3.12)."""

    photos: _Photos
    """The photos. Of ROOT/image/NAME the truth is ROOT/depth/NAME, where there is such a file."""
    weights: _Weights = "bundled"
    """`bundled`, a bundle (.onnx) or a checkpoint (.safetensors) of any network with AGA merges."""
    map: Literal["strongest", "finest"] = "strongest"
    """Which attention map: that with the largest mean, or that of the last merge."""
    truth: _Truth = None
    """A folder of depth files NAME.npz, or of another format."""
    output_dir: _Folder = Path("figures")
    """Gets NAME.attention.png."""

    def write(self) -> None:
        """Write a figure for each photo."""
        network = network_with(start_of(self.weights, "--weights"))
        for photo in _checked(self.photos, self.output_dir):
            seen = look(network, photo, truth_beside(photo, self.truth))
            which = strongest(seen.attention)
            number = which if self.map == "strongest" else len(seen.attention) - 1
            _write(self.output_dir / f"{photo.stem}.attention.png", attention_figure(seen, number))


@dataclass(frozen=True)
class EdgesFigure:
    """Photo and depth, and the edges of both (Figs 1.7 and 3.2)."""

    photos: _Photos
    """The photos. Depth is the truth where there is one, as for `attention`, else predicted."""
    weights: _Weights = "bundled"
    """Of the network that predicts: `bundled`, a bundle or a checkpoint."""
    truth: _Truth = None
    """A folder of depth files NAME.npz, or of another format."""
    output_dir: _Folder = Path("figures")
    """Gets NAME.edges.png."""

    def write(self) -> None:
        """Write a figure for each photo."""
        network = network_with(start_of(self.weights, "--weights"))
        for photo in _checked(self.photos, self.output_dir):
            seen = look(network, photo, truth_beside(photo, self.truth))
            found, title = (seen.depth, "predicted depth")
            if seen.truth is not None:
                found, title = seen.truth, "true depth"
            _write(
                self.output_dir / f"{photo.stem}.edges.png", edges_figure(seen.photo, found, title)
            )


@dataclass(frozen=True)
class EmphasisFigure:
    """x exp(x) beside x: how AGA emphasises similarity (Fig. 3.6)."""

    output: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="FILE")] = Path(
        "figures/emphasis.png"
    )
    """The picture; its suffix says the format."""

    def write(self) -> None:
        """Write the figure."""
        check_writable(self.output.parent)
        write_emphasis(self.output)
        _say(str(self.output))


@dataclass(frozen=True)
class PCAFigure:
    """How many principal components explain how much of the depth of a data set (3.5.1)."""

    data: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    """A folder of image/ and depth/, as `flexdepth synth` and `flexdepth data convert` write."""
    basis: Annotated[Basis, tyro.conf.arg(name="")] = field(
        default_factory=lambda: Basis(scale="log")
    )
    """How the basis is made."""
    output: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="FILE")] = Path(
        "figures/pca.png"
    )
    """The picture; its suffix says the format."""

    def write(self) -> None:
        """Write the figure, and say the numbers."""
        check_writable(self.output.parent)
        pairs = Folder(self.data).load()
        samples = (as_sample(pairs[number]) for number in range(len(pairs)))
        basis = PCA(basis=self.basis).fit(samples)
        write_explained(self.output, basis, self.basis)
        counts = ((share, enough(basis, share)) for share in (0.8, 0.9, 0.95, 0.99))
        said = ", ".join(f"{count} explain {share:.0%}" for share, count in counts if count)
        _say(f"{self.output}: of the depth of {basis.count} images, components: {said}")


def run(arguments: Sequence[str]) -> int:
    """Write the figure that `arguments` name."""
    with told_in_one_line("flexdepth figure"):
        chosen = tyro.extras.subcommand_cli_from_dict(
            {
                "attention": AttentionFigure,
                "edges": EdgesFigure,
                "emphasis": EmphasisFigure,
                "pca": PCAFigure,
            },
            args=arguments,
            prog="flexdepth figure",
        )
    chosen.write()
    return 0


def _checked(photos: tuple[Path, ...], folder: Path) -> tuple[Path, ...]:
    if not photos:
        raise InputError("name at least one photo: flexdepth figure attention PHOTO")
    check_writable(folder)
    return photos


def _write(path: Path, pixels: Pixels) -> None:
    with replacing(path) as temporary:
        Image.fromarray(np.asarray(pixels)).save(temporary)
    _say(str(path))


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()
