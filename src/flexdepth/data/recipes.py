"""What part of an image is seen in training, and at which size: one setting for each recipe.

Chapter 3 resizes an image by a random ratio r and divides its depth by r, as if the camera stayed
and the world shrank: the focal length grows with the image, by r, and the planes keep their
normals. Its crops are 384x384 (NYU) and 512 wide by 384 high (KITTI).
"""

from dataclasses import dataclass

from numpy.random import Generator

from flexdepth.data.folder import Pair
from flexdepth.data.transforms import Crop, cropped, mirrored, padded, resized, shrunk


@dataclass(frozen=True)
class NyuCrop:
    """A part anywhere in the image, resized by one of the ratios, mirrored half of the time.

    An image too small for its crop gets grey on top and on its left, where depth is unknown.

    Attributes:
        ratios: Each is as likely as the others; the depth is divided by it.
    """

    ratios: tuple[float, ...] = (1.0, 0.92, 0.86, 0.8, 0.75, 0.7, 0.67)

    def __call__(self, rng: Generator, pair: Pair, width: int, height: int) -> Pair:
        """Return the pair at `width` by `height`."""
        return _part(rng, pair, (width, height), self.ratios, 0)


@dataclass(frozen=True)
class KittiCrop:
    """A part below the sky, resized by one of the ratios, mirrored half of the time.

    An image too small for its crop gets grey on top and on its left, where depth is unknown.

    Attributes:
        ratios: Each is as likely as the others; the depth is divided by it.
        skipped_rows: The crop starts at this row of the image or below it; where that leaves too
            few rows, it starts at the first.
    """

    ratios: tuple[float, ...] = (1.0, 1.1, 1.2, 1.3, 1.4, 1.5)
    skipped_rows: int = 50

    def __call__(self, rng: Generator, pair: Pair, width: int, height: int) -> Pair:
        """Return the pair at `width` by `height`."""
        return _part(rng, pair, (width, height), self.ratios, self.skipped_rows)


Recipe = Crop | NyuCrop | KittiCrop
"""The setting of any recipe here: (generator, pair, width, height) -> the pair at that size."""


def _part(
    rng: Generator,
    pair: Pair,
    size: tuple[int, int],
    ratios: tuple[float, ...],
    skipped_rows: int,
) -> Pair:
    ratio = ratios[int(rng.integers(len(ratios)))]
    across, down = (max(1, round(side / ratio)) for side in size)
    rows, columns = pair.truth.values.shape
    whole = padded(pair, max(0, across - columns), max(0, down - rows))
    rows, columns = whole.truth.values.shape
    left, room = int(rng.integers(columns - across + 1)), rows - down
    top = int(rng.integers(skipped_rows, room + 1)) if room >= skipped_rows else 0
    # Cutting before resizing gives the same pixels for a fraction of the work.
    seen = shrunk(resized(cropped(whole, (left, top, across, down)), *size), ratio)
    return mirrored(seen) if rng.random() < 0.5 else seen
