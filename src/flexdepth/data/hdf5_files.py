"""Arrays in HDF5 files."""

from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.formats.reading import reading

_ERRORS = (KeyError, ValueError, TypeError, AttributeError, RuntimeError)


def array_of(path: Path, name: str, what: str) -> NDArray[np.float32]:
    """Return an array of a file, as float32.

    Args:
        path: The file.
        name: Of the array in it.
        what: What the file should be, for the message.

    Raises:
        InputError: The file is missing, damaged, or has no such array of numbers.
    """
    with reading(path, what, _ERRORS), h5py.File(path) as file:
        return np.asarray(file[name][()], np.float32)
