"""From a picture to its depth map, at the picture's own size."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from math import log, prod, sqrt
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from flexdepth.runtime.answer import Answer
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.edges import with_sharp_edges
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.estimator import About
from flexdepth.runtime.images import Photo, read_photo
from flexdepth.runtime.lens import Lens, Said, intrinsics
from flexdepth.runtime.looks import Look, at_three_sizes
from flexdepth.runtime.model import Model
from flexdepth.runtime.sizes import network_size, resized, times_larger
from flexdepth.runtime.tiles import Seen, closer, joined, tiling

_SKY = 0.5
"""The probability above which a pixel is sky."""


@dataclass(frozen=True, eq=False)
class Predictor:
    """A model, and how pictures are shown to it. Threads may share it.

    Attributes:
        model: The network.
        lens: What the user says of the camera; None takes each photo's own word, or else assumes
            a lens.
        long_side: The longer side of what the network sees, in pixels; None keeps the bundle's
            area.
        look: How the network looks at the whole picture; it looks once at what is larger.
        details: How many times as wide and high the picture is shown once more, for what is fine,
            but not larger than it is; 1: one look. A picture with no more pixels than the first
            look has one look too, and so has what `long_side` shows larger than the bundle's area.
        tiles: How many tiles of a picture's longer side are looked at as well, each at the size
            that the whole is given; fewer where they would be smaller than that. 1: the whole
            alone.
    """

    model: Model
    lens: Lens | None = None
    long_side: int | None = None
    look: Look = at_three_sizes
    details: int = 2
    tiles: int = 1

    def __post_init__(self) -> None:
        """Refuse numbers that are none."""
        for name, value in (("--details", self.details), ("--tiles", self.tiles)):
            if value < 1:
                raise InputError(f"{name}: wanted a whole number >= 1, got {value}")

    @property
    def about(self) -> About:
        """Who the model is."""
        said = self.model.description
        return About(said.name, said.version, said.licence, self.model.digest)

    @property
    def settings(self) -> Mapping[str, str]:
        """How pictures are shown to it."""
        return {
            "lens": str(self.lens or "the photo's own"),
            "look": self.look.__name__,
            "long_side": str(self.long_side or "by area"),
            "details": str(self.details),
            "tiles": str(self.tiles),
        }

    def predict(self, picture: Photo | str | Path | ArrayLike) -> DepthMap:
        """Return the depth of one picture, at its own size, +inf in the sky.

        The space is `metric` where the focal length is given or written in the photo, else
        `scale`; the intrinsics say which.

        Args:
            picture: A photo, a file, or an array of uint8: height x width x 3 in RGB, or height x
                width in gray.

        Raises:
            InputError: The file or the array is no picture; the model fails.
        """
        (depth_map,) = self.predict_all([photo_of(picture)])
        return depth_map

    def predict_all(self, photos: Sequence[Photo]) -> list[DepthMap]:
        """Return the depth of each photo, in their order.

        Photos that follow one another and look alike to the network, as the frames of a video
        do, share a run; the maps are those of `predict` up to rounding.
        """
        found = []
        for size, alike in groupby(photos, self._network_size):
            run = list(alike)
            seen = self.look(self.model, partial(self._shown, run, size)).each()
            found += [self._at_own_size(*each) for each in zip(run, seen, strict=True)]
        return found

    def _shown(
        self, photos: Sequence[Photo], size: tuple[int, int], times: float
    ) -> NDArray[np.float32]:
        """Return photos of one network size at so many times that size."""
        wanted = times_larger(size, times, self.model.description.multiple)
        return np.stack([_as_seen(photo.pixels, wanted) for photo in photos])

    def _network_size(self, photo: Photo) -> tuple[int, int]:
        return self._size_of(photo.pixels)

    def _size_of(self, pixels: NDArray[np.uint8]) -> tuple[int, int]:
        height, width = pixels.shape[:2]
        return network_size(width, height, self.model.description, self.long_side)

    def _closer(self, pixels: NDArray[np.uint8], whole: Seen) -> Seen:
        """Return the whole with the details of a larger look, where that can show more."""
        own_area = prod(self.model.description.area)
        shown_large = self.long_side is not None and whole.sky.size > own_area
        if self.details == 1 or shown_large or pixels[..., 0].size <= whole.sky.size:
            return whole
        multiple = self.model.description.multiple
        times = min(self.details, sqrt(pixels[..., 0].size / whole.sky.size))
        height, width = (round(side * times / multiple) * multiple for side in whole.sky.shape)
        return closer(whole, self._seen_once(pixels, (width, height)))

    def _tile_seen(self, pixels: NDArray[np.uint8]) -> Seen:
        return self._seen_once(pixels, self._size_of(pixels))

    def _seen_once(self, pixels: NDArray[np.uint8], size: tuple[int, int]) -> Seen:
        (seen,) = self.model.run(_as_seen(pixels, size)[None]).each()
        return _logarithmic(seen)

    def _at_own_size(self, photo: Photo, whole: Answer) -> DepthMap:
        height, width = photo.pixels.shape[:2]
        grid = tiling(width, height, self.tiles, whole.sky.size)
        seen = self._closer(photo.pixels, _logarithmic(whole))
        own = joined(photo.pixels, seen, grid, self._tile_seen)
        said = Said(photo.focal_in_diagonals, whole.focal_of_one)
        camera = intrinsics(width, height, self.lens, said)
        about = self.model.description
        unit = camera.focal_by_area(width, height) / about.canonical_focal
        values = with_sharp_edges(own.log_depth, photo.pixels)
        values += np.float32(log(unit))
        np.exp(values, out=values)
        sky = own.sky > _SKY
        values[sky] = np.inf
        metric = about.space is Space.METRIC and camera.source.is_known
        return DepthMap(
            values,
            Space.METRIC if metric else Space.SCALE,
            camera,
            self.model.title,
            _spread(whole, (width, height), sky),
            about.scale_spread if metric else None,
        )


def photo_of(picture: Photo | str | Path | ArrayLike) -> Photo:
    """Return the photo that a caller means by a file or an array.

    Raises:
        InputError: The file cannot be read as a picture; the array is not of uint8, or neither
            gray nor RGB, or empty.
    """
    if isinstance(picture, Photo):
        return picture
    if isinstance(picture, str | Path):
        return read_photo(Path(picture))
    if isinstance(picture, Image.Image) and picture.mode not in ("RGB", "L"):
        raise InputError(
            f"a Pillow picture of mode {picture.mode} has numbers that are no colours; "
            'give its file, or picture.convert("RGB")'
        )
    try:
        pixels = np.asarray(picture)
    except ValueError as error:
        raise InputError(f"a picture is an array of uint8, this is no array: {error}") from error
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, axis=2)
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] != 3 or not pixels.size:
        raise InputError(
            f"a picture is a non-empty array of uint8, height x width x 3 in RGB or height x width "
            f"in gray, got shape {pixels.shape} of {pixels.dtype}"
        )
    return Photo(pixels, None, ())


def _logarithmic(answer: Answer) -> Seen:
    return Seen(np.log(answer.depth), answer.sky)


def _spread(
    whole: Answer, size: tuple[int, int], sky: NDArray[np.bool_]
) -> NDArray[np.float32] | None:
    """Return the spread at the picture's size, NaN in the sky; None where it is not said."""
    if whole.spread is None:
        return None
    spread = resized(whole.spread, size)
    spread[sky] = np.nan
    return spread


def _as_seen(pixels: NDArray[np.uint8], size: tuple[int, int]) -> NDArray[np.float32]:
    """Return the picture as the network takes it: (3, height, width), RGB in [0, 1]."""
    seen = resized(np.ascontiguousarray(pixels), size)
    return np.moveaxis(seen, 2, 0).astype(np.float32) / np.float32(255)
