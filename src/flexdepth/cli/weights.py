"""What a user names as weights: `bundled`, `imagenet`, a bundle or a checkpoint."""

from pathlib import Path

from flexdepth.experiments.experiment import Bundled, ImageNet, Start, Trained
from flexdepth.runtime.errors import InputError


def start_of(weights: str, option: str) -> Start:
    """Return where the named weights come from.

    Args:
        weights: `bundled`, `imagenet`, a .onnx or a .safetensors file.
        option: The option that took them, for the message.

    Raises:
        InputError: They are none of these.
    """
    match weights, Path(weights).suffix:
        case "bundled", _:
            return Bundled()
        case "imagenet", _:
            return ImageNet()
        case _, ".onnx":
            return Bundled(Path(weights))
        case _, ".safetensors":
            return Trained(Path(weights))
    raise InputError(
        f"{option}: wanted bundled, imagenet, a .onnx bundle or a .safetensors checkpoint, "
        f"got {weights!r}"
    )
