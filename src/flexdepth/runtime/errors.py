"""The one exception that a user can mend."""


class InputError(ValueError):
    """A mistake in what the user gave: a file, a flag, a folder.

    The message is one line: what was wanted, what came, which file or field, what to do. The
    command line shows it without a traceback and exits with code 2; everything else that is
    raised is a bug.
    """
