"""What a run minimises: a weighted sum of losses."""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from flexdepth.losses import Loss
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction, Sample


@dataclass(frozen=True)
class Term:
    """One loss and its weight."""

    loss: Loss
    weight: float = 1.0


def objective(
    terms: Mapping[str, Term], prediction: Prediction, sample: Sample
) -> tuple[Tensor, dict[str, Tensor]]:
    """Return the weighted sum over terms of the mean over images, and each term's own mean."""
    parts = {name: term.loss(prediction, sample).mean() for name, term in terms.items()}
    total = torch.stack([terms[name].weight * part for name, part in parts.items()]).sum()
    return total, {name: part.detach() for name, part in parts.items()}


class DivergedError(InputError):
    """The objective has ceased to be finite."""


def check_finite(parts: Mapping[str, Tensor], iteration: int) -> None:
    """Refuse an objective that says nothing.

    Args:
        parts: The terms and their sum.
        iteration: How many iterations went well.

    Raises:
        DivergedError: One of them is not finite; all are named with their values.
    """
    if not torch.stack(list(parts.values())).isfinite().all():
        shown = ", ".join(f"{name} {float(part):g}" for name, part in parts.items())
        raise DivergedError(
            f"the objective is not finite after {iteration} iterations: {shown}; lower the "
            f"optimiser's rate, or look for images whose depth is wrong"
        )
