"""Frozen dataclasses of tensors, taken as a whole: moved to a device, stacked to a batch.

A record may hold tensors, other records, tuples of these, None, and plain values such as names.
"""

from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeVar

import torch
from torch import Tensor

Record = TypeVar("Record")


def mapped(record: Record, change: Callable[[Tensor], Tensor]) -> Record:
    """Return the record with `change` applied to every tensor in it."""
    same: Record = _merged([record], lambda tensors: change(tensors[0]), lambda values: values[0])
    return same


def moved(record: Record, device: torch.device | str) -> Record:
    """Return the record with every tensor on `device`."""
    return mapped(record, lambda tensor: tensor.to(device, non_blocking=True))


def stacked(records: Sequence[Record]) -> Record:
    """Return the records as one, with a new leading dimension; a name becomes a tuple of names.

    Raises:
        ValueError: If there are none, or if they are not of one make: one has what another lacks.
    """
    if not records:
        raise ValueError("a batch needs at least one record, got none")
    batch: Record = _merged(records, lambda tensors: torch.stack(list(tensors)), tuple)
    return batch


def _merged(
    records: Sequence[Any],
    join: Callable[[Sequence[Tensor]], Tensor],
    join_values: Callable[[Sequence[Any]], Any],
) -> Any:  # noqa: ANN401
    first = records[0]
    if any(type(record) is not type(first) for record in records):
        raise ValueError(f"records of one make were wanted, got {[type(r) for r in records]}")
    if isinstance(first, Tensor):
        return join(records)
    if is_dataclass(first) and not isinstance(first, type):
        names = [field.name for field in fields(first)]
        columns = {n: [getattr(record, n) for record in records] for n in names}
        return replace(first, **{n: _merged(c, join, join_values) for n, c in columns.items()})
    if isinstance(first, tuple):
        return tuple(_merged(c, join, join_values) for c in zip(*records, strict=True))
    return first if first is None else join_values(records)
