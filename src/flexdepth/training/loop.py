"""The training loop.

With the same number of processes a run ends with the same bits on the CPU, wherever it was
interrupted. N processes, or a batch in N parts, give the weights of one process on the whole
batch, up to rounding, for terms that are a mean over images. Two things see only the images that
pass the network together: batch normalisation, whose running statistics are the mean of the
processes', and terms that are a mean over the pixels or triangles of a batch.
"""

import copy
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any, Literal

import torch
from torch import Tensor, nn
from torch.optim import Optimizer

from flexdepth.evaluation.alignment import Alignment
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Sample
from flexdepth.tensors import mapped, moved
from flexdepth.training.averaging import follow
from flexdepth.training.batches import Batches, BatchSettings, Pairs, divided, loader
from flexdepth.training.checkpoint import (
    Checkpoint,
    optimiser_tensors,
    restore,
    restore_optimiser,
)
from flexdepth.training.objective import Term, check_finite, objective
from flexdepth.training.optimiser import AdamWCosine, Optimiser, set_rate
from flexdepth.training.processes import ALONE, Place
from flexdepth.training.record import Listener
from flexdepth.training.validation import SCORES, validate


@dataclass(frozen=True)
class LoopSettings:
    """How long, how often, how many.

    Attributes:
        iterations: Steps of the optimiser in the whole run.
        save_every: Iterations between checkpoints and validations.
        patience: Validations in a row without a lower held-out error after which a run ends, if
            any. The rate does not know of such an end: it falls towards the last of `iterations`,
            and a run that ends before has not had its lowest rates.
        average_decay: Share of the averaged weights that stays at each iteration.
        batches: How batches are made.
        optimiser: How weights move.
        alignment: How held-out depth is fitted to its truth before it is scored: not at all for
            metres, up to what the pictures cannot tell where their cameras differ.
        accumulate: Parts of a batch that pass the network one after another, to save memory.
        precision: What the network computes in; weights, losses and gradients are float32.
        learns: The parts of the network that learn, by name; all where none is named. The others
            stay as they are, the statistics of their normalisation too.
    """

    iterations: int = 4000
    save_every: int = 250
    patience: int | None = None
    average_decay: float = 0.998
    batches: BatchSettings = field(default_factory=BatchSettings)
    optimiser: Optimiser = field(default_factory=AdamWCosine)
    alignment: Alignment = Alignment.LEAST_SQUARES_DISPARITY
    accumulate: int = 1
    precision: Literal["float32", "bfloat16"] = "float32"
    learns: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a run of nothing."""
        if min(self.iterations, self.save_every, self.accumulate) < 1:
            raise InputError(
                f"iterations, save_every and accumulate are whole numbers >= 1, "
                f"got {self.iterations}, {self.save_every} and {self.accumulate}"
            )
        if self.patience is not None and self.patience < 1:
            raise InputError(f"patience is a whole number >= 1 or none, got {self.patience}")
        if not 0 <= self.average_decay < 1:
            raise InputError(f"average_decay lies in [0, 1), got {self.average_decay:g}")

    def goes_on_with(self, asked: "LoopSettings", errors: Sequence[float]) -> bool:
        """Return whether a run with these settings may go on with those that are asked for.

        Another patience changes no step of a run, only where it ends. More iterations change the
        rate: they are for a run that has ended by its patience.

        Args:
            asked: Other settings.
            errors: Held out, of every validation of the run, in order.
        """
        ended = out_of_patience(errors, self.patience) and asked.iterations > self.iterations
        iterations = asked.iterations if ended else self.iterations
        return replace(self, patience=asked.patience, iterations=iterations) == asked


@dataclass(eq=False)
class Run:
    """The moving parts of a run, in one of the processes that train together.

    Attributes:
        network: Takes the steps.
        average: Follows it.
        optimiser: Of the network's weights.
        iteration: How many are done.
        place: Which of the processes this is.
        errors: Held out, of every validation so far, in order; the same in all processes.
    """

    network: nn.Module
    average: nn.Module
    optimiser: Optimizer
    iteration: int
    place: Place
    errors: list[float] = field(default_factory=list)

    @classmethod
    def started(cls, network: nn.Module, settings: LoopSettings, place: Place = ALONE) -> "Run":
        """Return a run at iteration 0.

        Raises:
            InputError: The network has no part of a name that is to learn.
        """
        network = network.to(place.device)
        if settings.learns:
            network.requires_grad_(False)
        for part in named_parts(network, settings.learns):
            part.requires_grad_(True)
        average, optimiser = copy.deepcopy(network), settings.optimiser.build(network)
        return cls(network, average, optimiser, 0, place)

    def resume(self, found: Checkpoint, where: str) -> None:
        """Go on from a checkpoint; `where` is the file it was read from, for messages."""
        restore(self.network, found.part("network"), where)
        restore(self.average, found.part("average"), where)
        restore_optimiser(self.optimiser, found.part("optimiser"))
        self.iteration, self.errors = found.iteration, list(found.errors)

    def checkpoint(self, settings: Mapping[str, Any], source: str = "") -> Checkpoint:
        """Return everything that `resume` needs, with the code that it comes from."""
        parts = {
            "network": self.network.state_dict(),
            "average": self.average.state_dict(),
            "optimiser": optimiser_tensors(self.optimiser),
        }
        tensors = {f"{part}.{k}": v for part, named in parts.items() for k, v in named.items()}
        return Checkpoint(self.iteration, settings, tensors, source, tuple(self.errors))


def out_of_patience(errors: Sequence[float], patience: int | None) -> bool:
    """Return whether so many validations in a row, the last among them, lowered no error."""
    lowest, since = inf, 0
    for error in errors:
        since = 0 if error < lowest else since + 1
        lowest = min(lowest, error)
    return patience is not None and since >= patience


@dataclass(frozen=True)
class Sources:
    """What a run learns from and is judged on, and how many processes read it."""

    training: Pairs
    held_out: Pairs
    processes: int = 1


def train(
    run: Run,
    settings: LoopSettings,
    terms: Mapping[str, Term],
    sources: Sources,
    record: Listener,
    save: Callable[[Run, float], None],
) -> None:
    """Train from the run's iteration to the last one, or to the end of patience.

    Args:
        run: Is moved forward.
        settings: How long and how.
        terms: What is minimised.
        sources: Where pairs come from.
        record: Is told the terms of every iteration and the scores of every validation.
        save: Is given the run and its error every `save_every` iterations and at the end.

    Raises:
        InputError: The batch does not divide, a pair cannot be read, or the objective is not
            finite.
    """
    place = run.place
    check_shares(settings, place)
    if out_of_patience(run.errors, settings.patience):
        return
    batches = Batches(
        sources.training, settings.batches, settings.iterations, place.rank, place.count
    )
    for batch in loader(batches, run.iteration, sources.processes):
        rate = settings.optimiser.rate_at(run.iteration, settings.iterations)
        set_rate(run.optimiser, rate)
        parts = learn(run.network, settings, terms, moved(batch, place.device))
        place.average([*gradients(run.network), *statistics(run.network), *parts.values()])
        check_finite(parts, run.iteration)
        nn.utils.clip_grad_norm_(run.network.parameters(), settings.optimiser.largest_gradient)
        run.optimiser.step()
        follow(run.average, run.network, run.iteration, settings.average_decay)
        run.iteration += 1
        record.iteration(run.iteration, rate, parts)
        if run.iteration % settings.save_every == 0 or run.iteration == settings.iterations:
            scores = validate(run.average, sources.held_out, settings.alignment, place)
            record.scores(run.iteration, scores)
            run.errors.append(scores[SCORES[0]])
            save(run, run.errors[-1])
            if out_of_patience(run.errors, settings.patience):
                return


def learn(
    network: nn.Module, settings: LoopSettings, terms: Mapping[str, Term], batch: Sample
) -> dict[str, Tensor]:
    """Give the network the gradients of the objective, and return its terms and their sum.

    Raises:
        InputError: No term depends on the parts that learn.
    """
    network.train(not settings.learns)
    for awake in named_parts(network, settings.learns):
        awake.train()
    network.zero_grad(set_to_none=True)
    sums = {name: batch.key.image.new_zeros(()) for name in ("total", *terms)}
    reduced = settings.precision == "bfloat16"
    for part in divided(batch, settings.accumulate):
        image = part.key.image.contiguous(memory_format=torch.channels_last)
        with torch.autocast(image.device.type, torch.bfloat16, enabled=reduced):
            prediction = network(image)
        total, parts = objective(terms, mapped(prediction, Tensor.float), part)
        if not total.requires_grad:
            raise InputError(
                f"loop.learns: none of the terms {', '.join(terms)} depends on "
                f"{', '.join(settings.learns)}"
            )
        (total / settings.accumulate).backward()  # type: ignore[no-untyped-call]
        for name, value in {"total": total.detach(), **parts}.items():
            sums[name] += value / settings.accumulate
    return sums


def named_parts(network: nn.Module, names: Iterable[str]) -> Iterator[nn.Module]:
    """Give the parts of a network of these names.

    Raises:
        InputError: It has no such part.
    """
    parts = dict(network.named_children())
    for name in names:
        if name not in parts:
            raise InputError(f"loop.learns: the network has no {name!r}, but {', '.join(parts)}")
        yield parts[name]


def gradients(network: nn.Module) -> Iterator[Tensor]:
    """Give the gradients of the weights that have any."""
    return (weight.grad for weight in network.parameters() if weight.grad is not None)


def statistics(network: nn.Module) -> Iterator[Tensor]:
    """Give the running statistics of batch normalisation."""
    for module in network.modules():
        if isinstance(module, nn.BatchNorm2d):
            yield from (x for x in (module.running_mean, module.running_var) if x is not None)


def check_shares(settings: LoopSettings, place: Place) -> None:
    """Refuse a batch that does not divide among the processes and the parts of each.

    Raises:
        InputError: It does not.
    """
    size, parts = settings.batches.size, place.count * settings.accumulate
    if size % parts:
        raise InputError(
            f"a batch of {size} does not divide into {parts} equal parts, {settings.accumulate} "
            f"for each of {place.count} processes; take a multiple of {parts}"
        )
