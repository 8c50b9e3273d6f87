"""Curves of chapter 3: what emphasis does to attention (3.6), what components explain (3.5.1)."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter

from flexdepth.networks.depth_basis import SCALES, Basis, DepthBasis
from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.colour import palette

_BLUE, _RED, _GREY = "#3465a4", "#cc2222", "#888888"
_SHARES = (0.8, 0.9, 0.95, 0.99)
_SHOWN = 8
"""Components of which pictures are shown."""


def write_emphasis(path: Path) -> None:
    """Write x and x exp(x) for a similarity x from 0 to 1, as a picture.

    References:
        Fig. 3.6 of the dissertation.
    """
    figure = Figure(figsize=(5, 3.6), layout="constrained")
    axes = figure.subplots()
    x = np.linspace(0, 1, 201)
    axes.plot(x, x * np.exp(x), color=_RED, label="x exp(x): the emphasised similarity, to e")
    axes.plot(x, x, color=_BLUE, label="x: the similarity itself")
    axes.set(
        xlabel="similarity x of encoder and decoder", ylabel="weight", xlim=(0, 1), ylim=(0, 3)
    )
    axes.axhline(np.e, color=_GREY, linewidth=0.6, linestyle=":")
    axes.legend(frameon=False, loc="upper left")
    _save(figure, path)


def enough(basis: DepthBasis, share: float) -> int | None:
    """Return how many components explain at least a share of the variance; None where none do."""
    reached = (basis.explained() >= share).nonzero()
    return int(reached[0]) + 1 if len(reached) else None


def write_explained(path: Path, basis: DepthBasis, settings: Basis) -> None:
    """Write how much of the variance of depth the first components explain, and what they are.

    Args:
        path: The picture, of any format of matplotlib's.
        basis: Of the depth maps of a data set.
        settings: What it was made with.

    References:
        Section 3.5.1 of the dissertation, which keeps "the most important" ones.
    """
    figure = Figure(figsize=(8, 4.8), layout="constrained")
    grid = figure.add_gridspec(2, _SHOWN + 1, height_ratios=(4, 1))
    axes = figure.add_subplot(grid[0, :])
    explained = basis.explained().numpy()
    axes.plot(np.arange(1, len(explained) + 1), explained, color=_BLUE, marker=".", markersize=4)
    for share in _SHARES:
        count = enough(basis, share)
        if count is not None:
            axes.plot([1, count, count], [share, share, explained[0] * 0.9], ":", color=_GREY)
            axes.annotate(
                f"{count}: {share:.0%}", (count, share), (3, -11), textcoords="offset points"
            )
    what = "the logarithm of depth" if settings.scale == "log" else "depth"
    axes.set(
        xscale="log",
        xlim=(0.95, 1.2 * len(explained)),
        ylim=(explained[0] * 0.9, 1.005),
        xlabel="principal components",
        ylabel="share of the variance",
        title=f"{what[0].upper()}{what[1:]} of {basis.count} images, "
        f"{settings.columns}x{settings.rows}",
    )
    axes.xaxis.set_major_formatter(ScalarFormatter())
    _maps([figure.add_subplot(grid[1, n]) for n in range(_SHOWN + 1)], basis, settings)
    _save(figure, path)


def _maps(axes: Sequence[Axes], basis: DepthBasis, settings: Basis) -> None:
    """Draw the mean map, and the first components with red and blue for the two signs."""
    mean = SCALES[settings.scale].depth_of(basis.mean).numpy()
    order = np.argsort(np.argsort(-mean.ravel())).reshape(mean.shape) / max(mean.size - 1, 1)
    axes[0].imshow(palette()[np.round(255 * order).astype(np.uint8)])
    axes[0].set_title("mean", fontsize=9)
    for number, axis in enumerate(axes[1:]):
        if number < len(basis.components):
            component = basis.components[number].numpy()
            largest = float(np.abs(component).max())
            axis.imshow(component, cmap="RdBu", vmin=-largest, vmax=largest)
            axis.set_title(f"{number + 1}", fontsize=9)
    for axis in axes:
        axis.axis("off")


def _save(figure: Figure, path: Path) -> None:
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=150)
