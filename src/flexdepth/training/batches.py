"""Batches by number: batch i of a run is a pure function of the run's settings and i.

That makes a resumed run see exactly what an uninterrupted one would have seen, whatever the
number of loading processes.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from operator import itemgetter
from typing import Protocol, runtime_checkable

import numpy as np
import torch
from torch.utils.data import DataLoader, Dataset

from flexdepth.data.colour import Colour
from flexdepth.data.folder import Pair
from flexdepth.data.recipes import Recipe
from flexdepth.data.transforms import Crop, as_sample
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Sample
from flexdepth.tensors import mapped, stacked


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
        shapes: Width and height of a batch's images; each batch takes one at random. Of about one
            area: how far a thing is is learnt for how many pixels it has (decision 018).
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

    def __post_init__(self) -> None:
        """Refuse batches of nothing."""
        sides = [side for shape in self.shapes for side in shape]
        if self.size < 1 or min(sides, default=0) < 1 or self.seed < 0:
            raise InputError(
                f"a batch needs a size >= 1, shapes of a width and a height >= 1 and a seed >= 0, "
                f"got size {self.size}, shapes {self.shapes} and seed {self.seed}"
            )


@dataclass(frozen=True)
class Batches(Dataset[Sample]):
    """The batches of a run; every pair is seen once before any is seen again.

    Attributes:
        pairs: What they are made of.
        settings: How.
        count: How many the run has.
        part: Which of the equal parts of each batch is given. All its samples are made even so,
            for one sequence of random numbers runs through them.
        parts: Into how many parts a batch is divided.
    """

    pairs: Pairs
    settings: BatchSettings
    count: int
    part: int = 0
    parts: int = 1

    def __len__(self) -> int:
        """Return the number of batches in the run."""
        return self.count

    def __getitem__(self, number: int) -> Sample:
        """Return batch `number`, or this part of it."""
        settings = self.settings
        rng = np.random.default_rng([settings.seed, 1, number])
        width, height = settings.shapes[int(rng.integers(len(settings.shapes)))]
        samples = []
        for index in self._members(number):
            pair = settings.crop(rng, self.pairs[index], width, height)
            lit = Pair(pair.name, settings.colour(rng, pair.image), pair.truth)
            samples.append(as_sample(lit))
        size = settings.size // self.parts
        own = samples[self.part * size : (self.part + 1) * size]
        return replace(stacked(own), draw=number)

    def _members(self, number: int) -> list[int]:
        """Return which pairs are in batch `number`: a stretch of endless shuffled rounds."""
        total, size = len(self.pairs), self.settings.size
        places = range(number * size, (number + 1) * size)
        orders = {
            turn: np.random.default_rng([self.settings.seed, 0, turn]).permutation(total)
            for turn in {place // total for place in places}
        }
        return [int(orders[place // total][place % total]) for place in places]


@dataclass(frozen=True)
class _Told(Dataset[Sample | InputError]):
    """Batches in which a mistake is a value.

    An exception that another process raises comes here with its traceback for a message.
    """

    batches: Batches

    def __len__(self) -> int:
        return len(self.batches)

    def __getitem__(self, number: int) -> Sample | InputError:
        try:
            return self.batches[number]
        except InputError as mistake:
            return mistake


def loader(batches: Batches, first: int, processes: int) -> Iterator[Sample]:
    """Give batches `first` to the last, made by other processes while the network computes.

    Raises:
        InputError: A pair cannot be read.
    """
    made = DataLoader(
        _Told(batches),
        sampler=range(first, len(batches)),
        batch_size=None,
        num_workers=processes,
        prefetch_factor=4 if processes else None,
        worker_init_fn=_single_threaded,
        # As in synth: a forked child can wait for ever for a thread that it does not have.
        multiprocessing_context="spawn" if processes else None,
    )
    for batch in made:
        if isinstance(batch, InputError):
            raise batch
        yield batch


def _single_threaded(_worker: int) -> None:
    torch.set_num_threads(1)


def divided(batch: Sample, parts: int) -> Iterator[Sample]:
    """Give the equal parts of a batch in order; `parts` divides its size."""
    size = len(batch.key.image) // parts
    for first in range(0, parts * size, size):
        rows = slice(first, first + size)
        yield replace(mapped(batch, itemgetter(rows)), name=batch.name[rows])
