"""Depth from ordinary colour pictures: offline, in metres where metres can be known.

>>> import flexdepth
>>> depth_map = flexdepth.predict("photo.jpg")
>>> depth_map.depth, depth_map.space

Importing this takes no time and loads nothing: each name brings what it needs, never torch.
"""

from functools import cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
    from flexdepth.runtime.errors import InputError
    from flexdepth.runtime.files import read_depth, write_depth
    from flexdepth.runtime.images import Photo
    from flexdepth.runtime.lens import FieldOfView, FocalLength, Lens
    from flexdepth.runtime.model import Model
    from flexdepth.runtime.predictor import Predictor

__all__ = [
    "DepthMap",
    "FieldOfView",
    "FocalLength",
    "FocalSource",
    "InputError",
    "Intrinsics",
    "Photo",
    "Predictor",
    "Space",
    "load",
    "predict",
    "read_depth",
    "write_depth",
]

_BUNDLED = "compact"

_HOMES = MappingProxyType(
    {
        "DepthMap": "depthmap",
        "FieldOfView": "lens",
        "FocalLength": "lens",
        "FocalSource": "depthmap",
        "InputError": "errors",
        "Intrinsics": "depthmap",
        "Photo": "images",
        "Predictor": "predictor",
        "Space": "depthmap",
        "read_depth": "files",
        "write_depth": "files",
    }
)


def __getattr__(name: str) -> object:
    """Return a public name from the module that owns it, which is imported only now."""
    if name not in _HOMES:
        raise AttributeError(f"module 'flexdepth' has no attribute {name!r}")
    return getattr(import_module(f"flexdepth.runtime.{_HOMES[name]}"), name)


def predict(picture: "Photo | str | Path | ArrayLike", lens: "Lens | None" = None) -> "DepthMap":
    """Return the depth of one picture, at its own size, from the model that comes with flexdepth.

    Depth is z in front of the camera, +inf in the sky. It is in metres (`space` is `metric`)
    where `lens` is given or the photo says its focal length, else right up to one factor. The
    model is loaded once.

    Args:
        picture: A file, or an array of uint8: height x width x 3 in RGB, or height x width in
            gray.
        lens: `FocalLength(pixels)` or `FieldOfView(degrees)` of the camera, if it is known.

    Raises:
        InputError: The file or the array is no picture.
    """
    return load(lens=lens).predict(picture)


def load(bundle: str | Path = _BUNDLED, lens: "Lens | None" = None) -> "Predictor":
    """Return a model that is ready to predict.

    Args:
        bundle: "compact", the model that comes with flexdepth, or an .onnx bundle.
        lens: As for `predict`, for all pictures.

    Raises:
        InputError: There is no such bundle, or it is none.
    """
    from flexdepth.runtime.model import load_model  # noqa: PLC0415 - see the top
    from flexdepth.runtime.predictor import Predictor  # noqa: PLC0415

    return Predictor(_bundled() if bundle == _BUNDLED else load_model(Path(bundle)), lens)


@cache
def _bundled() -> "Model":
    from flexdepth.runtime.model import load_model  # noqa: PLC0415

    return load_model()
