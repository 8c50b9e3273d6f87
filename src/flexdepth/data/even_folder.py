"""A folder whose images of rare distances are seen more often.

Among photos, or scenes made to look like them, most are of things two to five metres off. What is
learnt from them as they come takes what it does not know, a face of a thing close by or a far
coast, for something in the middle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from flexdepth.data.folder import Folder, FolderPairs, Pair
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.errors import InputError

_STEP, _WIDTH = 0.05, 0.2
"""The width of a bin of ln distance, and of the kernel by which the density is smoothed."""


@dataclass(frozen=True)
class EvenFolder:
    """Images and depth files in one folder, those at rare distances several times.

    An image's distance is the median of its depth, by the focal length at which it was taken: how
    far things are that look as large. When this is loaded, each depth file is read once.

    Attributes:
        root: As of `Folder`.
        part: Likewise.
        power: 0 gives each image once; with 1 all distances are as frequent, up to `most`.
        most: How many times one image is given at most.
    """

    root: Path = Path()
    part: Literal["all", "first", "last"] = "all"
    power: float = 0.8
    most: float = 4.0

    def __post_init__(self) -> None:
        """Refuse what is no share and no number of times."""
        if not (0 <= self.power <= 1 and 1 <= self.most < np.inf):
            raise InputError(
                f"wanted a power from 0 to 1 and a finite most >= 1, got {self.power:g} and "
                f"{self.most:g}"
            )

    def load(self) -> "RepeatedPairs":
        """Return the pairs, sorted by name, each as often in a row as it is to be seen.

        Raises:
            InputError: As of `Folder.load`, or a depth file is broken or no metric depth with a
                camera.
        """
        pairs = Folder(self.root, self.part).load()
        distance = np.array([_ln_distance(pairs.truth(k)) for k in range(len(pairs))])
        return RepeatedPairs(pairs, _repeated(times_seen(distance, self.power, self.most)))


@dataclass(frozen=True)
class RepeatedPairs:
    """Pairs by number, of which some come several times.

    Attributes:
        pairs: Each once.
        numbers: Which of them comes at each place.
    """

    pairs: FolderPairs
    numbers: Sequence[int]

    def __len__(self) -> int:
        """Return how many there are, repeated ones counted each time."""
        return len(self.numbers)

    def __getitem__(self, index: int) -> Pair:
        """Return one pair.

        Raises:
            InputError: As of `FolderPairs`.
        """
        return self.pairs[self.numbers[index]]


def times_seen(distance: NDArray[np.float64], power: float, most: float) -> NDArray[np.float64]:
    """Return how many times each image is to be seen: once where distances are most frequent.

    Elsewhere it is (highest density / density)^power, and `most` at most.

    Args:
        distance: The logarithm of each image's distance; NaN, for what has none, is seen once.
        power: 0 to 1.
        most: At least 1.
    """
    known = np.isfinite(distance)
    times = np.ones(len(distance))
    if not known.any():
        return times
    first = distance[known].min() - 4 * _WIDTH
    bins = np.floor((distance[known] - first) / _STEP).astype(np.int64)
    counts = np.bincount(bins, minlength=int(bins.max()) + 1).astype(np.float64)
    density = gaussian_filter1d(counts, _WIDTH / _STEP, mode="constant")[bins]
    times[known] = np.minimum((density.max() / density) ** power, most)
    return times


def _ln_distance(truth: DepthMap) -> float:
    """Return the logarithm of the median of depth over focal length; NaN where none is known."""
    depth = truth.values[np.isfinite(truth.values) & (truth.values > 0)]
    if not depth.size or truth.intrinsics is None:
        return np.nan
    height, width = truth.values.shape
    return float(np.log(np.median(depth) / truth.intrinsics.focal_by_area(width, height)))


def _repeated(times: NDArray[np.float64]) -> tuple[int, ...]:
    """Return each number so many times in a row; fractions are carried on to the next."""
    ends = np.floor(np.cumsum(times) + 0.5).astype(np.int64)
    return tuple(np.repeat(np.arange(len(times)), np.diff(ends, prepend=0)).tolist())
