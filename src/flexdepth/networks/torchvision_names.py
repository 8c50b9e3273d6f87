"""torchvision's names of weights, in timm's words, for networks that are the same in both.

Of ResNet, ResNeXt, Wide ResNet and DenseNet the names agree already. VGG's differ in the
classifier, those of MobileNetV2 and EfficientNet throughout. Families of which torchvision's
weights would give other features in timm's network are left out: MobileNetV3 and EfficientNet B5
to B7, whose normalisation adds .001 to the variance there and .00001 here.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType

_MOBILENET_BLOCKS = (1, 2, 3, 4, 3, 3, 1)
"""Blocks in each stage: torchvision numbers them throughout, timm within a stage."""

_SEPARABLE = (("conv_dw", "bn1"), ("conv_pw", "bn2"))
_INVERTED = (("conv_pw", "bn1"), ("conv_dw", "bn2"), ("conv_pwl", "bn3"))
"""Convolution and normalisation of each layer of a block, without and with an expansion."""

_SQUEEZED = MappingProxyType({"fc1": "conv_reduce", "fc2": "conv_expand"})
_ENDS = (("conv_stem", "bn1"), ("conv_head", "bn2"))
_VGG = MappingProxyType(
    {"classifier.0": "pre_logits.fc1", "classifier.3": "pre_logits.fc2", "classifier.6": "head.fc"}
)


def timm_names(encoder: str, names: Iterable[str]) -> dict[str, str]:
    """Return timm's name for each of torchvision's; names that are timm's already stay.

    Args:
        encoder: The network, as timm calls it.
        names: Of all weights in a file; `module.`, which parallel training puts before all of
            them, is taken off.
    """
    every = list(names)
    shorn = [each.removeprefix("module.") for each in every]
    rename = next((of for kind, of in _FAMILIES.items() if re.fullmatch(kind, encoder)), None)
    if rename is None or not any(each.startswith("features.") for each in shorn):
        return dict(zip(every, shorn, strict=True))
    return {own: rename(each, frozenset(shorn)) for own, each in zip(every, shorn, strict=True)}


def _of_vgg(name: str, _names: frozenset[str]) -> str:
    part, _, leaf = name.rpartition(".")
    return f"{_VGG.get(part, part)}.{leaf}"


def _of_mobilenet(name: str, _names: frozenset[str]) -> str:
    match name.split("."):
        case ["features", number, "conv", *rest]:
            stage, block = 0, int(number) - 1
            while block >= _MOBILENET_BLOCKS[stage]:
                block -= _MOBILENET_BLOCKS[stage]
                stage += 1
            layers = _SEPARABLE if stage == 0 else _INVERTED
            return f"blocks.{stage}.{block}.{_in_mobilenet_block(rest, layers)}"
    return _at_the_ends(name)


def _in_mobilenet_block(rest: list[str], layers: tuple[tuple[str, str], ...]) -> str:
    """Return the name in a block, whose last convolution and normalisation are not nested."""
    last = len(layers) - 1
    layer, *within = map(int, rest[:-1])
    which, part = (layer, within[0]) if within else (last, layer - last)
    return f"{layers[which][part]}.{rest[-1]}"


def _of_efficientnet(name: str, names: frozenset[str]) -> str:
    match name.split("."):
        case ["features", stage, block, "block", layer, part, leaf]:
            head = f"blocks.{int(stage) - 1}.{block}"
            if part in _SQUEEZED:
                return f"{head}.se.{_SQUEEZED[part]}.{leaf}"
            place = f"features.{stage}.{block}.block"
            convolutions = [n for n in range(4) if f"{place}.{n}.0.weight" in names]
            layers = _SEPARABLE if len(convolutions) == len(_SEPARABLE) else _INVERTED
            return f"{head}.{layers[convolutions.index(int(layer))][int(part)]}.{leaf}"
    return _at_the_ends(name)


def _at_the_ends(name: str) -> str:
    """Return the name of a weight of the first convolution, the last one or the classifier."""
    match name.split("."):
        case ["features", number, part, leaf]:
            return f"{_ENDS[number != '0'][int(part)]}.{leaf}"
        case ["classifier", _, leaf]:
            return f"classifier.{leaf}"
    return name


_FAMILIES: Mapping[str, Callable[[str, frozenset[str]], str]] = MappingProxyType(
    {
        r"vgg\d\d(_bn)?": _of_vgg,
        r"mobilenetv2_100": _of_mobilenet,
        r"efficientnet_b[0-4]": _of_efficientnet,
    }
)
