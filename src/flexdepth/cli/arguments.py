"""A mistake in a command's arguments, told in one line."""

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stderr

from flexdepth.runtime.errors import InputError

_RULE = "─-"
_FRAME = "│╭╮╰╯ "
"""What boxes are drawn with; without UTF-8, rules are of hyphens and frames of spaces."""


@contextmanager
def told_in_one_line(command: str) -> Iterator[None]:
    """Let tyro parse arguments, and turn its box of complaints into one line.

    Args:
        command: As it is typed, such as "flexdepth synth".

    Raises:
        InputError: An argument is unknown, missing or has a value that does not fit.
    """
    complaint = io.StringIO()
    try:
        with redirect_stderr(complaint):
            yield
    except SystemExit as stop:
        if not stop.code:
            raise
        said = _in_one_line(complaint.getvalue())
        raise InputError(f"{said} ({command} --help)") from stop


def _in_one_line(box: str) -> str:
    """Return what the first part of a box says, and the first name that another part suggests."""
    parts: list[list[str]] = [[]]
    for line in box.splitlines()[1:]:
        words = line.strip(_FRAME)
        if words.strip(_RULE):
            parts[-1].append(words)
        else:
            parts.append([])
    said, *more = filter(None, parts)
    return "; ".join([" ".join(said), *(f"did you mean {p[1]}?" for p in more if _suggests(p))])


def _suggests(part: Sequence[str]) -> bool:
    return len(part) > 1 and part[0].startswith(("Perhaps", "Arguments similar"))
