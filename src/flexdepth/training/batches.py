"""Batches by number: batch i of a run is a pure function of the run's settings and i.

That makes a resumed run see exactly what an uninterrupted one would have seen, whatever the
number of loading processes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, runtime_checkable

import numpy as np
import torch
from torch.utils.data import DataLoader, Dataset

from flexdepth.data.folder import Pair
from flexdepth.data.recipes import Recipe
from flexdepth.data.transforms import Colour, Crop, as_sample
from flexdepth.sample import Sample
from flexdepth.tensors import stacked


@runtime_checkable
class Pairs(Protocol):
    """Pairs of image and depth by number."""

    def __len__(self) -> int:
        """Return how many there are."""
        ...

    def __getitem__(self, index: int) -> Pair:
        """Return one."""
        ...


@dataclass(frozen=True)
class BatchSettings:
    """How batches are made.

    Attributes:
        size: Samples in a batch.
        shapes: Width and height of a batch's images; each batch takes one at random.
        crop: What part of an image is seen.
        colour: In which light.
        seed: Of order, crops and colours.
    """

    size: int = 8
    shapes: tuple[tuple[int, int], ...] = (
        (256, 192),
        (256, 192),
        (224, 224),
        (320, 160),
        (384, 128),
    )
    crop: Recipe = field(default_factory=Crop)
    colour: Colour = field(default_factory=Colour)
    seed: int = 0


@dataclass(frozen=True)
class Batches(Dataset[Sample]):
    """The batches of a run; every pair is seen once before any is seen again."""

    pairs: Pairs
    settings: BatchSettings
    count: int

    def __len__(self) -> int:
        """Return the number of batches in the run."""
        return self.count

    def __getitem__(self, number: int) -> Sample:
        """Return batch `number`."""
        settings = self.settings
        rng = np.random.default_rng([settings.seed, 1, number])
        width, height = settings.shapes[int(rng.integers(len(settings.shapes)))]
        samples = []
        for index in self._members(number):
            pair = settings.crop(rng, self.pairs[index], width, height)
            lit = Pair(pair.name, settings.colour(rng, pair.image), pair.truth)
            samples.append(as_sample(lit))
        return replace(stacked(samples), draw=number)

    def _members(self, number: int) -> list[int]:
        """Return which pairs are in batch `number`: a stretch of endless shuffled rounds."""
        total, size = len(self.pairs), self.settings.size
        places = range(number * size, (number + 1) * size)
        orders = {
            turn: np.random.default_rng([self.settings.seed, 0, turn]).permutation(total)
            for turn in {place // total for place in places}
        }
        return [int(orders[place // total][place % total]) for place in places]


def loader(batches: Batches, first: int, processes: int) -> DataLoader[Sample]:
    """Return batches `first` to the last, made by other processes while the network computes."""
    return DataLoader(
        batches,
        sampler=range(first, len(batches)),
        batch_size=None,
        num_workers=processes,
        prefetch_factor=4 if processes else None,
        worker_init_fn=_single_threaded,
        # As in synth: a forked child can wait for ever for a thread that it does not have.
        multiprocessing_context="spawn" if processes else None,
    )


def _single_threaded(_worker: int) -> None:
    torch.set_num_threads(1)


def whole(pairs: Pairs, indices: Sequence[int]) -> Sample:
    """Return pairs of one size, uncropped and in their own light, as a batch."""
    return stacked([as_sample(pairs[index]) for index in indices])
