"""NAME.json, which says what the numbers in NAME.npy and NAME.pfm mean.

It holds one record for each of the two that is there, by suffix: `{"npy": {...}, "pfm": {...}}`;
they may have been made at different times from different things.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.formats.meaning import MAX_TEXT, Meaning, from_record
from flexdepth.runtime.formats.reading import reading

SPEAKS_FOR = ("npy", "pfm")


@contextmanager
def beside(path: Path, meaning: Meaning) -> Iterator[None]:
    """Replace the record of `path` in NAME.json when the block, which writes `path`, ends well.

    The array comes first: an interrupt between the two leaves a new array that is refused for
    want of a meaning, or an old record by whose `origin` it counts as made otherwise.

    Raises:
        InputError: NAME.json is somebody else's file, which is not overwritten.
    """
    sidecar = path.with_suffix(".json")
    kept = {
        name: old.record()
        for name, old in _records(sidecar).items()
        if path.with_suffix(f".{name}").is_file()
    }
    with replacing(sidecar) as temporary:
        temporary.write_text(
            json.dumps(kept | {_name(path): meaning.record()}, indent=1, allow_nan=False) + "\n",
            encoding="ascii",
        )
        yield


def recorded(path: Path) -> Meaning | None:
    """Return what NAME.json says of the file `path`, None where it says nothing."""
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    return _records(path.with_suffix(".json")).get(_name(path))


def _name(path: Path) -> str:
    return path.suffix.lower().removeprefix(".")


def _records(sidecar: Path) -> dict[str, Meaning]:
    if not sidecar.exists():
        return {}
    with reading(sidecar, "the meaning of a depth file", (ValueError, RecursionError)):
        with sidecar.open("rb") as file:
            text = file.read(MAX_TEXT + 1)
        if len(text) > MAX_TEXT:
            raise ValueError("it is too long")
        records: object = json.loads(text)
    if not isinstance(records, dict) or not set(records) <= set(SPEAKS_FOR):
        raise InputError(
            f"{sidecar}: is not the meaning of a depth file, and its name is needed for that; "
            f"move it or choose another folder"
        )
    return {name: from_record(record, sidecar) for name, record in records.items()}
