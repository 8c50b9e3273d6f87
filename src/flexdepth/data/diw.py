"""Depth in the Wild: photos with one pair of points each, of which one is farther, as published.

    ROOT/DIW_test.csv       two lines a photo:
                            ./DIW_test/d5dd2e6d4c5d6f4f.thumb
                            yA,xA,yB,xB,>,WIDTH,HEIGHT      > where A is farther, counted from 1
    ROOT/DIW_test/NAME.thumb                                a JPEG
    ROOT/DIW_train_val/NAME.thumb

Training and validation share a folder. Pairs that the annotators could not tell apart are not
published. `relative_depth`'s own copies of the lists begin with a line more and are refused.

References:
    Chen, Fu, Yang and Deng, NeurIPS 2016. That > means that A is farther is how the readers of its
    authors' later work (YouTube3D, OASIS) and of those who score WHDR on it take it.
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from pathlib import Path

from flexdepth.data.text_files import parsed, text_of
from flexdepth.data.views import Listed, OrdinalPair
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import read_photo


class DiwSplit(StrEnum):
    """A published part of the set."""

    TRAIN = "train"
    VAL = "val"
    TEST = "test"


@dataclass(frozen=True)
class Diw:
    """Photos with one ordinal pair each.

    Attributes:
        root: The folder that holds the lists and the folders they name.
        split: Which list.
    """

    root: Path = Path()
    split: DiwSplit = DiwSplit.TEST

    def load(self) -> Listed[OrdinalPair]:
        """Return the pairs, in the order of the list.

        Raises:
            InputError: The list or a photo is missing, or a line is no pair of points.
        """
        path = self.root / f"DIW_{self.split}.csv"
        lines = [line.strip() for line in text_of(path, "a list of DIW").splitlines()]
        lines = [line for line in lines if line]
        if not lines or len(lines) % 2:
            raise InputError(
                f"{path}: wanted two lines a photo, its name and its points, got {len(lines)} lines"
            )
        return Listed(
            tuple(
                self._reader(lines[n], lines[n + 1], f"{path}, line {n + 2}")
                for n in range(0, len(lines), 2)
            )
        )

    def _reader(self, name: str, points: str, where: str) -> partial[OrdinalPair]:
        image, words = self.root / name, points.split(",")
        if len(words) != 7 or words[4] not in ("<", ">"):
            raise InputError(f"{where}: wanted yA,xA,yB,xB,>,WIDTH,HEIGHT, got {points!r}")
        if not image.is_file():
            raise InputError(f"{where}: looked for {image}; there is no such file")
        numbers = parsed((*words[:4], *words[5:]), 6, f"{where}: wanted points and a size")
        row_a, column_a, row_b, column_b, width, height = map(round, numbers)
        pair = ((column_a - 1, row_a - 1), (column_b - 1, row_b - 1))
        farther, nearer = pair if words[4] == ">" else pair[::-1]
        return partial(ordinal_pair, image, farther, nearer, (width, height))


def ordinal_pair(
    path: Path, farther: tuple[int, int], nearer: tuple[int, int], size: tuple[int, int]
) -> OrdinalPair:
    """Return a photo and its points.

    Raises:
        InputError: The photo is damaged, of another size than its list says, or too small.
    """
    image = read_photo(path).pixels
    height, width = image.shape[:2]
    inside = all(0 <= x < width and 0 <= y < height for x, y in (farther, nearer))
    if (width, height) != size or not inside:
        raise InputError(
            f"{path}: has {width}x{height} pixels, but its list says {size[0]}x{size[1]} and the "
            f"points (column, row) {farther} and {nearer}; take the files as they are published"
        )
    return OrdinalPair(path.stem, image, farther, nearer)
