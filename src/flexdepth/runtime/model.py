"""A model bundle: one ONNX file that says what its numbers mean.

The file's metadata holds, under the key `flexdepth`, the JSON of a `Description`. The network
takes `image` (batch, 3, height, width), RGB in [0, 1], and gives `depth` (batch, height, width),
in metres for a camera with the canonical focal length, and `sky` (batch, height, width), the
probability of sky. It may also give `spread` (batch, height, width), the relative standard
deviation of depth, and `focal` (batch), the focal length in image diagonals. Batch, height and
width are free. A bundle may come from anywhere: it is
opened by onnxruntime alone, runs no code of its own and reads no other file.
"""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from importlib import resources
from pathlib import Path
from threading import Lock
from types import MappingProxyType

import numpy as np
import onnxruntime as ort
from numpy.typing import NDArray
from onnxruntime.capi import onnxruntime_pybind11_state as ort_errors

from flexdepth.runtime.answer import Answer
from flexdepth.runtime.bundle import METADATA_KEY, Description, read_description
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.onnx_file import names_other_files
from flexdepth.runtime.opening import open_input

_BUNDLED = "compact.onnx"
_FAILURES = (
    ort_errors.EPFail,
    ort_errors.Fail,
    ort_errors.InvalidArgument,
    ort_errors.InvalidGraph,
    ort_errors.InvalidProtobuf,
    ort_errors.NoModel,
    ort_errors.NotImplemented,
    ort_errors.RuntimeException,
)


class Provider(StrEnum):
    """What a network runs on."""

    CPU = "cpu"
    CUDA = "cuda"
    COREML = "coreml"
    DIRECTML = "directml"


@dataclass(frozen=True)
class _Engine:
    name: str
    package: str


_ENGINES: Mapping[Provider, _Engine] = MappingProxyType(
    {
        Provider.CPU: _Engine("CPUExecutionProvider", "onnxruntime"),
        Provider.CUDA: _Engine("CUDAExecutionProvider", "onnxruntime-gpu"),
        Provider.COREML: _Engine("CoreMLExecutionProvider", "onnxruntime, on macOS"),
        Provider.DIRECTML: _Engine("DmlExecutionProvider", "onnxruntime-directml, on Windows"),
    }
)


def _positive(output: NDArray[np.float32]) -> bool:
    return bool((output > 0).all() and np.isfinite(output).all())


def _probable(output: NDArray[np.float32]) -> bool:
    return bool((output >= 0).all() and (output <= 1).all())


@dataclass(frozen=True)
class _Output:
    """What an output of a network is to be like."""

    axes: int
    sane: Callable[[NDArray[np.float32]], bool]
    wanted: str
    needed: bool


_OUTPUTS: Mapping[str, _Output] = MappingProxyType(
    {
        "depth": _Output(3, _positive, "numbers > 0", True),
        "sky": _Output(3, _probable, "probabilities", True),
        "spread": _Output(3, _positive, "numbers > 0", False),
        "focal": _Output(1, _positive, "numbers > 0", False),
    }
)


@dataclass(frozen=True, eq=False)
class Model:
    """A network that is ready to run. Threads may share it: they take turns.

    Attributes:
        description: What the bundle says of itself.
        digest: The SHA-256 of the bundle file, in hexadecimal.
        path: The bundle file.
    """

    description: Description
    digest: str
    path: Path
    session: ort.InferenceSession = field(repr=False)
    _turn: Lock = field(default_factory=Lock, repr=False)

    @property
    def title(self) -> str:
        """Name and version, such as "compact 0.1.0"."""
        return f"{self.description.name} {self.description.version}"

    def run(self, images: NDArray[np.float32]) -> Answer:
        """Return what the network answers for a batch of pictures.

        Args:
            images: (batch, 3, height, width), RGB in [0, 1]; height and width multiples of the
                description's.

        Raises:
            InputError: The network fails, or gives what is no depth: a wrong shape, NaN, a
                depth that is not positive and finite, a probability outside [0, 1].
        """
        given = [each.name for each in self.session.get_outputs() if each.name in _OUTPUTS]
        try:
            with self._turn:
                found = dict(zip(given, self.session.run(given, {"image": images}), strict=True))
        except _FAILURES as error:
            raise InputError(
                f"{self.path}: the model cannot run at {images.shape[3]} x {images.shape[2]} "
                f"pixels: {_one_line(error)}; a smaller --long-side may help"
            ) from error
        for name, output in found.items():
            self._check(name, output, images)
        return Answer(**found)

    def _check(self, name: str, output: NDArray[np.float32], images: NDArray[np.float32]) -> None:
        about = _OUTPUTS[name]
        wanted = (images.shape[0], *images.shape[2:])[: about.axes]
        if output.shape != wanted:
            raise InputError(
                f"{self.path}: output `{name}`: wanted the shape {wanted} of its input, "
                f"got {output.shape}; the bundle is broken"
            )
        if not about.sane(output):
            raise InputError(
                f"{self.path}: output `{name}`: wanted {about.wanted}, got values from "
                f"{output.min():g} to {output.max():g}; the bundle is broken"
            )


def load_model(
    path: Path | None = None, provider: Provider = Provider.CPU, threads: int | None = None
) -> Model:
    """Return the bundle at `path`, checked and ready to run.

    Args:
        path: An .onnx file; None takes the model that comes with flexdepth.
        provider: What it runs on.
        threads: How many CPU threads one run uses; None is one for each physical core.

    Raises:
        InputError: The file is absent or no bundle; the provider is not available here.
    """
    if threads is not None and threads < 1:
        raise InputError(f"--threads: wanted a number of threads >= 1, got {threads}")
    file = bundled_file() if path is None else path
    with open_input(file) as opened:
        content = opened.read()
    _refuse_other_files(file, content)
    session = _session(file, content, provider, threads)
    text = session.get_modelmeta().custom_metadata_map.get(METADATA_KEY)
    if text is None:
        raise InputError(
            f"{file}: wanted a bundle with the metadata `{METADATA_KEY}`, got an ONNX model "
            f"without; flexdepth's export writes it"
        )
    description = read_description(text, file)
    _check_signature(session, file)
    return Model(description, hashlib.sha256(content).hexdigest(), file, session)


def bundled_file() -> Path:
    """Return where the model that comes with flexdepth lies.

    Raises:
        InputError: It is missing.
    """
    file = resources.files("flexdepth.runtime") / "assets" / _BUNDLED
    if not isinstance(file, Path) or not file.is_file():
        raise InputError(
            f"the model {_BUNDLED} is missing from this installation ({file}); install flexdepth "
            f"again, or name a bundle with --model"
        )
    return file


def _refuse_other_files(file: Path, content: bytes) -> None:
    try:
        elsewhere = names_other_files(content)
    except ValueError as error:
        raise InputError(
            f"{file}: wanted an ONNX model, got {error}; --model takes an .onnx bundle"
        ) from error
    if elsewhere:
        raise InputError(
            f"{file}: the model keeps weights in other files, which a bundle must not; save it "
            f"as one file"
        )


def _session(
    file: Path, content: bytes, provider: Provider, threads: int | None
) -> ort.InferenceSession:
    engine = _ENGINES[provider]
    available = [each for each in Provider if _ENGINES[each].name in ort.get_available_providers()]
    if provider not in available:
        raise InputError(
            f"--provider {provider} is not in the onnxruntime installed here, which has "
            f"{', '.join(available)}; in its place: pip install {engine.package}"
        )
    options = ort.SessionOptions()
    options.intra_op_num_threads = threads or 0
    options.log_severity_level = 4
    try:
        session = ort.InferenceSession(
            content, options, providers=[engine.name], enable_fallback=False
        )
    except _FAILURES as error:
        raise InputError(
            f"{file}: onnxruntime cannot open the model on {provider}: {_one_line(error)}"
        ) from error
    if engine.name not in session.get_providers():
        raise InputError(
            f"--provider {provider} could not start, its drivers or libraries are missing; "
            f"use --provider cpu"
        )
    return session


def _check_signature(session: ort.InferenceSession, file: Path) -> None:
    """Refuse a network with other inputs or outputs than a bundle's."""
    inputs = {each.name: each for each in session.get_inputs()}
    outputs = {each.name: each for each in session.get_outputs()}
    if set(inputs) != {"image"}:
        raise InputError(f"{file}: inputs: wanted `image` alone, got {sorted(inputs)}")
    if not {name for name, about in _OUTPUTS.items() if about.needed} <= set(outputs):
        raise InputError(f"{file}: outputs: wanted `depth` and `sky`, got {sorted(outputs)}")
    known = [(outputs[name], _OUTPUTS[name].axes) for name in _OUTPUTS if name in outputs]
    for value, rank in ((inputs["image"], 4), *known):
        if value.type != "tensor(float)" or len(value.shape) != rank:
            raise InputError(
                f"{file}: `{value.name}`: wanted tensor(float) of {rank} axes, "
                f"got {value.type} of {value.shape}"
            )
    batch, channels, height, width = inputs["image"].shape
    if channels != 3 or any(isinstance(size, int) for size in (batch, height, width)):
        raise InputError(
            f"{file}: `image`: wanted (batch, 3, height, width) with batch, height and width "
            f"free, got {inputs['image'].shape}"
        )


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
