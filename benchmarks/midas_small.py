"""The architecture of MiDaS v2.1 small with random weights: what speed is compared with.

    python benchmarks/midas_small.py OUT.onnx

Built from its description, not from its code: EfficientNet-Lite3 at strides 4, 8, 16 and 32; a
3 x 3 convolution of each map to 64, 128, 256 and 512 channels; RefineNet's fusion blocks, each of
which doubles the size and halves the channels; a head of three convolutions. Time does not depend
on the weights, so nothing is downloaded, and no depth comes out.

At 256 x 256 it has 4.60 GMAC and 16.60 million parameters. The published figures are 4.6 GMAC
and 21 million; the difference fits a residual unit of the coarsest block, 4.7 million, through
which nothing flows and which is left out here. The description of the published LiteRT conversion
has the same layers, 73 convolutions, 24 depthwise convolutions and 5 upsamplings, and 33 MB in
half precision. What the description leaves open, and time hardly depends on: which convolutions
have a bias, and how the head's upsampling treats corners.

References:
    Ranftl, Lasinger, Hafner, Schindler and Koltun, PAMI 2022, and its release 2.1 (small).
    Lin, Milan, Shen and Reid, CVPR 2017: RefineNet's residual units and fusion.
"""

import sys
from pathlib import Path

import timm
import torch
from torch import Tensor, nn
from torch.nn.functional import interpolate

ENCODER = "tf_efficientnet_lite3"
WIDTHS = (64, 128, 256, 512)
"""Channels at strides 4, 8, 16 and 32."""

SIDE = 256
"""Pixels of the square picture that it was trained on and is timed at."""


def convolution(inward: int, outward: int, size: int = 3, bias: bool = True) -> nn.Conv2d:
    """Return a convolution that keeps the size of the map."""
    return nn.Conv2d(inward, outward, size, padding=size // 2, bias=bias)


def doubled(x: Tensor, corners: bool) -> Tensor:
    """Return the map at twice its size."""
    return interpolate(x, scale_factor=2.0, mode="bilinear", align_corners=corners)


class ResidualUnit(nn.Module):
    """Two convolutions with a ReLU before each, around them the identity."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.branch = nn.Sequential(
            nn.ReLU(),
            convolution(channels, channels),
            nn.ReLU(),
            convolution(channels, channels),
        )

    def forward(self, x: Tensor) -> Tensor:
        """Return the map, refined, at its own size."""
        return x + self.branch(x)


class Fusion(nn.Module):
    """Take in the encoder's map, refine, double the size, change the channels."""

    def __init__(self, inward: int, outward: int) -> None:
        super().__init__()
        self.skip = ResidualUnit(inward)
        self.refine = ResidualUnit(inward)
        self.out = convolution(inward, outward, size=1)

    def forward(self, x: Tensor, encoded: Tensor) -> Tensor:
        """Return the next finer map."""
        return self.out(doubled(self.refine(x + self.skip(encoded)), corners=True))


class Coarsest(nn.Module):
    """The first fusion: there is nothing to take in."""

    def __init__(self, inward: int, outward: int) -> None:
        super().__init__()
        self.refine = ResidualUnit(inward)
        self.out = convolution(inward, outward, size=1)

    def forward(self, x: Tensor) -> Tensor:
        """Return the next finer map."""
        return self.out(doubled(self.refine(x), corners=True))


class MidasSmall(nn.Module):
    """Return (batch, height, width), which trained weights would make disparity."""

    def __init__(self) -> None:
        super().__init__()
        self.encoder = timm.create_model(ENCODER, features_only=True, out_indices=(1, 2, 3, 4))
        encoded = self.encoder.feature_info.channels()
        self.scratch = nn.ModuleList(
            convolution(*channels, bias=False) for channels in zip(encoded, WIDTHS, strict=True)
        )
        first, second, third, fourth = WIDTHS
        self.coarsest = Coarsest(fourth, third)
        self.fusions = nn.ModuleList(
            [Fusion(third, second), Fusion(second, first), Fusion(first, first)]
        )
        self.reduce = convolution(first, first // 2)
        self.head = nn.Sequential(
            convolution(first // 2, 32), nn.ReLU(), convolution(32, 1, size=1), nn.ReLU()
        )

    def forward(self, image: Tensor) -> Tensor:
        """Return the disparity of RGB pictures, at their own size, 0 at the least."""
        maps = [layer(x) for layer, x in zip(self.scratch, self.encoder(image), strict=True)]
        x = self.coarsest(maps.pop())
        for fusion in self.fusions:
            x = fusion(x, maps.pop())
        return self.head(doubled(self.reduce(x), corners=False)).squeeze(1)


def write(path: Path) -> None:
    """Write the network as ONNX, for one picture of 256 x 256."""
    torch.manual_seed(0)
    torch.onnx.export(
        MidasSmall().eval(),
        (torch.zeros(1, 3, SIDE, SIDE),),
        path,
        input_names=["image"],
        output_names=["disparity"],
        dynamo=True,
        external_data=False,
        verbose=False,
    )


if __name__ == "__main__":
    write(Path(sys.argv[1]))
