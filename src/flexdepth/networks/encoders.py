"""Encoders of timm, by name: their feature maps, strides and the input's normalisation."""

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from types import MappingProxyType
from typing import Any

import timm
import torch
from jaxtyping import Float
from timm.layers.conv2d_same import Conv2dSame
from timm.layers.format import Format
from timm.models import is_model_in_modules
from torch import Tensor, nn
from torch.nn.functional import conv2d, pad

from flexdepth.runtime.errors import InputError

_NORMALISATION: Mapping[str, tuple[tuple[float, ...], tuple[float, ...]]] = MappingProxyType(
    {f"tf_efficientnet_lite{n}": ((127 / 255,) * 3, (128 / 255,) * 3) for n in range(5)}
)
"""Mean and deviation of red, green, blue in [0, 1], where timm's differ from the training's.

The lite networks were trained on `(x - 127) / 128` of bytes; timm rounds this to `2 x - 1`.
"""

_ANY_SIZE: tuple[tuple[tuple[str, ...], Mapping[str, Any]], ...] = (
    (
        ("beit", "deit", "eva", "vision_transformer"),
        MappingProxyType({"dynamic_img_size": True, "dynamic_img_pad": True}),
    ),
    (
        ("swin_transformer", "swin_transformer_v2"),
        MappingProxyType({"strict_img_size": False}),
    ),
)
"""What lets the transformers in these modules of timm take images of other sizes."""

_WHOLE_STRIDE = 32
"""At which timm's networks end where nothing is asked of them."""


@dataclass(frozen=True)
class Encoder:
    """A trunk of timm.

    Attributes:
        name: As timm spells it.
        output_stride: Image pixels per step of the coarsest map. Below 32, convolutions dilate by
            the stride that they give up.
    """

    name: str = "tf_efficientnet_lite0"
    output_stride: int = _WHOLE_STRIDE

    def build(self, maps: int = 5) -> "FeatureEncoder":
        """Return the trunk with random weights.

        Args:
            maps: How many of its feature maps are wanted, the coarsest ones.

        Raises:
            InputError: If timm has no such network, or has it without so many feature maps or
                without this stride.
        """
        if not timm.is_model(self.name):
            near = get_close_matches(self.name.partition(".")[0], timm.list_models(), n=1)
            hint = f"did you mean {near[0]!r}?" if near else "see timm.list_models()"
            raise InputError(f"no encoder {self.name!r} in timm {timm.__version__}; {hint}")
        return FeatureEncoder(self, maps)


class FeatureEncoder(nn.Module):
    """The module of `Encoder`.

    Attributes:
        settings: What it was built from.
        widths: Channels of each feature map.
        strides: Image pixels per step of each feature map.
    """

    mean: Tensor
    deviation: Tensor

    def __init__(self, settings: Encoder, maps: int) -> None:
        super().__init__()
        self.settings = settings
        self.trunk = _trunk(settings, maps)
        published: Any = self.trunk.feature_info
        self.widths: tuple[int, ...] = tuple(published.channels())
        self.strides: tuple[int, ...] = tuple(published.reduction())
        self.channels_last = getattr(self.trunk, "output_fmt", None) == Format.NHWC
        _pad_by_constants(self.trunk)
        mean, deviation = _normalisation(settings.name)
        self.register_buffer("mean", mean, persistent=False)
        self.register_buffer("deviation", deviation, persistent=False)

    def forward(
        self, image: Float[Tensor, "batch 3 height width"]
    ) -> list[Float[Tensor, "batch _ _ _"]]:
        """Return the feature maps, finest first.

        Args:
            image: RGB in [0, 1].
        """
        features: list[Tensor] = self.trunk((image - self.mean) / self.deviation)
        return [x.movedim(-1, 1) for x in features] if self.channels_last else features


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


def _trunk(settings: Encoder, maps: int) -> nn.Module:
    if settings.output_stride == _WHOLE_STRIDE:
        return _timm_trunk(settings, maps, {})
    trunk = _timm_trunk(settings, maps, {"output_stride": settings.output_stride})
    with torch.device("meta"):
        strided = dict(_timm_trunk(settings, maps, {}).named_modules())
    for name, conv in trunk.named_modules():
        if isinstance(conv, nn.Conv2d):
            _dilate_by_what_is_lost(conv, strided[name])
    return trunk


def _timm_trunk(settings: Encoder, maps: int, asked: Mapping[str, Any]) -> nn.Module:
    wanted = tuple(range(-maps, 0))
    for modules, options in _ANY_SIZE:
        if is_model_in_modules(settings.name, modules):
            asked = {**options, **asked}
    try:
        return timm.create_model(
            settings.name, pretrained=False, features_only=True, out_indices=wanted, **asked
        )
    except (TypeError, ValueError, AssertionError, LookupError, RuntimeError) as error:
        raise InputError(
            f"encoder {settings.name!r} of timm {timm.__version__} does not give {maps} feature "
            f"maps with an output stride of {settings.output_stride}: choose another encoder, or "
            f"the stride 32 ({error})"
        ) from error


def _dilate_by_what_is_lost(conv: nn.Conv2d, strided: nn.Conv2d) -> None:
    """Let a convolution of odd size that has given up its stride see as far as before.

    timm dilates only what comes after it.
    """
    lost = strided.stride[0] // conv.stride[0]
    size = conv.kernel_size[0]
    if lost > 1 and size > 1 and size % 2:
        reach = conv.dilation[0] * lost
        conv.dilation = (reach, reach)
        conv.padding = (reach * (size // 2),) * 2


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
