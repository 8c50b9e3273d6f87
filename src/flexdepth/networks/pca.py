"""Depth as a mean map and a few principal components, filtered at the size of the image.

Section 3.5.1 of the dissertation, which found it worse than the AGA network (an AbsRel of 12 %
against 9.7 %) for want of data, and says no more of the networks than the steps that are here.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from math import log

import torch
from jaxtyping import Float
from torch import Tensor, nn

from flexdepth.geometry.depth import canonical_from_metres
from flexdepth.networks.blocks import (
    BatchNorm,
    DilatedResidual,
    projection,
    resized,
    start_as_xavier,
)
from flexdepth.networks.depth_basis import SCALES, Basis, DepthBasis
from flexdepth.networks.encoders import Encoder
from flexdepth.sample import Prediction, Sample, measured


@dataclass(frozen=True)
class Filter:
    """What makes a depth map better at the size of the image, with a look at it.

    Attributes:
        width: Channels.
        dilations: Of its dilated residual blocks, one after the other.
    """

    width: int = 32
    dilations: tuple[int, ...] = (1, 2, 4)

    def build(self) -> "FilterNetwork":
        """Return the module; with its first weights it changes nothing."""
        return FilterNetwork(self)


class FilterNetwork(nn.Module):
    """The module of `Filter`."""

    def __init__(self, settings: Filter) -> None:
        super().__init__()
        blocks = [DilatedResidual(d, BatchNorm(), "replicate") for d in settings.dilations]
        inputs = [4, *(settings.width for _ in blocks)]
        built = map(DilatedResidual.build, blocks, inputs, inputs[1:])
        self.blocks = nn.Sequential(*built)
        start_as_xavier(self)
        self.last = nn.Conv2d(inputs[-1], 1, 1)
        nn.init.zeros_(self.last.weight)
        nn.init.zeros_(self.last.bias)  # type: ignore[arg-type]

    def forward(
        self,
        image: Float[Tensor, "batch 3 height width"],
        depth: Float[Tensor, "batch height width"],
    ) -> Float[Tensor, "batch height width"]:
        """Return the logarithm of the filtered depth."""
        log_depth = depth.log()
        change: Tensor = self.last(self.blocks(torch.cat([image, log_depth[:, None]], 1)))
        return log_depth + change[:, 0]


@dataclass(frozen=True)
class PCA:
    """Depth of one image from the coefficients of principal components.

    An encoder predicts the coefficients, the components and the mean make a small map of them,
    which is brought to the size of the image and filtered there.

    Attributes:
        encoder: Its coarsest map is seen.
        basis: How the components are made.
        width: Channels to which the encoder's map is brought.
        grid: Rows and columns to which it is resized; the coefficients are about the whole image,
            whatever its size.
        hidden: Numbers between the grid and the coefficients.
        filter: What works at the size of the image.
        canonical_focal: As in `Prediction`; None, as published, for depth that does not depend on
            the camera.
    """

    encoder: Encoder = field(default_factory=Encoder)
    basis: Basis = field(default_factory=Basis)
    width: int = 64
    grid: tuple[int, int] = (6, 8)
    hidden: int = 512
    filter: Filter = field(default_factory=Filter)
    canonical_focal: float | None = None

    def build(self) -> "PCANetwork":
        """Return the network with random weights and no basis.

        Its depth is undefined until `PCANetwork.adopt` gives it one.

        Raises:
            InputError: If timm cannot give the encoder.
        """
        return PCANetwork(self)

    def fit(self, samples: Iterable[Sample]) -> DepthBasis:
        """Return the basis of the depth maps of any data, in one pass.

        Args:
            samples: Each one image with its truth. Sky is as far as the basis goes.

        Raises:
            InputError: There are fewer than two maps to learn from.
        """
        return self.basis.fit(self._maps(samples))

    def _maps(self, samples: Iterable[Sample]) -> Iterator[tuple[Tensor, Tensor]]:
        for sample in samples:
            truth = measured(sample, "PCA")
            depth = truth.depth
            if self.canonical_focal is not None:
                focal = sample.key.focal_by_area()
                depth = canonical_from_metres(depth, focal, self.canonical_focal)
            valid = truth.valid & (depth > 0) & depth.isfinite()
            yield depth.where(valid, self.basis.farthest), valid | truth.sky


class PCANetwork(nn.Module):
    """The module of `PCA`; the basis is among its weights, but is not learnt."""

    mean: Tensor
    components: Tensor
    deviations: Tensor

    def __init__(self, settings: PCA) -> None:
        super().__init__()
        self.settings = settings
        basis, grid = settings.basis, settings.grid
        self.scale, self.ends = SCALES[basis.scale], basis.ends()
        self.encoder = settings.encoder.build(maps=1)
        self.narrow = projection(self.encoder.widths[-1], settings.width, BatchNorm())
        self.predict = nn.Sequential(
            nn.Linear(settings.width * grid[0] * grid[1], settings.hidden),
            nn.ReLU(),
            nn.Linear(settings.hidden, basis.components),
        )
        start_as_xavier(self.narrow)
        self.filter = settings.filter.build()
        size = (basis.rows, basis.columns)
        # Undefined, so that a network that was given no basis stops the training.
        self.register_buffer("mean", torch.full(size, torch.nan))
        self.register_buffer("components", torch.full((basis.components, *size), torch.nan))
        self.register_buffer("deviations", torch.full((basis.components,), torch.nan))

    def adopt(self, basis: DepthBasis) -> None:
        """Take a basis, of the settings' size."""
        self.mean.copy_(basis.mean)
        self.components.copy_(basis.components)
        self.deviations.copy_(basis.variances[: len(basis.components)].sqrt())

    def coefficients(
        self, image: Float[Tensor, "batch 3 height width"]
    ) -> Float[Tensor, "batch components"]:
        """Return the coefficients of the components; the last layer counts in deviations."""
        (features,) = self.encoder(image)
        seen = resized(self.narrow(features).relu(), *self.settings.grid)
        out: Tensor = self.predict(seen.flatten(1)) * self.deviations
        return out

    def coarse(
        self, coefficients: Float[Tensor, "batch components"]
    ) -> Float[Tensor, "batch rows columns"]:
        """Return the depth that these coefficients mean, at the size of the basis."""
        summed = self.mean + torch.einsum("bk,krc->brc", coefficients, self.components)
        return self.scale.depth_of(summed.clamp(*self.ends))

    def forward(self, image: Float[Tensor, "batch 3 height width"]) -> Prediction:
        """Return depth in metres.

        Args:
            image: RGB in [0, 1], of any size that the encoder takes.
        """
        small = self.coarse(self.coefficients(image))
        depth = resized(small[:, None], *image.shape[-2:])[:, 0]
        basis = self.settings.basis
        filtered = self.filter(image, depth).clamp(log(basis.nearest), log(basis.farthest))
        return Prediction(filtered.exp(), self.settings.canonical_focal)
