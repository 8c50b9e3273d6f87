"""Networks of other people behind the interface of our own.

Such a network brings its own way of looking at a picture; what it gives is taken as it is, at the
picture's size and in its own space: nothing is fitted, shifted or scaled to look like metres.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexdepth.runtime.depthmap import DepthMap, FocalSource, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.estimator import About
from flexdepth.runtime.images import Photo
from flexdepth.runtime.lens import Lens, Said, intrinsics
from flexdepth.runtime.predictor import photo_of


@dataclass(frozen=True, eq=False)
class Sight:
    """What a network sees in a picture.

    Attributes:
        values: Height by width of the picture, in the network's space.
        canonical_focal: The focal length, in pixels of the picture, of the camera for which the
            values are metres; None where they do not depend on the camera.
        seen_focal: The focal length that the network sees in the picture, in the same pixels; None
            where it sees none.
    """

    values: NDArray[np.float32]
    canonical_focal: float | None = None
    seen_focal: float | None = None


@runtime_checkable
class Network(Protocol):
    """A network of other people."""

    @property
    def about(self) -> About:
        """Who it is."""
        ...

    @property
    def space(self) -> Space:
        """What its numbers are ambiguous up to."""
        ...

    @property
    def settings(self) -> Mapping[str, str]:
        """What its numbers depend on beside itself."""
        ...

    def look(self, pixels: NDArray[np.uint8]) -> Sight:
        """Return what it sees in a picture: height x width x 3, RGB.

        Raises:
            InputError: The network fails.
        """
        ...


@dataclass(frozen=True, eq=False)
class ForeignPredictor:
    """A network of other people, and the camera of the pictures it is shown.

    Depth that is not above zero and what is not a number are unknown (NaN); an infinite depth is
    sky. Metres stay metres, also where nothing is known of the camera; those of a canonical camera
    need a focal length, and the one that the network itself sees is part of what it predicts.

    Attributes:
        network: The network.
        lens: What the user says of the camera; None takes each photo's own word, then what the
            network sees, then an assumption.
    """

    network: Network
    lens: Lens | None = None

    @property
    def about(self) -> About:
        """Who the model is."""
        return self.network.about

    @property
    def settings(self) -> Mapping[str, str]:
        """How pictures are shown to it."""
        return {"lens": str(self.lens or "the photo's own"), **self.network.settings}

    def predict(self, picture: Photo | str | Path | ArrayLike) -> DepthMap:
        """Return the depth or the disparity of one picture, at its own size.

        Args:
            picture: A photo, a file, or an array of uint8: height x width x 3 in RGB, or height x
                width in gray.

        Raises:
            InputError: The file or the array is no picture; the network fails or gives no
                numbers.
        """
        photo = photo_of(picture)
        height, width = photo.pixels.shape[:2]
        sight = self.network.look(photo.pixels)
        if sight.values.shape != (height, width):
            raise InputError(
                f"{self.about.name}: wanted {width} x {height} numbers, those of the picture, "
                f"got the shape {sight.values.shape}"
            )
        seen = None if sight.seen_focal is None else sight.seen_focal / hypot(width, height)
        camera = intrinsics(width, height, self.lens, Said(photo.focal_in_diagonals, seen))
        space, values = self.network.space, np.array(sight.values, np.float32)
        if sight.canonical_focal is not None:
            values *= np.float32(camera.focal_x / sight.canonical_focal)
            if camera.source is FocalSource.ASSUMED:
                space = Space.SCALE
        _forget_nonsense(values, space)
        if np.isnan(values).all():
            raise InputError(f"{self.about.name}: its map of this picture holds no usable number")
        return DepthMap(values, space, camera, self.about.title)

    def predict_all(self, photos: Sequence[Photo]) -> list[DepthMap]:
        """Return the depth or the disparity of each photo, in their order."""
        return [self.predict(photo) for photo in photos]


def _forget_nonsense(values: NDArray[np.float32], space: Space) -> None:
    """Make NaN of what the space has no meaning for; infinity stays where it is sky."""
    with np.errstate(invalid="ignore"):
        match space:
            case Space.METRIC | Space.SCALE:
                values[~(values > 0)] = np.nan
            case Space.AFFINE_DEPTH:
                values[values == -np.inf] = np.nan
            case Space.AFFINE_DISPARITY:
                values[values == np.inf] = np.nan
