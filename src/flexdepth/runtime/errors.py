"""The one exception that a user can mend."""


class InputError(ValueError):
    """A mistake in what the user gave: a file, a flag, a folder.

    The message is one line: what was wanted, what came, which file or field, what to do. The
    command line shows it without a traceback and exits with code 2; everything else that is
    raised is a bug.
    """


def one_line(message: str) -> str:
    """Return the message with the line ends and control characters of file names escaped."""
    return "".join(each if each.isprintable() else ascii(each)[1:-1] for each in message)


def reason(error: object) -> str:
    """Return what an exception or a warning of a library says on one line, cut at 200 letters.

    One that says nothing is named by its kind.
    """
    return " ".join(str(error).split())[:200] or type(error).__name__
