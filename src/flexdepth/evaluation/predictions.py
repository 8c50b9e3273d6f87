"""Where predictions come from: a model that makes them, or a folder that any program has filled."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np

from flexdepth.data.folder import Pair
from flexdepth.data.views import OrdinalPair
from flexdepth.evaluation.region import Region
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.estimator import Estimator
from flexdepth.runtime.files import SUFFIXES, read_depth, read_origin, read_stated, write_depth
from flexdepth.runtime.images import Photo
from flexdepth.runtime.outputs import is_made

_PICTURES = (".preview.png", ".normals.png")


Image: TypeAlias = Pair | OrdinalPair
"""An image of a set, with what is known of it."""


@runtime_checkable
class Predictions(Protocol):
    """What gives the prediction of an image of a set."""

    def of(self, pair: Image, number: int, view: Region) -> DepthMap:
        """Return the prediction of one image.

        Args:
            pair: The image; of its truth only the camera is looked at.
            number: Of the image in its set, from 0.
            view: The part of the image that the network is shown.

        Raises:
            InputError: There is none, or it cannot be made.
        """
        ...

    @property
    def about(self) -> Mapping[str, object]:
        """What they are, to tell them by later."""
        ...


@dataclass(frozen=True)
class Stated:
    """What the user says of numbers that do not say it themselves.

    Attributes:
        space: What they are ambiguous up to.
        scale: The value of the stored number 1; metres if `space` is metric.
    """

    space: Space
    scale: float = 1.0


@dataclass(frozen=True)
class PredictionFolder:
    """Depth files that some program has written: npz, npy, 16-bit PNG, EXR, PFM.

    Attributes:
        folder: Where they lie.
        paths: By the name of the image: NAME.npz, or PART/NAME.npz for an image `PART_NAME`.
        ordered: The files in the order of the images instead; empty where names decide.
        stated: What their numbers mean; None reads it from the files.
    """

    folder: Path
    paths: Mapping[str, Path] = field(repr=False)
    ordered: tuple[Path, ...] = ()
    stated: Stated | None = None

    def of(self, pair: Image, number: int, view: Region) -> DepthMap:  # noqa: ARG002 - as it is
        """Return the prediction of one image, of whatever part of it was predicted.

        Raises:
            InputError: There is none, or it is broken or does not say what its numbers mean.
        """
        if self.ordered:
            path = self.ordered[number]
        elif pair.name in self.paths:
            path = self.paths[pair.name]
        else:
            raise InputError(
                f"{self.folder}: there is no prediction for the image {pair.name}; looked for "
                f"{pair.name}{'|'.join(SUFFIXES.values())} {self._elsewhere(pair.name)}"
            )
        if self.stated is None:
            return read_depth(path)
        return read_stated(path, self.stated.space, self.stated.scale)

    def _elsewhere(self, name: str) -> str:
        """Return where else the prediction of an image might be."""
        below = next((path for path in self.paths.values() if path.stem == name), None)
        if below is not None:
            return f"(there is {below}: name the folder {below.parent})"
        return "(--match order takes files by their order instead)"

    @property
    def about(self) -> Mapping[str, object]:
        """The folder, and what its numbers are said to mean."""
        stated = self.stated
        return {
            "folder": str(self.folder),
            "matched": "by order" if self.ordered else "by name",
            "stated": {"space": str(stated.space), "scale": stated.scale} if stated else None,
        }


def prediction_folder(
    folder: Path, stated: Stated | None = None, images_in_order: int | None = None
) -> PredictionFolder:
    """Return the depth files in a folder and below it.

    Args:
        folder: Where they lie.
        stated: What their numbers mean; None where they say it themselves.
        images_in_order: How many images there are, to match them with the files by order; None
            matches by name.

    Raises:
        InputError: There is no such folder or no depth file in it, two files are of one image, or
            there are not as many files as images.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder of predictions")
    files = sorted(
        path
        for path in folder.rglob("*")
        if path.suffix.lower() in SUFFIXES.values() and not path.name.endswith(_PICTURES)
    )
    if not files:
        raise InputError(f"{folder}: holds no depth file ({', '.join(SUFFIXES.values())})")
    if images_in_order is not None:
        if len(files) != images_in_order:
            raise InputError(
                f"{folder}: holds {len(files)} depth files, the set {images_in_order} images: "
                f"their order does not say which belongs to which"
            )
        return PredictionFolder(folder, {}, tuple(files), stated)
    paths: dict[str, Path] = {}
    for path in files:
        name = "_".join(path.relative_to(folder).with_suffix("").parts)
        if name in paths:
            raise InputError(
                f"{path}: {paths[name].name} is a prediction of {name} too; keep one of them"
            )
        paths[name] = path
    return PredictionFolder(folder, paths, (), stated)


@dataclass(frozen=True, eq=False)
class ModelPredictions:
    """What a model predicts, kept on disk so that it is predicted once.

    A file that was made from other pixels, by another model or with other settings is not used.

    Attributes:
        predictor: The model.
        cache: The folder in which predictions are kept.
        overwrite: Replace what lies in the place of a prediction and is none of these.
    """

    predictor: Estimator
    cache: Path
    overwrite: bool = False

    def of(self, pair: Image, number: int, view: Region) -> DepthMap:  # noqa: ARG002
        """Return the prediction of the part of one image that the network is shown.

        The focal length is that of the set, so that depth comes out in metres.

        Raises:
            InputError: The model fails, or something else lies in the place of the prediction.
        """
        box = view.box(*pair.image.shape[:2])
        pixels = np.ascontiguousarray(pair.image[box.slices])
        focal = _focal(pair, box.size)
        origin = {
            "input": f"sha256:{hashlib.sha256(pixels.tobytes()).hexdigest()}",
            "size": f"{box.size[1]}x{box.size[0]}",
            "model": f"sha256:{self.predictor.about.digest}",
            **self.predictor.settings,
            "lens": str(focal),
        }
        path = self.cache / view.label / f"{pair.name}.npz"
        if not self.overwrite and is_made(path, origin, read_origin):
            return read_depth(path)
        found = self.predictor.predict(Photo(pixels, focal, ()))
        write_depth(path, found, origin)
        return found

    @property
    def about(self) -> Mapping[str, object]:
        """The model and how it looks at pictures."""
        model, settings = self.predictor.about, dict(self.predictor.settings)
        settings.pop("lens")  # the set's own, which differs from image to image
        return {
            "name": model.name,
            "version": model.version,
            "licence": model.licence,
            "sha256": model.digest,
            **settings,
        }


def _focal(pair: Image, size: tuple[int, int]) -> float | None:
    """Return the focal length in diagonals of the part of the image that is shown."""
    if isinstance(pair, OrdinalPair) or pair.truth.intrinsics is None:
        return None
    return pair.truth.intrinsics.focal_in_diagonals(size[1], size[0])
