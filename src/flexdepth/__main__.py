"""One command as a process of its own: the script `flexdepth`, and `python -m flexdepth`."""

import gc
import sys

from flexdepth.cli.main import main

_NEW_OBJECTS = 50_000
"""After so many Python looks for garbage, not after 700: imports make many, and none is garbage."""


def process() -> int:
    """Run the command that the shell names, and return its exit code.

    Leaving looks for garbage too, through every object there is; the process's end frees them
    anyway. Together that is a tenth of the time that one small photo takes. Libraries that come
    with torch complain of what is not freed.
    """
    gc.set_threshold(_NEW_OBJECTS)
    try:
        return main()
    finally:
        if "torch" not in sys.modules:
            gc.freeze()


if __name__ == "__main__":
    sys.exit(process())
