"""What a run minimises: a weighted sum of losses."""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from flexdepth.losses import Loss
from flexdepth.sample import Prediction, Sample


@dataclass(frozen=True)
class Term:
    """One loss and its weight."""

    loss: Loss
    weight: float = 1.0


def objective(
    terms: Mapping[str, Term], prediction: Prediction, sample: Sample
) -> tuple[Tensor, dict[str, Tensor]]:
    """Return the weighted sum over terms of the mean over images, and each term's own mean.

    Raises:
        FloatingPointError: The sum is not finite; the terms are named with their values.
    """
    parts = {name: term.loss(prediction, sample).mean() for name, term in terms.items()}
    total = torch.stack([terms[name].weight * part for name, part in parts.items()]).sum()
    if not torch.isfinite(total):
        shown = ", ".join(f"{name} {float(part):g}" for name, part in parts.items())
        raise FloatingPointError(f"the objective is not finite; its terms are: {shown}")
    return total, {name: part.detach() for name, part in parts.items()}
