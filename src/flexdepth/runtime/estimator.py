"""What turns pictures into depth maps, whoever made it: the interface of every model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, runtime_checkable

from numpy.typing import ArrayLike

from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.images import Photo


@dataclass(frozen=True)
class About:
    """Who a model is.

    Attributes:
        name: Such as "compact".
        version: Of the weights; empty where nothing says it.
        licence: Of the weights, as an SPDX identifier; "unknown" where nothing says it.
        digest: A SHA-256, in hexadecimal, of all that its numbers depend on.
    """

    name: str
    version: str
    licence: str
    digest: str

    @property
    def title(self) -> str:
        """Name and version, such as "compact 0.1.0"."""
        return f"{self.name} {self.version}".rstrip()


@runtime_checkable
class Estimator(Protocol):
    """A model that is ready to look at pictures, and how pictures are shown to it."""

    @property
    def about(self) -> About:
        """Who the model is."""
        ...

    @property
    def settings(self) -> Mapping[str, str]:
        """How pictures are shown to it: with the model, all that its maps depend on."""
        ...

    def predict(self, picture: Photo | str | Path | ArrayLike) -> DepthMap:
        """Return the depth of one picture, at its own size.

        Args:
            picture: A photo, a file, or an array of uint8: height x width x 3 in RGB, or height x
                width in gray.

        Raises:
            InputError: The file or the array is no picture; the model fails.
        """
        ...

    def predict_all(self, photos: Sequence[Photo]) -> list[DepthMap]:
        """Return the depth of each photo, in their order."""
        ...
