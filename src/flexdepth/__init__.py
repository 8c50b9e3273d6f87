"""Depth from ordinary colour pictures: offline, in metres where metres can be known.

>>> import flexdepth
>>> depth_map = flexdepth.predict("photo.jpg")
>>> depth_map.depth, depth_map.space

Importing this takes no time and loads nothing: each name brings what it needs, never torch.
"""

import warnings
from functools import cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
    from flexdepth.runtime.errors import InputError
    from flexdepth.runtime.estimator import Estimator
    from flexdepth.runtime.files import read_depth, write_depth
    from flexdepth.runtime.images import Photo
    from flexdepth.runtime.lens import FieldOfView, FocalLength, Lens
    from flexdepth.runtime.model import Model
    from flexdepth.runtime.predictor import Predictor

__all__ = [
    "DepthMap",
    "Estimator",
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
        "Estimator": "estimator",
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


def load(model: str | Path = _BUNDLED, lens: "Lens | None" = None) -> "Estimator":
    """Return a model that is ready to predict.

    Args:
        model: "compact", the model that comes with flexdepth; an .onnx bundle; any .onnx network
            with a .yaml card beside it, or the card; or "hub:NAME", such as
            "hub:depth-anything/Depth-Anything-V2-Small-hf", which needs the extra `hub`.
        lens: As for `predict`, for all pictures.

    Raises:
        InputError: There is no such model, or it is broken.

    Warns:
        UserWarning: The licence of its weights forbids commercial use.
    """
    if model == _BUNDLED:
        from flexdepth.runtime.predictor import Predictor  # noqa: PLC0415 - see the top

        return Predictor(_bundled(), lens)

    from flexdepth.runtime.licences import remark  # noqa: PLC0415
    from flexdepth.runtime.named import Wishes, named_estimator  # noqa: PLC0415

    found = named_estimator(model, Wishes(lens))
    if (said := remark(found.about)) is not None:
        warnings.warn(said, stacklevel=2)
    return found


@cache
def _bundled() -> "Model":
    from flexdepth.runtime.model import load_model  # noqa: PLC0415

    return load_model()
