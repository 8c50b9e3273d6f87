"""A model bundle: one ONNX file that says what its numbers mean.

The file's metadata holds, under the key `flexdepth`, the JSON of a `Description`. The network
takes `image` (batch, 3, height, width), RGB in [0, 1], and gives `depth` (batch, height, width),
in metres for a camera with the canonical focal length, and `sky` (batch, height, width), the
probability of sky. It may also give `spread` (batch, height, width), the relative standard
deviation of depth, and `focal` (batch), the focal length in image diagonals. Batch, height and
width are free. A bundle may come from anywhere: it is
opened by onnxruntime alone, runs no code of its own and reads no other file.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from types import MappingProxyType

import numpy as np
import onnxruntime as ort
from numpy.typing import NDArray

from flexdepth.runtime.answer import Answer
from flexdepth.runtime.bundle import METADATA_KEY, Description, read_description
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.session import Provider, Session, open_session

__all__ = ["Model", "Provider", "bundled_file", "load_model", "model_in"]

_BUNDLED = "compact.onnx"


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
        session: The network, opened.
    """

    description: Description
    session: Session

    @property
    def digest(self) -> str:
        """The SHA-256 of the bundle file, in hexadecimal."""
        return self.session.digest

    @property
    def path(self) -> Path:
        """The bundle file."""
        return self.session.path

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
        given = [each.name for each in self.session.opened.get_outputs() if each.name in _OUTPUTS]
        size = (images.shape[3], images.shape[2])
        answers = self.session.run(given, {"image": images}, size)
        found = {
            name: np.asarray(output, np.float32)
            for name, output in zip(given, answers, strict=True)
        }
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
    file = bundled_file() if path is None else path
    return model_in(open_session(file, provider, threads))


def model_in(session: Session) -> Model:
    """Return the bundle that has been opened, checked.

    Raises:
        InputError: It is none.
    """
    text = session.metadata.get(METADATA_KEY)
    if text is None:
        raise InputError(
            f"{session.path}: wanted a bundle with the metadata `{METADATA_KEY}`, got an ONNX "
            f"model without; flexdepth's export writes it, and docs/models.md says how a .yaml "
            f"file beside it does as well"
        )
    description = read_description(text, session.path)
    _check_signature(session.opened, session.path)
    return Model(description, session)


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
