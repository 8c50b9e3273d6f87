"""Files that appear whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex

from flexdepth.runtime.errors import InputError

_UNFINISHED = ".flexdepth-"
"""What the names of files that are being written begin with."""


def check_writable(folder: Path) -> None:
    """Refuse a folder that cannot be written, or made, before work for it is done.

    Raises:
        InputError: It is a file or lies below one, or permissions forbid it.
    """
    there = next((each for each in (folder, *folder.parents) if os.path.lexists(each)), Path())
    if not os.path.isdir(there):
        raise InputError(f"{folder}: {there} is no folder; choose another --output-dir")
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(
            f"{folder}: {there} cannot be written, permission denied; choose another --output-dir"
        )


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path` that becomes `path` when the block ends well.

    Whoever looks at `path` sees the old file or the complete new one, even after a loss of power,
    for what was written is on the disk before it has its name. The temporary name is hidden, lies
    in the same folder (which is made where it is missing) and keeps the suffix, so that writers
    which choose their format by suffix can be used. On any failure, Ctrl-C included, it is removed
    and `path` stays as it was.

    Args:
        path: The file to make or to replace.

    Raises:
        InputError: The folder cannot be written, the disk is full, a folder stands in the way.
    """
    temporary = path.with_name(f"{_UNFINISHED}{token_hex(8)}{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield temporary
            with temporary.open("rb+") as file:
                os.fsync(file.fileno())
            os.replace(temporary, path)
        finally:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"{path}: cannot be written: {reason}; free some space or choose another folder"
        ) from error


def discard_unfinished(folder: Path) -> None:
    """Remove the temporary files of writers that were killed; nobody else may be writing here."""
    for left in folder.glob(f"{_UNFINISHED}*"):
        with suppress(OSError):
            left.unlink()
