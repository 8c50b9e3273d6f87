"""Blocks that more than one network uses."""

from dataclasses import dataclass
from typing import Literal, cast

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import interpolate

from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class BatchNorm:
    """Batch normalisation over an image's pixels.

    Attributes:
        momentum: The share of the newest batch in the running statistics, as PyTorch counts it.
        eps: Added to the variance.
    """

    momentum: float = 0.1
    eps: float = 1e-5

    def build(self, channels: int) -> nn.BatchNorm2d:
        """Return the layer for `channels` channels."""
        return nn.BatchNorm2d(channels, eps=self.eps, momentum=self.momentum)


@dataclass(frozen=True)
class DilatedResidual:
    """The dilated residual block (DRB).

    A 1x1 convolution to the new width; to its output is added what a 3x3 convolution, batch
    normalisation, ReLU and a second 3x3 convolution make of it; ReLU follows. Only the first 3x3
    convolution has a bias.

    Attributes:
        dilation: Of both 3x3 convolutions; 2 in the published networks.
        norm: The normalisation between them.
        padding: What the 3x3 convolutions see beyond the image: zeros as published, or its last
            pixels again (`replicate`), which leaves no frame around the depth map.
    """

    dilation: int = 2
    norm: BatchNorm = BatchNorm(momentum=0.5)
    padding: Literal["zeros", "replicate"] = "zeros"

    def build(self, inputs: int, width: int) -> "DilatedResidualBlock":
        """Return the block that takes `inputs` channels to `width` channels."""
        return DilatedResidualBlock(self, inputs, width)


class DilatedResidualBlock(nn.Module):
    """The module of `DilatedResidual`."""

    def __init__(self, settings: DilatedResidual, inputs: int, width: int) -> None:
        super().__init__()
        self.project = nn.Conv2d(inputs, width, 1, bias=False)
        self.refine = refinement(settings, width, width)

    def forward(
        self, features: Float[Tensor, "batch inputs height width"]
    ) -> Float[Tensor, "batch outputs height width"]:
        """Return the refined features, none of them negative, at the size they came in."""
        residual = self.project(features)
        out: Tensor = (residual + self.refine(residual)).relu()
        return out


def refinement(settings: DilatedResidual, width: int, inner: int, stride: int = 1) -> nn.Sequential:
    """Return what the block adds to its residual: two 3x3 convolutions and what is between them.

    Args:
        settings: Of the block.
        width: Channels that come in and go out.
        inner: Channels between the convolutions; the block's own are `width`.
        stride: Of the first convolution. Sizes are divided by it, and rounded up.
    """
    reach, beyond = settings.dilation, settings.padding
    return nn.Sequential(
        nn.Conv2d(width, inner, 3, stride, reach, reach, padding_mode=beyond),
        settings.norm.build(inner),
        nn.ReLU(),
        nn.Conv2d(inner, width, 3, 1, reach, reach, bias=False, padding_mode=beyond),
    )


@dataclass(frozen=True)
class Pyramid:
    """Atrous spatial pyramid pooling (ASPP): how the features look at several scales.

    One 1x1 convolution, a dilated 3x3 convolution for each of `dilations`, and the mean of the
    whole map through a 1x1 convolution; batch normalisation after each, no activation anywhere.

    Attributes:
        width: Channels of each branch.
        dilations: Of the 3x3 convolutions.
        norm: The normalisation of each branch.
    """

    width: int = 512
    dilations: tuple[int, ...] = (2, 4, 6)
    norm: BatchNorm = BatchNorm(momentum=0.5)

    def build(self, inputs: int) -> "PyramidPooling":
        """Return the block on features of `inputs` channels."""
        return PyramidPooling(self, inputs)


class PyramidPooling(nn.Module):
    """The module of `Pyramid`.

    Attributes:
        width: Channels of its output: all branches together.
    """

    def __init__(self, settings: Pyramid, inputs: int) -> None:
        super().__init__()
        width = settings.width
        self.width = width * (2 + len(settings.dilations))
        self.point = projection(inputs, width, settings.norm)
        self.scales = nn.ModuleList(
            nn.Sequential(
                nn.Conv2d(inputs, width, 3, padding=reach, dilation=reach, bias=False),
                settings.norm.build(width),
            )
            for reach in settings.dilations
        )
        self.whole = projection(inputs, width, settings.norm)

    def forward(
        self, features: Float[Tensor, "batch inputs height width"]
    ) -> Float[Tensor, "batch outputs height width"]:
        """Return the branches, one after the other, at the size that came in.

        Raises:
            InputError: In training, with one image: its mean cannot be normalised by itself.
        """
        if self.training and features.shape[0] == 1:
            raise InputError(
                "the pyramid normalises the mean of each image over the batch; training needs at "
                "least 2 images in it on every device, got 1"
            )
        whole = self.whole(features.mean((-2, -1), keepdim=True))
        branches = [self.point(features), *(scale(features) for scale in self.scales)]
        return torch.cat([*branches, whole.expand_as(branches[0])], 1)


def resized(
    features: Float[Tensor, "batch channels _ _"],
    rows: int | torch.SymInt,
    columns: int | torch.SymInt,
) -> Float[Tensor, "batch channels rows columns"]:
    """Return the features at another size, bilinear, with corners on corners.

    This is the resize of the published decoders: the middles of the corner pixels stay where they
    are, and the same size comes out as it went in.
    """
    # torch annotates the size as int, and takes the symbols of torch.export as well.
    size = cast(tuple[int, int], (rows, columns))
    return interpolate(features, size, mode="bilinear", align_corners=True)


def projection(inputs: int, width: int, norm: BatchNorm) -> nn.Sequential:
    """Return a 1x1 convolution without bias, then batch normalisation."""
    return nn.Sequential(nn.Conv2d(inputs, width, 1, bias=False), norm.build(width))


def start_as_xavier(module: nn.Module) -> None:
    """Draw the weights of every convolution in `module` as Xavier's normal, with zero bias.

    References:
        Glorot and Bengio, AISTATS 2010, eq. 16, in its normal form.
    """
    for part in module.modules():
        if isinstance(part, nn.Conv2d):
            nn.init.xavier_normal_(part.weight)
            if part.bias is not None:
                nn.init.zeros_(part.bias)
