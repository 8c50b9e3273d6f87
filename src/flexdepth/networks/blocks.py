"""Blocks that more than one network uses."""

from dataclasses import dataclass

from jaxtyping import Float
from torch import Tensor, nn


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
    """

    dilation: int = 2
    norm: BatchNorm = BatchNorm(momentum=0.5)

    def build(self, inputs: int, width: int) -> "DilatedResidualBlock":
        """Return the block that takes `inputs` channels to `width` channels."""
        return DilatedResidualBlock(self, inputs, width)


class DilatedResidualBlock(nn.Module):
    """The module of `DilatedResidual`."""

    def __init__(self, settings: DilatedResidual, inputs: int, width: int) -> None:
        super().__init__()
        reach = settings.dilation
        self.project = nn.Conv2d(inputs, width, 1, bias=False)
        self.refine = nn.Sequential(
            nn.Conv2d(width, width, 3, padding=reach, dilation=reach),
            settings.norm.build(width),
            nn.ReLU(),
            nn.Conv2d(width, width, 3, padding=reach, dilation=reach, bias=False),
        )

    def forward(
        self, features: Float[Tensor, "batch inputs height width"]
    ) -> Float[Tensor, "batch outputs height width"]:
        """Return the refined features, none of them negative, at the size they came in."""
        residual = self.project(features)
        out: Tensor = (residual + self.refine(residual)).relu()
        return out


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
