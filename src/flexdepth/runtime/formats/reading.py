"""Reading files that may be broken or hostile: every failure is one line that names the file."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from flexdepth.runtime.errors import InputError, reason

MAX_VALUES = 1 << 28
"""No depth map is larger (268 megapixels, 1 GiB): what declares to be is not allocated."""


@contextmanager
def reading(path: Path, what: str, errors: tuple[type[Exception], ...]) -> Iterator[None]:
    """Turn the failures of a decoder into one `InputError` that names `path`.

    Args:
        path: The file that is read.
        what: What it should be, such as "a 16-bit PNG".
        errors: What the decoder raises on a broken file, besides `OSError` and `MemoryError`.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    broken: tuple[type[Exception], ...] = (MemoryError, *errors)
    try:
        yield
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    except broken as error:
        raise InputError(f"{path}: cannot be read as {what}: {reason(error)}") from error


def check_size(width: int, height: int) -> None:
    """Refuse a declared size that no depth map has, before anything is allocated."""
    if width <= 0 or height <= 0 or width * height > MAX_VALUES:
        raise ValueError(
            f"a size of {width} x {height} is declared, a depth map has 1 to {MAX_VALUES} values"
        )
