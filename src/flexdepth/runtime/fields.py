"""The fields of a record that a user has written: each checked, and named where it is wrong."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import Any

from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class Field:
    """What fits a field, in words too, and its value where it is absent; `...` is refused."""

    fits: Callable[[Any], bool]
    wanted: str
    default: object = ...


def checked(record: object, where: str, file: Path, known: Mapping[str, Field]) -> dict[str, Any]:
    """Return the fields of a part of a card, each checked."""
    if not isinstance(record, dict):
        part = f"`{where.rstrip('.')}`" if where else "a card"
        raise InputError(f"{file}: {part}: wanted fields (name: value), got {str(record)[:40]!r}")
    unknown = [name for name in record if name not in known]
    if unknown:
        raise InputError(
            f"{file}: `{where}{unknown[0]}`: no such field; wanted some of {', '.join(known)}"
        )
    found = {}
    for name, field in known.items():
        if name not in record and field.default is not ...:
            found[name] = field.default
        elif name in record and field.fits(record[name]):
            found[name] = record[name]
        else:
            got = repr(record[name])[:60] if name in record else "nothing"
            raise InputError(f"{file}: `{where}{name}`: wanted {field.wanted}, got {got}")
    return found


def is_text(value: object) -> bool:
    """Return whether it is a line of text."""
    return isinstance(value, str) and bool(value) and value.isprintable()


def is_number(value: object) -> bool:
    """Return whether it is a finite number."""
    return type(value) in (int, float) and isfinite(value)  # type: ignore[arg-type]


def is_positive(value: Any) -> bool:  # noqa: ANN401
    """Return whether it is a finite number > 0."""
    return is_number(value) and value > 0


def list_of(count: int, fits: Callable[[Any], bool]) -> Callable[[Any], bool]:
    """Return what says whether a value is a list of `count` values that fit."""
    return lambda value: isinstance(value, list) and len(value) == count and all(map(fits, value))


def one_of(kind: type[StrEnum]) -> tuple[Callable[[Any], bool], str]:
    """Return what says whether a value is a name of `kind`, and the names in words."""
    names = [str(each) for each in kind]
    return (lambda value: value in names), f"one of {', '.join(names)}"
