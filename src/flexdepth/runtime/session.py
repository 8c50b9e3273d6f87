"""An ONNX file that onnxruntime has opened: from anywhere, it runs no code of its own.

The file is read once, refused where its weights lie in other files, and kept open.
"""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from threading import Lock
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
import onnxruntime as ort
from numpy.typing import NDArray
from onnxruntime.capi import onnxruntime_pybind11_state as ort_errors

from flexdepth.runtime.errors import InputError, reason
from flexdepth.runtime.onnx_file import names_other_files
from flexdepth.runtime.opening import open_input

Numbers: TypeAlias = NDArray[np.generic]

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


@dataclass(frozen=True, eq=False)
class Session:
    """A network that is ready to run. Threads may share it: they take turns.

    Attributes:
        path: The file.
        digest: Its SHA-256, in hexadecimal.
        opened: What onnxruntime made of it.
    """

    path: Path
    digest: str
    opened: ort.InferenceSession = field(repr=False)
    _turn: Lock = field(default_factory=Lock, repr=False)

    @property
    def metadata(self) -> Mapping[str, str]:
        """What the file says of itself."""
        said: Mapping[str, str] = self.opened.get_modelmeta().custom_metadata_map
        return said

    def run(
        self, outputs: Sequence[str], inputs: Mapping[str, Numbers], size: tuple[int, int]
    ) -> list[Numbers]:
        """Return the named outputs.

        Args:
            outputs: Their names.
            inputs: By name.
            size: Width and height of what the network sees, named in errors.

        Raises:
            InputError: The network fails.
        """
        try:
            with self._turn:
                found: list[Numbers] = self.opened.run(list(outputs), dict(inputs))
        except _FAILURES as error:
            raise InputError(
                f"{self.path}: the model cannot run at {size[0]} x {size[1]} pixels: "
                f"{reason(error)}; a smaller --long-side may help"
            ) from error
        return found


def open_session(
    file: Path, provider: Provider = Provider.CPU, threads: int | None = None
) -> Session:
    """Return an ONNX file, opened.

    Args:
        file: The file.
        provider: What it runs on.
        threads: How many CPU threads one run uses; None is one for each physical core.

    Raises:
        InputError: The file is absent, no ONNX model or keeps weights elsewhere; the provider is
            not available here.
    """
    if threads is not None and threads < 1:
        raise InputError(f"--threads: wanted a number of threads >= 1, got {threads}")
    with open_input(file) as opened:
        content = opened.read()
    _refuse_other_files(file, content)
    return Session(
        file, hashlib.sha256(content).hexdigest(), _opened(file, content, provider, threads)
    )


def _refuse_other_files(file: Path, content: bytes) -> None:
    try:
        elsewhere = names_other_files(content)
    except ValueError as error:
        todo = (
            f"make a bundle of the checkpoint first: flexdepth export {file} -o own.onnx"
            if file.suffix == ".safetensors"
            else "--model takes an .onnx bundle"
        )
        raise InputError(f"{file}: wanted an ONNX model, got {error}; {todo}") from error
    if elsewhere:
        raise InputError(
            f"{file}: the model keeps weights in other files, which a bundle must not; save it as "
            f"one file"
        )


def _opened(
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
            f"{file}: onnxruntime cannot open the model on {provider}: {reason(error)}"
        ) from error
    if engine.name not in session.get_providers():
        raise InputError(
            f"--provider {provider} could not start, its drivers or libraries are missing; "
            f"use --provider cpu"
        )
    return session
