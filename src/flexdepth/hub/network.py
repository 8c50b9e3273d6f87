"""A model of transformers, shown pictures as its own library shows them.

What it gives is what the library's post-processing makes of it, at the picture's size, in single
precision, and never the eight-bit picture that pipelines draw. Only safetensors are read and no
code of a model's is run: a file with pickled weights, or a model that brings its own Python, is
refused.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from huggingface_hub.errors import StrictDataclassError
from numpy.typing import NDArray
from safetensors import SafetensorError
from transformers import AutoConfig, AutoImageProcessor, AutoModelForDepthEstimation
from transformers.utils import logging
from transformers.utils.hub import cached_file

from flexdepth.hub.families import UNKNOWN, Family, family_of
from flexdepth.hub.model_card import stated_licence
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.estimator import About
from flexdepth.runtime.foreign import Sight
from flexdepth.runtime.session import Provider

_DEVICES = {Provider.CPU: "cpu", Provider.CUDA: "cuda"}

_FAILURES = (
    *(OSError, ValueError, KeyError, TypeError, RuntimeError, ImportError),
    *(SafetensorError, StrictDataclassError),
)
"""What transformers raises where a model is not there, is broken, or needs more packages."""

_NEVER_USED = "fusion_stage.layers.0.residual_layer1."
"""Weights of DPT's first fusion, which has nothing to add to what comes up: no output depends on
them, and Intel's published files lack them."""


@dataclass(frozen=True, eq=False)
class HubNetwork:
    """A model of transformers.

    Attributes:
        about: Who it is.
        space: What its numbers are ambiguous up to.
        family: What it has in common with its kind.
        model: The network, in evaluation mode.
        processor: What makes pictures its input and its output depth.
    """

    about: About
    space: Space
    family: Family
    model: Any
    processor: Any

    @property
    def settings(self) -> Mapping[str, str]:
        """What its numbers depend on beside itself: nothing."""
        return {}

    def look(self, pixels: NDArray[np.uint8]) -> Sight:
        """Return what it sees in a picture: height x width x 3, RGB.

        Raises:
            InputError: The picture is too small for it, or memory does not suffice.
        """
        height, width = pixels.shape[:2]
        try:
            found = self._post_processed(pixels)
        except (RuntimeError, ValueError) as error:
            raise InputError(
                f"{self.about.name}: cannot run on a picture of {width} x {height} pixels: "
                f"{_first_line(error)}"
            ) from error
        values = found["predicted_depth"].reshape(height, width).float().cpu().numpy()
        if not self.family.by_width:
            return Sight(values)
        seen = found.get("focal_length")
        if seen is None:
            return Sight(values, canonical_focal=float(width))
        if not seen > 0:
            raise InputError(
                f"{self.about.name}: sees a field of view of {float(found['field_of_view']):g} "
                f"degrees in this picture, which no camera has"
            )
        return Sight(values, canonical_focal=float(seen), seen_focal=float(seen))

    def _post_processed(self, pixels: NDArray[np.uint8]) -> dict[str, Any]:
        size = [pixels.shape[:2]]
        shown = self.processor(
            images=pixels, input_data_format="channels_last", return_tensors="pt"
        ).to(self.model.device)
        with torch.inference_mode():
            seen = self.model(**shown)
            border = {"source_sizes": size} if self.family.padded else {}
            found: list[dict[str, Any]] = self.processor.post_process_depth_estimation(
                seen, target_sizes=size, **border
            )
        return found[0]


def network(name: str, provider: Provider = Provider.CPU) -> HubNetwork:
    """Return a model by its name on the hub, or from a folder that `save_pretrained` wrote.

    Args:
        name: Such as "depth-anything/Depth-Anything-V2-Small-hf", with "@REVISION" behind it for
            a tag, branch or commit; or a folder, such as "./mine".
        provider: What it runs on.

    Raises:
        InputError: There is no such model or it cannot be fetched, its numbers are not known, or
            its weights are not whole or not in safetensors.
    """
    device = _device(provider)
    place = _place(name)
    with _terse(bars=not place.get("local_files_only", False)):
        return _opened(name, place, device)


def _opened(name: str, place: dict[str, Any], device: str) -> HubNetwork:
    config = _loaded(AutoConfig, name, place)
    family = family_of(config, f"hub:{name}")
    processor = _loaded(AutoImageProcessor, name, place)
    model, report = _loaded(
        AutoModelForDepthEstimation,
        name,
        {**place, "use_safetensors": True, "output_loading_info": True},
    )
    lacking = sorted(map(str, [*report["missing_keys"], *report["mismatched_keys"]]))
    lacking = [each for each in lacking if _NEVER_USED not in each]
    if lacking:
        raise InputError(
            f"hub:{name}: {len(lacking)} weights are missing or of another shape, such as "
            f"{lacking[0]}; the file is not that of this model"
        )
    model = model.eval().float().to(device)
    about = About(
        _title(name),
        _version(name, config),
        _licence(place, family, config),
        _digest(model, processor),
    )
    return HubNetwork(about, family.space(config), family, model, processor)


@contextmanager
def _terse(bars: bool) -> Iterator[None]:
    """Let transformers say nothing of what it loads, which is checked here.

    Args:
        bars: Whether it may show how far it is: a download takes minutes, a file none.
    """
    verbosity, shown = logging.get_verbosity(), logging.is_progress_bar_enabled()
    logging.set_verbosity_error()  # type: ignore[no-untyped-call]
    if not bars:
        logging.disable_progress_bar()  # type: ignore[no-untyped-call]
    try:
        yield
    finally:
        logging.set_verbosity(verbosity)
        if shown:
            logging.enable_progress_bar()  # type: ignore[no-untyped-call]


def _device(provider: Provider) -> str:
    if provider not in _DEVICES:
        raise InputError(f"--provider: hub models run on {' or '.join(_DEVICES)}, got {provider}")
    if provider is Provider.CUDA and not torch.cuda.is_available():
        raise InputError("--provider cuda: torch sees no CUDA device here; use --provider cpu")
    return _DEVICES[provider]


def _place(name: str) -> dict[str, Any]:
    """Return where a model is, as transformers is told it."""
    folder = Path(name).expanduser()
    if folder.is_dir() or name.startswith((".", "/", "~")):
        if not (folder / "config.json").is_file():
            raise InputError(
                f"hub:{name}: wanted a folder with config.json, as save_pretrained writes it"
            )
        return {"pretrained_model_name_or_path": str(folder), "local_files_only": True}
    named, _, revision = name.partition("@")
    if named.count("/") != 1 or not all(named.split("/")):
        raise InputError(
            f"hub:{name}: wanted OWNER/MODEL, or a folder such as ./{name}; "
            "hub:depth-anything/Depth-Anything-V2-Small-hf is one"
        )
    return {"pretrained_model_name_or_path": named, "revision": revision or "main"}


def _loaded(kind: Any, name: str, place: Mapping[str, Any]) -> Any:  # noqa: ANN401
    """Return what transformers loads, never by running code of the model's."""
    try:
        return kind.from_pretrained(**place, trust_remote_code=False)
    except _FAILURES as error:
        advice = (
            ""
            if place.get("local_files_only")
            else "; where there is no internet, save it "
            "elsewhere with save_pretrained, and name the folder: hub:./FOLDER"
        )
        raise InputError(f"hub:{name}: {_first_line(error)}{advice}") from error


def _licence(place: Mapping[str, Any], family: Family, config: Any) -> str:  # noqa: ANN401
    """Return the licence that the model's card states, else the one its family is known by."""
    where = {**place}
    card = cached_file(
        where.pop("pretrained_model_name_or_path"),
        "README.md",
        **where,
        _raise_exceptions_for_missing_entries=False,
        _raise_exceptions_for_connection_errors=False,
        _raise_exceptions_for_gated_repo=False,
    )
    stated = stated_licence(Path(card)) if card else None
    return stated or family.licence(config) or UNKNOWN


def _title(name: str) -> str:
    return Path(name).expanduser().resolve().name if _is_folder(name) else name.partition("@")[0]


def _is_folder(name: str) -> bool:
    return Path(name).expanduser().is_dir()


def _version(name: str, config: Any) -> str:  # noqa: ANN401
    """Return the commit on the hub; a folder has none."""
    commit = None if _is_folder(name) else config._commit_hash
    return str(commit or "")[:12]


def _digest(model: Any, processor: Any) -> str:  # noqa: ANN401
    """Return the SHA-256 of all weights and settings, wherever they came from."""
    digest = hashlib.sha256()
    for settings in (model.config.to_dict(), processor.to_dict()):
        told = {key: value for key, value in settings.items() if not key.startswith("_")}
        digest.update(json.dumps(told, sort_keys=True, default=str).encode())
    for name, weight in sorted(model.state_dict().items()):
        if _NEVER_USED in name:
            continue
        digest.update(name.encode())
        digest.update(weight.detach().cpu().reshape(-1).view(torch.uint8).numpy().tobytes())
    return digest.hexdigest()


def _first_line(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return (lines or [type(error).__name__])[0][:300].rstrip(".")
