"""Calibrations, poses and tables that sets publish as text."""

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from flexdepth.runtime.errors import InputError

_ERRORS = (ValueError, TypeError, KeyError, IndexError, OverflowError)


def text_of(path: Path, what: str) -> str:
    """Return what a text file holds.

    Args:
        path: The file.
        what: What it should hold, for the message: "a pose".

    Raises:
        InputError: It is missing, or no text.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file; wanted {what}")
    try:
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: wanted {what}, this cannot be read as text ({error})") from error


def numbers_of(path: Path, count: int, what: str) -> tuple[float, ...]:
    """Return the numbers in a text file.

    Args:
        path: The file.
        count: How many there should be.
        what: What they are, for the message.

    Raises:
        InputError: It is missing, or holds something else or another count.
    """
    return parsed(text_of(path, what).split(), count, f"{path}: wanted {what}")


def parsed(words: Sequence[str], count: int, wanted: str) -> tuple[float, ...]:
    """Return words as numbers.

    Args:
        words: As they stand in the file.
        count: How many there should be.
        wanted: The start of the message: where, and what.

    Raises:
        InputError: There are more or fewer, or some are no numbers.
    """
    try:
        numbers = tuple(map(float, words))
    except ValueError as error:
        raise InputError(f"{wanted}, {count} numbers ({error})") from error
    if len(numbers) != count:
        raise InputError(f"{wanted}, {count} numbers, got {len(numbers)}")
    return numbers


def fields_of(path: Path, what: str, separator: str = ":") -> dict[str, list[str]]:
    """Return the words of each `NAME: ...` line of a calibration, by name.

    Raises:
        InputError: It is missing or no text.
    """
    pairs = (line.partition(separator) for line in text_of(path, what).splitlines())
    return {name.strip(): rest.split() for name, sign, rest in pairs if sign}


def rows_of(path: Path, what: str, columns: Sequence[str]) -> list[Mapping[str, str]]:
    """Return the rows of a table with a header, separated by commas.

    Raises:
        InputError: It is missing, or lacks one of the columns.
    """
    rows: list[Mapping[str, str]] = list(csv.DictReader(text_of(path, what).splitlines()))
    if not rows or any(row.get(column) is None for column in columns for row in rows):
        raise InputError(f"{path}: wanted {what}, a table with the columns {', '.join(columns)}")
    return rows


def record_of(path: Path, what: str) -> Mapping[str, object]:
    """Return the record in a JSON file.

    Raises:
        InputError: It is missing, or no JSON record.
    """
    try:
        record = json.loads(text_of(path, what))
    except _ERRORS as error:
        raise InputError(f"{path}: wanted {what} in JSON ({error})") from error
    if not isinstance(record, dict):
        raise InputError(f"{path}: wanted {what}, a JSON record, got {type(record).__name__}")
    return record
