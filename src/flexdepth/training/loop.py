"""The training loop."""

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import torch
from torch import nn
from torch.optim import AdamW

from flexdepth.training.averaging import follow
from flexdepth.training.batches import Batches, BatchSettings, Pairs, loader
from flexdepth.training.checkpoint import (
    Checkpoint,
    optimiser_tensors,
    restore,
    restore_optimiser,
)
from flexdepth.training.objective import Term, objective
from flexdepth.training.optimiser import OptimiserSettings, set_rate
from flexdepth.training.record import Record
from flexdepth.training.validation import validate


@dataclass(frozen=True)
class LoopSettings:
    """How long, how often, how many.

    Attributes:
        iterations: Steps of the optimiser in the whole run.
        save_every: Iterations between checkpoints and validations.
        average_decay: Share of the averaged weights that stays at each iteration.
        batches: How batches are made.
        optimiser: How weights move.
    """

    iterations: int = 4000
    save_every: int = 250
    average_decay: float = 0.998
    batches: BatchSettings = field(default_factory=BatchSettings)
    optimiser: OptimiserSettings = field(default_factory=OptimiserSettings)


@dataclass(eq=False)
class Run:
    """The moving parts of a run."""

    network: nn.Module
    average: nn.Module
    optimiser: AdamW
    iteration: int

    @classmethod
    def started(cls, network: nn.Module, settings: LoopSettings) -> "Run":
        """Return a run at iteration 0."""
        return cls(network, copy.deepcopy(network), settings.optimiser.build(network), 0)

    def resume(self, found: Checkpoint, where: str) -> None:
        """Go on from a checkpoint; `where` is the file it was read from, for messages."""
        restore(self.network, found.part("network"), where)
        restore(self.average, found.part("average"), where)
        restore_optimiser(self.optimiser, found.part("optimiser"))
        self.iteration = found.iteration

    def checkpoint(self, settings: Mapping[str, Any]) -> Checkpoint:
        """Return everything that `resume` needs."""
        parts = {
            "network": self.network.state_dict(),
            "average": self.average.state_dict(),
            "optimiser": optimiser_tensors(self.optimiser),
        }
        tensors = {f"{part}.{k}": v for part, named in parts.items() for k, v in named.items()}
        return Checkpoint(self.iteration, settings, tensors)


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
    record: Record,
    save: Callable[[Run, float], None],
) -> None:
    """Train from the run's iteration to the last one.

    Args:
        run: Is moved forward.
        settings: How long and how.
        terms: What is minimised.
        sources: Where pairs come from.
        record: Is told the terms of every iteration and the score of every validation.
        save: Is given the run and its score every `save_every` iterations and at the end.

    Raises:
        FloatingPointError: The objective is not finite.
    """
    batches = Batches(sources.training, settings.batches, settings.iterations)
    for batch in loader(batches, run.iteration, sources.processes):
        set_rate(run.optimiser, settings.optimiser.rate_at(run.iteration, settings.iterations))
        run.network.train()
        image = batch.key.image.contiguous(memory_format=torch.channels_last)
        total, parts = objective(terms, run.network(image), batch)
        run.optimiser.zero_grad(set_to_none=True)
        total.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(run.network.parameters(), settings.optimiser.largest_gradient)
        run.optimiser.step()
        follow(run.average, run.network, run.iteration, settings.average_decay)
        run.iteration += 1
        record.iteration(run.iteration, {"total": total.detach(), **parts})
        if run.iteration % settings.save_every == 0 or run.iteration == settings.iterations:
            score = validate(run.average, sources.held_out)
            record.score(run.iteration, score)
            save(run, score)
