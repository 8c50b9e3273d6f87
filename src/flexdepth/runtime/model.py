"""A model bundle: one ONNX file that says what its numbers mean.

The file's metadata holds, under the key `flexdepth`, the JSON of a `Description`. The network
takes `image` (batch, 3, height, width), RGB in [0, 1], and gives `depth` (batch, height, width),
in metres for a camera with the canonical focal length, and `sky` (batch, height, width), the
probability of sky; batch, height and width are free. A bundle may come from anywhere: it is
opened by onnxruntime alone, runs no code of its own and reads no other file.
"""

from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
import onnxruntime as ort
from numpy.typing import NDArray

from flexdepth.runtime.bundle import METADATA_KEY, Description, read_description
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.session import Provider, Session, open_session

__all__ = ["Model", "Provider", "bundled_file", "load_model", "model_in"]

_BUNDLED = "compact.onnx"


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

    def run(self, images: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return canonical depth and the probability of sky, each (batch, height, width).

        Args:
            images: (batch, 3, height, width), RGB in [0, 1]; height and width multiples of the
                description's.

        Raises:
            InputError: The network fails, or gives what is no depth: a wrong shape, NaN, a
                depth that is not positive and finite, a probability outside [0, 1].
        """
        size = (images.shape[3], images.shape[2])
        found = self.session.run(["depth", "sky"], {"image": images}, size)
        depth, sky = (np.asarray(each, np.float32) for each in found)
        self._check("depth", depth, images, bool((depth > 0).all() and np.isfinite(depth).all()))
        self._check("sky", sky, images, bool((sky >= 0).all() and (sky <= 1).all()))
        return depth, sky

    def _check(
        self, name: str, output: NDArray[np.float32], images: NDArray[np.float32], sane: bool
    ) -> None:
        wanted = (images.shape[0], *images.shape[2:])
        if output.shape != wanted:
            raise InputError(
                f"{self.path}: output `{name}`: wanted the shape {wanted} of its input, "
                f"got {output.shape}; the bundle is broken"
            )
        if not sane:
            raise InputError(
                f"{self.path}: output `{name}`: wanted "
                f"{'numbers > 0' if name == 'depth' else 'probabilities'}, got values from "
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
    if not {"depth", "sky"} <= set(outputs):
        raise InputError(f"{file}: outputs: wanted `depth` and `sky`, got {sorted(outputs)}")
    for value, rank in ((inputs["image"], 4), (outputs["depth"], 3), (outputs["sky"], 3)):
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
