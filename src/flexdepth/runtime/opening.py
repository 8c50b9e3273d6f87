"""Files that a user names for reading, opened with messages that say what to do."""

from pathlib import Path
from typing import BinaryIO

from flexdepth.runtime.errors import InputError

_ADDRESSES = (("http:",), ("https:",))


def open_input(path: Path) -> BinaryIO:
    """Open a file that is not empty, for reading bytes.

    Raises:
        InputError: The file is missing, a folder, not a plain file, empty or may not be read.
    """
    try:
        if path.is_dir():
            raise InputError(f"{path}: is a folder, wanted a file; name a file inside it")
        if not path.exists():
            is_address = path.parts[:1] in _ADDRESSES  # a path has lost the second slash
            todo = "nothing is downloaded here, save it first" if is_address else "check the name"
            raise InputError(f"{path}: does not exist; {todo}")
        if not path.is_file():
            raise InputError(f"{path}: is not a plain file; save its content to a file first")
        if not path.stat().st_size:
            raise InputError(f"{path}: is empty (0 bytes); get the file again")
        return path.open("rb")
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"{path}: cannot be read: {reason}; check its permissions") from error
