"""Photos without depth, labelled by a trained model, to train a student on (section 2.3.3).

The teacher looks at a photo three times: as it is, in a mirror, and smaller. Where the looks agree
their mean is the label; where they do not the teacher is not sure, and there is no label. A depth
file says so by NaN, and what is unknown touches no loss: the student is trained on labels as on
measured depth.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import log, sqrt
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float
from PIL import Image
from torch import Tensor, nn
from torch.nn.functional import interpolate

from flexdepth.data.folder import Pair
from flexdepth.geometry.camera import Camera
from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth
from flexdepth.runtime.images import Photo, photos_in, read_photo
from flexdepth.runtime.lens import Said, intrinsics
from flexdepth.runtime.sizes import resized
from flexdepth.sample import Frame, Prediction, Sample, in_metres
from flexdepth.tensors import stacked
from flexdepth.training.batches import Pairs


@dataclass(frozen=True)
class Agreement:
    """When a teacher is sure.

    Attributes:
        ratio: The largest factor by which the depths of two looks at a pixel may differ.
        smaller: The side of the smaller look by that of the photo's; 1 leaves it out.
        area: Pixels at which the teacher looks at a photo.
        multiple: The sides of what it sees are multiples of this.
    """

    ratio: float = 1.1
    smaller: float = 0.75
    area: int = 384 * 288
    multiple: int = 32

    def __post_init__(self) -> None:
        """Refuse what nothing agrees with.

        Raises:
            InputError: A number is out of its range.
        """
        if not (self.ratio > 1 and 0 < self.smaller <= 1 and self.area >= self.multiple**2 > 0):
            raise InputError(
                f"agreement needs ratio > 1, 0 < smaller <= 1 and an area of at least one "
                f"multiple squared, got {self}"
            )


@dataclass(frozen=True, eq=False)
class Label:
    """What a teacher says of a photo.

    Attributes:
        depth: In the teacher's units, the geometric mean of its looks.
        sure: Where the looks agree in depth.
        sky: Where all of them see sky; nowhere for a teacher that does not tell sky.
        prediction: The first look, which says the units.
    """

    depth: Float[Tensor, "height width"]
    sure: Bool[Tensor, "height width"]
    sky: Bool[Tensor, "height width"]
    prediction: Prediction


@torch.no_grad()
def label(
    teacher: nn.Module, image: Float[Tensor, "3 height width"], agreement: Agreement
) -> Label:
    """Return what a teacher says of an image, and where it is sure.

    Depth at two looks agrees where the larger is at most `ratio` times the smaller. A pixel that
    some looks take for sky and others not is neither.

    Args:
        teacher: In evaluation mode.
        image: RGB in [0, 1], of sides that the teacher takes.
        agreement: When it is sure.
    """
    height, width = image.shape[-2:]
    looks = _looks(teacher, image[None], agreement)
    depths = torch.stack([_at(each.depth, height, width).log() for each in looks])
    sure = depths.amax(0) - depths.amin(0) <= log(agreement.ratio)
    depth, first = depths.mean(0).exp(), looks[0]
    logits = [each.sky_logit for each in looks if each.sky_logit is not None]
    if not logits:
        return Label(depth, sure, torch.zeros_like(sure), first)
    sky = torch.stack([_at(logit, height, width) > 0 for logit in logits])
    return Label(depth, sure & ~sky.any(0), sky.all(0), first)


def _looks(
    teacher: nn.Module, image: Float[Tensor, "1 3 height width"], agreement: Agreement
) -> list[Prediction]:
    """Return what the teacher makes of the image, of its mirror image and of a smaller one."""
    turned = teacher(image.flip(-1))
    logit = turned.sky_logit
    back = replace(
        turned, depth=turned.depth.flip(-1), sky_logit=None if logit is None else logit.flip(-1)
    )
    looks = [teacher(image), back]
    if agreement.smaller < 1:
        multiple = agreement.multiple
        size = [
            max(1, round(side * agreement.smaller / multiple)) * multiple
            for side in image.shape[-2:]
        ]
        looks.append(teacher(interpolate(image, size=size, mode="area")))
    return looks


def _at(values: Float[Tensor, "1 _ _"], height: int, width: int) -> Float[Tensor, "height width"]:
    if values.shape[-2:] == (height, width):
        return values[0]
    return interpolate(values[:, None], size=(height, width), mode="bilinear")[0, 0]


def unlabelled_photos(folder: Path) -> list[Path]:
    """Return the photos in a folder, by name; not those below it, for labels have their names.

    Raises:
        InputError: There is no such folder, or no photo in it.
    """
    return photos_in(folder, "*")


def write_labels(
    teacher: nn.Module,
    photos: Sequence[Path],
    folder: Path,
    agreement: Agreement,
    show: Callable[[str], None],
) -> None:
    """Label photos, and leave pairs that `data.Folder` reads.

    FOLDER/image/NAME.png is the photo at the size at which the teacher sees it, and
    FOLDER/depth/NAME.npz its label in metres: +inf is sky, NaN where the teacher is not sure. A
    photo that does not say its focal length has the one that the teacher sees in it, or else the
    assumed one of `flexdepth predict`. Photos of which nothing is sure are left out.

    Args:
        teacher: In evaluation mode.
        photos: Of one folder: their names are different.
        folder: Gets `image` and `depth`.
        agreement: When the teacher is sure.
        show: Is told how it goes.

    Raises:
        InputError: A photo cannot be read, a file cannot be written, or nothing is sure.
    """
    sure, labelled = 0.0, 0
    for number, path in enumerate(photos, 1):
        pair = _labelled(teacher, path, agreement)
        share = float(np.mean(~np.isnan(pair.truth.values)))
        sure += share
        if share:
            labelled += 1
            write_depth(folder / "depth" / f"{path.stem}.npz", pair.truth)
            with replacing(folder / "image" / f"{path.stem}.png") as temporary:
                Image.fromarray(pair.image).save(temporary)
        if number % 100 == 0:
            show(f"{number}/{len(photos)} photos labelled")
    if not labelled:
        raise InputError(
            f"the teacher is sure of nothing in {len(photos)} photos: allow a larger "
            f"--agreement than {agreement.ratio:g}, or take another teacher"
        )
    show(
        f"{labelled} of {len(photos)} photos labelled, at {sure / len(photos):.0%} of their pixels"
    )


def _labelled(teacher: nn.Module, path: Path, agreement: Agreement) -> Pair:
    photo = read_photo(path)
    pixels = resized(photo.pixels, _size(photo, agreement))
    height, width = pixels.shape[:2]
    image = torch.from_numpy(pixels).permute(2, 0, 1).float() / 255
    said = label(teacher, image, agreement)
    seen = said.prediction.focal
    told = Said(photo.focal_in_diagonals, None if seen is None else float(seen[0]))
    camera = intrinsics(width, height, None, told)
    sample = Sample((path.stem,), Frame(image[None], stacked([Camera.of(camera)])), None)
    metres = in_metres(said.depth[None], said.prediction, sample)[0]
    values = metres.where(said.sure, torch.nan).where(~said.sky, torch.inf)
    return Pair(path.stem, pixels, DepthMap(values.numpy(), Space.METRIC, camera))


def _size(photo: Photo, agreement: Agreement) -> tuple[int, int]:
    """Return width and height at which the teacher sees a photo."""
    height, width = photo.pixels.shape[:2]
    scale = sqrt(agreement.area / (width * height)) / agreement.multiple
    across, down = (max(1, round(scale * side)) * agreement.multiple for side in (width, height))
    return across, down


@dataclass(frozen=True)
class Joined:
    """The pairs of two sets, one after the other.

    Attributes:
        first: Measured.
        second: Labelled.
    """

    first: Pairs
    second: Pairs

    def __len__(self) -> int:
        """Return how many both have."""
        return len(self.first) + len(self.second)

    def __getitem__(self, index: int) -> Pair:
        """Return one pair."""
        own = len(self.first)
        return self.first[index] if index < own else self.second[index - own]
